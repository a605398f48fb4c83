//! The desktop: the core in a simulated world.

pub mod closed_loop;
pub mod recording;
