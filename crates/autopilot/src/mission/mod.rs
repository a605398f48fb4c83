//! Missions.
pub mod item;
