//! The error-state Kalman filter against references in double precision.
#![allow(clippy::needless_range_loop)]

mod consistency;
mod dense;
mod flight;
mod jacobian;
mod oracle;
mod propagation;
mod random;
