//! Does nothing: it is here so that the build dependency counts, which gives messages their
//! extension fields.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
}
