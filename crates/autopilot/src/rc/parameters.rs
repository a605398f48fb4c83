//! Which channel does what, and how sticks feel.

use windhover_math::saturate;
use windhover_parameters::parameters;

use super::Sticks;
use crate::mode::Mode;

parameters! {
    /// Which channel does what, and how sticks feel.
    pub struct RcParameters {
        roll: "RC_MAP_ROLL", "", 0.0..=16.0, 1.0, "Channel of the roll stick; 0 for none, and then the receiver is not listened to";
        pitch: "RC_MAP_PITCH", "", 0.0..=16.0, 2.0, "Channel of the pitch stick; 0 for none, and then the receiver is not listened to";
        throttle: "RC_MAP_THROTTLE", "", 0.0..=16.0, 3.0, "Channel of the throttle stick; 0 for none, and then the receiver is not listened to";
        yaw: "RC_MAP_YAW", "", 0.0..=16.0, 4.0, "Channel of the yaw stick; 0 for none, and then the receiver is not listened to";
        mode_switch: "RC_MAP_FLTMODE", "", 0.0..=16.0, 6.0, "Channel of the switch that selects the mode of flight; 0 for none";
        arm_switch: "RC_MAP_ARM_SW", "", 0.0..=16.0, 5.0, "Channel of the switch that arms and disarms; 0 for none";
        kill_switch: "RC_MAP_KILL_SW", "", 0.0..=16.0, 0.0, "Channel of the switch that stops the motors at once, in flight too; 0 for none";
        reversed: "RC_REV_MASK", "", 0.0..=65535.0, 0.0, "Channels that are reversed: the sum of 1 for channel 1, 2 for channel 2, 4 for channel 3 and so on";
        dead_band: "RC_DEADBAND", "", 0.0..=0.5, 0.05, "Share of a stick's way from its middle to its end that counts as the middle";
        tilt_expo: "MPC_XY_MAN_EXPO", "", 0.0..=1.0, 0.3, "Roll and pitch stick: 0 acts in proportion, 1 by the cube, which is gentle about the middle; in every mode that sticks fly";
        yaw_expo: "MPC_YAW_EXPO", "", 0.0..=1.0, 0.3, "Yaw stick: 0 acts in proportion, 1 by the cube, which is gentle about the middle";
        climb_expo: "MPC_Z_MAN_EXPO", "", 0.0..=1.0, 0.3, "Throttle stick in modes that hold height: 0 acts in proportion, 1 by the cube, which is gentle about the middle";
        mode_1: "COM_FLTMODE1", "", -1.0..=11.0, 2.0, "Mode at position 1 of the mode switch: -1 none, 1 altitude, 2 position, 3 mission, 4 hold, 5 return, 7 offboard, 8 stabilize, 10 takeoff, 11 land; any other selects none";
        mode_2: "COM_FLTMODE2", "", -1.0..=11.0, -1.0, "Mode at position 2 of the mode switch; the numbers are those of COM_FLTMODE1";
        mode_3: "COM_FLTMODE3", "", -1.0..=11.0, -1.0, "Mode at position 3 of the mode switch; the numbers are those of COM_FLTMODE1";
        mode_4: "COM_FLTMODE4", "", -1.0..=11.0, 3.0, "Mode at position 4 of the mode switch, the middle of three; the numbers are those of COM_FLTMODE1";
        mode_5: "COM_FLTMODE5", "", -1.0..=11.0, -1.0, "Mode at position 5 of the mode switch; the numbers are those of COM_FLTMODE1";
        mode_6: "COM_FLTMODE6", "", -1.0..=11.0, 5.0, "Mode at position 6 of the mode switch; the numbers are those of COM_FLTMODE1";
        loss_time: "COM_RC_LOSS_T", "s", 0.1..=35.0, 0.5, "After this time without a frame a remote control is lost";
        input_mode: "COM_RC_IN_MODE", "", 0.0..=4.0, 1.0, "0: no arming without a receiver's or a ground station's sticks; 1 to 4: flights without any sticks are allowed";
    }
}

impl RcParameters {
    /// Whether the vehicle may only be armed while somebody's sticks are there.
    pub fn needs_remote(&self) -> bool {
        self.input_mode < 1.0
    }

    /// The mode that a position of the mode switch, 1 to 6, selects, if any.
    pub fn mode(&self, position: u8) -> Option<Mode> {
        let number = match position {
            1 => self.mode_1,
            2 => self.mode_2,
            3 => self.mode_3,
            4 => self.mode_4,
            5 => self.mode_5,
            6 => self.mode_6,
            _ => return None,
        };
        mode_of(number)
    }

    /// How sticks act: roll, pitch and yaw with dead band and expo; the throttle as it is, for
    /// [`Self::climb`] is the business of modes that hold height.
    pub fn shape(&self, raw: &Sticks) -> Sticks {
        let centred = |stick, share| expo(dead_band(stick, self.dead_band), share);
        Sticks {
            roll: centred(raw.roll, self.tilt_expo),
            pitch: centred(raw.pitch, self.tilt_expo),
            yaw: centred(raw.yaw, self.yaw_expo),
            throttle: raw.throttle,
        }
    }

    /// How a throttle, −1 to 1, acts in a mode that holds height: 0 about its middle, up is
    /// positive, ±1 at its ends.
    pub fn climb(&self, throttle: f32) -> f32 {
        expo(dead_band(throttle, self.dead_band), self.climb_expo)
    }
}

/// PX4's numbers of modes, as far as there is such a mode here.
fn mode_of(number: f32) -> Option<Mode> {
    match number as i8 {
        1 => Some(Mode::Altitude),
        2 => Some(Mode::Position),
        3 => Some(Mode::Mission),
        4 => Some(Mode::Hold),
        5 => Some(Mode::Return),
        7 => Some(Mode::Offboard),
        8 => Some(Mode::Stabilize),
        10 => Some(Mode::Takeoff),
        11 => Some(Mode::Land),
        _ => None,
    }
}

/// Takes ±`band` (below 1) for the middle and stretches the rest, so that ±1 stays and nothing jumps.
fn dead_band(stick: f32, band: f32) -> f32 {
    if stick > band {
        (stick - band) / (1.0 - band)
    } else if stick < -band {
        (stick + band) / (1.0 - band)
    } else {
        0.0
    }
}

/// x·(1 − e) + e·x³.
fn expo(stick: f32, share: f32) -> f32 {
    saturate(stick * (1.0 - share) + share * stick * stick * stick, 1.0)
}
