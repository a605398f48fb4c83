//! Thin shells around the core: each waits for something, hands it on, and waits again.

mod ground_link;
mod health;
mod inner_loop;
mod log_stream;
mod outer_loop;

pub use ground_link::{Ground, ground_link};
pub use health::health;
pub use inner_loop::{InnerLoop, inner_loop};
pub use log_stream::{Start, log_stream};
pub use outer_loop::outer_loop;
