//! Setpoints that move: along a path with limited speed, acceleration and jerk.

pub mod glide;
pub mod heading;
pub mod path;
pub mod profile;

pub use glide::{Glide, GlideLimits};
pub use heading::{HeadingSlew, towards};
pub use path::{Limits, Path};
pub use profile::Profile;
