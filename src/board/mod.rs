//! One file a flight board: everything that differs from board to board. What all boards with an
//! STM32F405 share is in [`stm32f405`].

mod i2c_transfer;
mod sensor_bus;
mod serial;
mod stm32f405;

#[cfg(feature = "speedybee-f405-v4")]
mod speedybee_f405_v4;

pub use sensor_bus::SensorBus;
pub use serial::{SerialReceiver, baud};
#[cfg(feature = "speedybee-f405-v4")]
pub use speedybee_f405_v4::{
    BatteryInputs, GROUND_LINK_BAUD, Imu, Motors, NAME, ROTATION, light, motors_off, take,
};
pub use stm32f405::{
    CYCLES_PER_MICROSECOND, INNER_INTERRUPT, LOG_INTERRUPT, OUTER_INTERRUPT, PLANS, STACK, STORED, Storage,
    clear_core_coupled, on_every_priority, stack_used, uid, watch,
};

#[cfg(not(feature = "speedybee-f405-v4"))]
compile_error!("choose a board by its feature, for instance `speedybee-f405-v4`");
