//! Setpoints, sticks and channels that come by the link, as the core takes them.

use windhover_autopilot::mission::action::{Place, over_ground};
use windhover_autopilot::mode::Guidance;
use windhover_autopilot::{OuterInputs, OuterReport, Parameters, RcFrame, Sticks};
use windhover_control::position::AttitudeSetpoint;
use windhover_ground_link::setpoints::{self, Channel, Channels, LocalFrame as Axes, Motion, Setpoint};
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Quaternion, Vector3, wrap_pi};

/// A setpoint from outside; one that says nothing that can be followed is left out.
pub fn guide(setpoint: &Setpoint, report: &OuterReport, parameters: &Parameters, inputs: &mut OuterInputs) {
    match *setpoint {
        Setpoint::Local {
            frame,
            position,
            motion,
        } => push(inputs, local(frame, position, &motion, report)),
        Setpoint::Global {
            ground,
            altitude,
            motion,
        } => {
            let Some(frame) = report.origin.map(LocalFrame::new) else {
                return;
            };
            let mut guidance = moving(&motion);
            if let Some(ground) = ground {
                let there = over_ground(ground.latitude, ground.longitude, &frame);
                guidance.position = there;
                guidance.uses |= Guidance::PLACE;
                if let Some(altitude) = altitude {
                    let place = Place {
                        latitude: ground.latitude,
                        longitude: ground.longitude,
                        altitude,
                    };
                    guidance.position = place.local(&frame, report.home);
                    guidance.uses |= Guidance::HEIGHT;
                }
            } else if let Some(altitude) = altitude {
                guidance.position.z = altitude.down(&frame, report.home);
                guidance.uses |= Guidance::HEIGHT;
            }
            push(inputs, guidance);
        }
        Setpoint::Attitude {
            attitude: Some(attitude),
            rate,
            thrust: Some(thrust),
        } => {
            let most = 4.0 * parameters.vehicle.rotor_thrust_max();
            let [x, y, z] = rate.map(Option::unwrap_or_default);
            let setpoint = AttitudeSetpoint {
                attitude,
                rate: Vector3::new(x, y, z),
                thrust: thrust * most,
            };
            let _ = inputs.attitude.push(setpoint);
        }
        // Body rates alone: there is no such mode.
        Setpoint::Attitude { .. } => {}
    }
}

fn push(inputs: &mut OuterInputs, guidance: Guidance) {
    if guidance.is_valid() {
        let _ = inputs.guidance.push(guidance);
    }
}

/// NED from home, or from the vehicle, or along its nose.
fn local(frame: Axes, position: [Option<f32>; 3], motion: &Motion, report: &OuterReport) -> Guidance {
    let mut guidance = moving(motion);
    let [x, y, z] = position;
    if let (Some(x), Some(y)) = (x, y) {
        (guidance.position.x, guidance.position.y) = (x, y);
        guidance.uses |= Guidance::PLACE;
    }
    if let Some(z) = z {
        guidance.position.z = z;
        guidance.uses |= Guidance::HEIGHT;
    }
    let estimate = &report.estimate;
    match frame {
        Axes::Ned => guidance.position += report.home,
        Axes::OffsetNed => guidance.position += estimate.position,
        Axes::Body => {
            let heading = estimate.attitude.heading();
            let turn = Quaternion::from_heading(heading);
            guidance.position = estimate.position + turn.rotate(guidance.position);
            guidance.velocity = turn.rotate(guidance.velocity);
            guidance.heading = wrap_pi(guidance.heading + heading);
        }
    }
    guidance
}

/// Velocity and heading.
fn moving(motion: &Motion) -> Guidance {
    let mut guidance = Guidance::default();
    let [x, y, z] = motion.velocity;
    if let (Some(x), Some(y)) = (x, y) {
        (guidance.velocity.x, guidance.velocity.y) = (x, y);
        guidance.uses |= Guidance::VELOCITY;
    }
    if let Some(z) = z {
        guidance.velocity.z = z;
        guidance.uses |= Guidance::CLIMB;
    }
    if let Some(heading) = motion.heading {
        guidance.heading = heading;
        guidance.uses |= Guidance::HEADING;
    }
    if let Some(rate) = motion.heading_rate {
        guidance.heading_rate = rate;
        guidance.uses |= Guidance::HEADING_RATE;
    }
    guidance
}

/// A game pad: its throttle has its middle at a half.
pub fn steer(sticks: &setpoints::Sticks, inputs: &mut OuterInputs) {
    let setpoints::Sticks {
        pitch,
        roll,
        throttle,
        yaw,
        ..
    } = *sticks;
    if pitch.is_none() && roll.is_none() && throttle.is_none() && yaw.is_none() {
        return;
    }
    let _ = inputs.sticks.push(Sticks {
        pitch: pitch.unwrap_or_default(),
        roll: roll.unwrap_or_default(),
        throttle: 2.0 * throttle.unwrap_or(0.5) - 1.0,
        yaw: yaw.unwrap_or_default(),
    });
}

/// Channels of a remote control that come by radio link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    frame: RcFrame,
}

impl Overrides {
    /// Takes in what came; a frame as if a receiver gave it, unless all channels were given back.
    pub fn take(&mut self, channels: &Channels) -> Option<RcFrame> {
        for (kept, channel) in self.frame.channels.iter_mut().zip(&channels.channels) {
            match *channel {
                Channel::Keep => {}
                Channel::Release => *kept = 0,
                Channel::Pulse(pulse) => *kept = pulse,
            }
        }
        self.frame
            .channels
            .iter()
            .any(|pulse| *pulse != 0)
            .then_some(self.frame)
    }
}
