//! When a pilot's throttle may lift a vehicle that stands on the ground.

/// A throttle that is up when its mode begins lifts nothing before it has been down: no switch of modes
/// alone starts a flight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lift {
    /// The throttle was down since the mode began, or the vehicle in the air.
    ready: bool,
}

impl Lift {
    /// Whether the vehicle is to stay on the ground.
    pub fn rests(&mut self, landed: bool, throttle_down: bool) -> bool {
        self.ready |= throttle_down || !landed;
        landed && (throttle_down || !self.ready)
    }
}
