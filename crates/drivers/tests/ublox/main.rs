//! The satellite receiver: messages among noise, and a receiver that is found and configured.

mod parser;
mod receiver;
mod setup;
