//! What the vehicle believes of itself.
//!
//! [`predictor`] carries the attitude from one result of the outer loop to the next, one gyro
//! sample at a time. [`filter`] is the error-state Kalman filter of the outer loop: position,
//! velocity, attitude and the biases of gyro and accelerometer, from what the sensors say and
//! when they said it.
//!
//! - [`state`]: the nominal state and its motion. [`covariance`]: how far it may be off.
//! - [`measurement`]: one file a sensor. [`history`]: where the vehicle was when it measured.
//! - [`gate`]: whether a measurement is believed. [`health`]: what that says of the sensor.
//! - [`alignment`]: the first attitude, at rest. [`accuracy`]: what the filter claims.
//! - [`doubt`]: how a filter that is sure of itself, and wrong, learns again.
//! - [`border`]: what it refuses. [`noise`]: what the inertial sensors are like.
#![no_std]

pub mod accuracy;
pub mod alignment;
pub mod border;
pub mod covariance;
pub mod doubt;
pub mod filter;
pub mod gate;
pub mod health;
pub mod history;
pub mod measurement;
pub mod noise;
pub mod predictor;
pub mod reset;
pub mod start;
pub mod state;

pub use accuracy::Accuracy;
pub use alignment::Alignment;
pub use border::Refusal;
pub use filter::Filter;
pub use gate::{Report, Test, Verdict};
pub use health::{Health, Sensor};
pub use noise::NoiseParameters;
pub use predictor::AttitudePredictor;
pub use reset::Reset;
pub use start::Start;
pub use state::{InertialIncrements, State};
