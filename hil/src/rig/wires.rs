//! Which part hangs on which pin, and how it sits. One value a flight board, from its
//! documentation and not from the firmware: where both agree, both may be right.

use crate::board::{Pin, Usart};

/// How the inertial sensors sit: the body's axes (front, right, down) are these rows of the
/// part's axes, each entry −1, 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting(pub [[i8; 3]; 3]);

impl Mounting {
    /// Counts along the body's axes, in the part's axes.
    pub fn to_part(&self, body: [i16; 3]) -> [i16; 3] {
        core::array::from_fn(|axis| {
            let turned = |(row, count): (&[i8; 3], i16)| i32::from(row[axis]) * i32::from(count);
            let sum: i32 = self.0.iter().zip(body).map(turned).sum();
            sum.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16
        })
    }
}

/// A board's wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wires {
    /// Chip select of the inertial sensors on SPI1.
    pub imu_select: Pin,
    /// Their data-ready line.
    pub imu_ready: Pin,
    /// How they sit.
    pub mounting: Mounting,
    /// The pins of the motors' pads, in the core's rotor order: front right, rear left, front
    /// left, rear right.
    pub motors: [Pin; 4],
    /// The serial port at which the log is recorded.
    pub log: Usart,
    /// The serial port of commands.
    pub commands: Usart,
    /// Baud rate of the commands that come in.
    pub commands_baud: u64,
    /// The serial port of the satellite receiver.
    pub gnss: Usart,
    /// The serial port of the RC receiver.
    pub remote: Usart,
    /// Clock and data of barometer and compass.
    pub i2c: [Pin; 2],
    /// The battery's voltage and current, each behind its scale.
    pub battery: [Pin; 2],
}

impl Wires {
    /// The SpeedyBee F405 V4, as ArduPilot's `speedybeef4v4/hwdef.dat` has it. Pads M1 to M4 are
    /// PB6, PB7, PB0 and PB1, and follow Betaflight's quad X: rear right, front right, rear left,
    /// front left. ArduPilot's PITCH_180_YAW_270 turns the part's (x, y, z) into (y, x, −z) of the
    /// body, as does Betaflight's CW90.
    pub const SPEEDYBEE_F405_V4: Self = Self {
        imu_select: Pin::new('A', 4),
        imu_ready: Pin::new('C', 4),
        mounting: Mounting([[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
        motors: [
            Pin::new('B', 7),
            Pin::new('B', 0),
            Pin::new('B', 1),
            Pin::new('B', 6),
        ],
        log: Usart(3),
        commands: Usart(1),
        commands_baud: 115_200,
        gnss: Usart(6),
        remote: Usart(2),
        i2c: [Pin::new('B', 8), Pin::new('B', 9)],
        battery: [Pin::new('C', 0), Pin::new('C', 1)],
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_vehicle_presses_against_the_parts_z() {
        let mounting = Wires::SPEEDYBEE_F405_V4.mounting;
        // Standard gravity: specific force is up, and the part's z points up.
        assert_eq!(mounting.to_part([0, 0, -2048]), [0, 0, 2048]);
    }

    #[test]
    fn front_is_the_parts_y_and_right_its_x() {
        let mounting = Wires::SPEEDYBEE_F405_V4.mounting;
        assert_eq!(mounting.to_part([10, 0, 0]), [0, 10, 0]);
        assert_eq!(mounting.to_part([0, 10, 0]), [10, 0, 0]);
    }

    #[test]
    fn the_end_of_the_range_is_not_passed() {
        let mounting = Mounting([[-1, 0, 0], [0, -1, 0], [0, 0, 1]]);
        assert_eq!(
            mounting.to_part([i16::MIN, i16::MAX, 0]),
            [i16::MAX, -i16::MAX, 0]
        );
    }
}
