//! The reference pages in `docs/` are what the program prints.

use std::path::Path;

use windhover_sim::reference;

fn assert_current(file: &str, command: &str, page: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs")
        .join(file);
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = written.lines().zip(page.lines()).find(|(old, new)| old != new);
    assert!(
        written == page,
        "docs/{file} is not what the declarations say; renew it with\n    \
         cargo run -q -p windhover-sim -- {command} --markdown > docs/{file}\n\
         (first difference: {differs:?})"
    );
}

#[test]
fn the_page_of_parameters_is_current() {
    assert_current("parameters.md", "parameters", &reference::parameters_page());
}

#[test]
fn the_page_of_failsafes_is_current() {
    assert_current("failsafes.md", "failsafes", &reference::failsafes_page());
}
