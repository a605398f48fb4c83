//! Placeholder.
#![no_std]
pub mod mission;
