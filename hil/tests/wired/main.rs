//! The board with everything on its pins, driven by its registers as the firmware's drivers do it,
//! without a processor: from the vehicle's truth to the bytes in a register, and back.

mod battery;
mod desk;
mod drivers;
mod i2c;
mod recovery;
mod serial;
