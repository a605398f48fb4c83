//! What the inner step commands, one message a period of the outer step.

use windhover_autopilot::MotorCommand;

use crate::batch::{MAX_K, field};
use crate::record::{Count, Description};
use crate::value::{Scalar, Value};
use crate::wire::{Decoder, Encoder};

/// What the motors were told in one period, and the hash of all its outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorBatch {
    /// The lower half of the first tick's number: the `imu_batch` before it has the whole.
    pub tick: u16,
    /// [`crate::period_hash`].
    pub hash: u32,
    /// How many ticks.
    pub count: u8,
    /// The command of each tick.
    pub commands: [MotorCommand; MAX_K],
}

const NO_TICK: u8 = 3;

impl MotorBatch {
    /// What a log says of it. `state`: two bits a tick, lowest first: 0 disarmed, 1 idle, 2 run,
    /// 3 no tick.
    pub const TOPIC: Description = Description {
        id: 3,
        name: "motor_batch",
        ticked: false,
        fields: &[
            field("tick", Scalar::U16, Count::One),
            field("hash", Scalar::U32, Count::One),
            field("state", Scalar::U8, Count::TwoBits),
            field("motor", Scalar::U16, Count::PerTick(4)),
        ],
    };

    /// Before its first tick.
    pub const fn new() -> Self {
        Self {
            tick: 0,
            hash: 0,
            count: 0,
            commands: [MotorCommand::Disarmed; MAX_K],
        }
    }

    /// Adds a tick; one too many is ignored.
    #[inline]
    pub fn push(&mut self, command: MotorCommand) {
        if let Some(place) = self.commands.get_mut(usize::from(self.count)) {
            *place = command;
            self.count += 1;
        }
    }

    /// The commands of its ticks.
    #[inline]
    pub fn commands(&self) -> &[MotorCommand] {
        self.commands.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// Writes it but for its time, that of the first tick.
    #[inline]
    pub fn put(&self, k: usize, out: &mut Encoder<'_>) {
        self.tick.put(out);
        self.hash.put(out);
        let commands = self.commands();
        let states = (0..k.min(MAX_K)).fold(u32::MAX, |states, n| {
            let state = match commands.get(n) {
                Some(MotorCommand::Disarmed) => 0,
                Some(MotorCommand::Idle(_)) => 1,
                Some(MotorCommand::Run(_)) => 2,
                None => NO_TICK,
            };
            states & !(3 << (2 * n)) | u32::from(state) << (2 * n)
        });
        for byte in states.to_le_bytes().iter().take(k.div_ceil(4)) {
            byte.put(out);
        }
        for n in 0..k.min(MAX_K) {
            let rotors = commands.get(n).and_then(MotorCommand::rotors).unwrap_or_default();
            let [[a, b], [c, d], [e, f], [g, h]] = rotors.map(u16::to_le_bytes);
            out.bytes([a, b, c, d, e, f, g, h]);
        }
    }

    /// Reads what [`Self::put`] wrote.
    pub fn get(k: usize, from: &mut Decoder<'_>) -> Option<Self> {
        let mut batch = Self::new();
        batch.tick = Value::get(from)?;
        batch.hash = Value::get(from)?;
        let mut states = [u8::MAX; MAX_K / 4];
        for byte in states.iter_mut().take(k.div_ceil(4)) {
            *byte = Value::get(from)?;
        }
        let states = u32::from_le_bytes(states);
        for n in 0..k.min(MAX_K) {
            let rotors: [u16; 4] = Value::get(from)?;
            let state = (states >> (2 * n) & 3) as u8;
            if state == NO_TICK {
                continue;
            }
            if usize::from(batch.count) != n {
                return None;
            }
            batch.push(match state {
                0 => MotorCommand::Disarmed,
                1 => MotorCommand::Idle(rotors[0]),
                _ => MotorCommand::Run(rotors),
            });
        }
        Some(batch)
    }
}

impl Default for MotorBatch {
    fn default() -> Self {
        Self::new()
    }
}
