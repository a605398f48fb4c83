//! The core.
#![no_std]
pub mod io;
pub mod mission;
pub mod queue;
pub mod schedule;
pub mod sensing;
pub mod trajectory;
