//! The desktop program `windhover` as a library: mission files and reports.

pub mod mission_file;
pub mod report;
