//! The desktop program `windhover` as a library: the core in a simulated world.
//!
//! - [`mission_file`]: plans and waypoint files as ground stations save them.
//! - [`closed_loop`]: the core and the world, tick by tick.
//! - [`recording`]: what the core consumed and commanded, and its replay.
//! - [`flight`]: a whole mission with its figures; [`lemniscate`]: a figure of eight.
//! - [`report`]: a flight as a page to look at.

pub mod closed_loop;
pub mod figures;
pub mod flight;
pub mod lemniscate;
pub mod mission_file;
pub mod recording;
pub mod report;
