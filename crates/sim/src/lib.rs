//! The desktop program `windhover` as a library: the core in a simulated world.
//!
//! - [`mission_file`]: plans and waypoint files as ground stations save them.
//! - [`sitl`]: the vehicle in real time, with ground stations at its links;
//! - [`stored`]: plans as they are stored on board.
//! - [`closed_loop`]: the core and the world, tick by tick; [`operator`]: who commands the flight.
//! - [`recording`]: what the core consumed and commanded, and its replay.
//! - [`flight`]: a whole mission with its figures; [`lemniscate`]: a figure of eight.
//! - [`flight_log`]: what a flight leaves behind; [`replay`]: the core again on a log's inputs,
//!   equal bit for bit.
//! - [`flight_report`]: a log as a [`report`], a page to look at.
//! - [`mod@reference`]: the tables of parameters and failsafes, as text and as pages of `docs`.
//! - [`terminal`], [`values`]: what programs share that fly at somebody's terminal, and what may be
//!   written on their command lines.

pub mod beliefs;
pub mod closed_loop;
pub mod figures;
pub mod flight;
pub mod flight_log;
pub mod flight_report;
pub mod lemniscate;
pub mod mission_file;
pub mod operator;
pub mod recording;
pub mod reference;
pub mod replay;
pub mod report;
pub mod sensors;
pub mod sitl;
pub mod stored;
pub mod terminal;
pub mod values;
