//! Thin shells around the core: each waits for something, hands it on, and waits again.

mod gnss;
mod ground_link;
mod health;
mod inner_loop;
mod log_stream;
mod outer_loop;
mod remote;
mod report;
mod slow_sensors;

pub use gnss::gnss;
pub use ground_link::{Ground, ground_link, ground_sender};
pub use health::health;
pub use inner_loop::{InnerLoop, inner_loop};
pub use log_stream::{Start, log_stream};
pub use outer_loop::outer_loop;
pub use remote::remote;
pub use slow_sensors::slow_sensors;
