//! placeholder
pub struct Alignment;
