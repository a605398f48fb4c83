//! One file a flight board: everything that differs from board to board.

mod speedybee_f405_v4;

pub use speedybee_f405_v4::{NAME, motors_off};
