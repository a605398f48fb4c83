//! The error-state Kalman filter against references in double precision.
#![allow(clippy::needless_range_loop)]

mod alignment;
mod consistency;
mod dense;
mod endurance;
mod flight;
mod gates;
mod jacobian;
mod jacobian_rest;
mod oracle;
mod propagation;
mod random;
mod refusals;
mod turned;
