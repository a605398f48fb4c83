//! What the vehicle believes of itself.
//!
//! [`predictor`] carries the attitude from one result of the outer loop to the next, one gyro
//! sample at a time.
#![no_std]

pub mod predictor;

pub use predictor::AttitudePredictor;
