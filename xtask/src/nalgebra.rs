//! nalgebra with its feature `std` may choose kernels at run time, by processor: results would
//! then differ between machines (docs/decisions/001-equal-bits.md).

use crate::process::{Outcome, cargo, read};
use crate::toolchain::BOARD;

/// No package of the desktop's workspace and of the board's core asks for `std`.
pub fn has_no_std() -> Outcome {
    for scope in [
        &["--workspace"] as &[_],
        &["--target", BOARD, "--package", "windhover-autopilot"],
    ] {
        let mut command = cargo(["tree", "--locked", "--edges", "features,normal"]);
        let tree = read(command.args(["--invert", "nalgebra"]).args(scope))?;
        verdict(&tree)?;
    }
    Ok(())
}

/// Judges cargo's inverted feature tree.
fn verdict(tree: &str) -> Outcome {
    if !tree.starts_with("nalgebra v") {
        return Err(format!("cargo's tree does not begin with nalgebra:\n{tree}"));
    }
    match tree.contains("nalgebra feature \"std\"") {
        true => Err(format!("somebody asks nalgebra for `std`:\n{tree}")),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREE: &str = "nalgebra v0.35.0\n\
        ├── nalgebra feature \"macros\"\n\
        │   └── windhover-math v0.1.0\n";

    #[test]
    fn macros_are_fine_and_std_is_not() {
        assert!(verdict(TREE).is_ok());
        let with_std = format!("{TREE}└── nalgebra feature \"std\"\n");
        assert!(verdict(&with_std).unwrap_err().contains("asks nalgebra"));
    }

    #[test]
    fn another_package_with_std_is_fine() {
        assert!(verdict(&format!("{TREE}└── serde feature \"std\"\n")).is_ok());
    }

    #[test]
    fn an_empty_tree_proves_nothing() {
        assert!(verdict("").is_err());
    }
}
