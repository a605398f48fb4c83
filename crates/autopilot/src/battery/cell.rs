//! The voltage of a lithium-polymer cell at rest, and the charge that goes with it.

/// V at rest, and the share of its charge: what handbooks of chargers agree on to some 20 mV. Nearly all
/// of the charge lies between 3.7 and 4.2 V, and its middle between 3.75 and 3.85 V, so that a straight
/// line from empty to full would show twice of what is left at a quarter.
const CURVE: [(f32, f32); 13] = [
    (3.27, 0.0),
    (3.61, 0.05),
    (3.69, 0.10),
    (3.73, 0.20),
    (3.77, 0.30),
    (3.80, 0.40),
    (3.84, 0.50),
    (3.87, 0.60),
    (3.95, 0.70),
    (4.02, 0.80),
    (4.08, 0.85),
    (4.11, 0.90),
    (4.20, 1.0),
];

/// Share of its charge, 0 to 1, that a cell has at rest at `voltage`, V.
pub fn charge(voltage: f32) -> f32 {
    let (mut below, mut share) = (0.0, 0.0);
    for (above, most) in CURVE {
        if voltage < above {
            let way = (voltage - below) / (above - below);
            return share + way * (most - share);
        }
        (below, share) = (above, most);
    }
    share
}
