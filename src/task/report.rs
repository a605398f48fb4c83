//! How a part is, told when it changes.

use windhover_drivers::health::Health;

/// The last state of a part that was told.
pub struct Reported {
    part: &'static str,
    health: Health,
}

impl Reported {
    /// A part of which nothing was told.
    pub const fn new(part: &'static str) -> Self {
        Self {
            part,
            health: Health::Configuring,
        }
    }

    /// Tells how the part is, if that is new.
    pub fn tell(&mut self, health: Health) {
        if health == self.health {
            return;
        }
        self.health = health;
        match health {
            Health::Working => defmt::info!("{=str}: works", self.part),
            other => defmt::warn!("{=str}: {}", self.part, other),
        }
    }
}
