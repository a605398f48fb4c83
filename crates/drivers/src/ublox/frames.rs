//! Frames: what goes around a message's payload, and the messages that are sent, made when the
//! program is compiled.

use super::setup::TARGET_BAUD;

/// What a frame begins with.
pub(super) const SYNC: [u8; 2] = [0xB5, 0x62];

/// Bytes of a frame around its payload: sync, class, number, length and sums.
pub(super) const AROUND: usize = 8;

/// Class and number of NAV-PVT.
pub(super) const NAV_PVT: [u8; 2] = [0x01, 0x07];

/// Class of acknowledgements, and their numbers.
pub(super) const ACK: u8 = 0x05;
pub(super) const ACK_ACK: u8 = 0x01;
pub(super) const ACK_NAK: u8 = 0x00;

/// Class of configuration.
const CFG: u8 = 0x06;

/// CFG-VALSET: values by key, of M9 and later.
pub(super) const VALSET: [u8; 2] = [CFG, 0x8A];
/// CFG-PRT: a port, until M8; so are the next.
pub(super) const PRT: [u8; 2] = [CFG, 0x00];
const MSG: [u8; 2] = [CFG, 0x01];
const RATE: [u8; 2] = [CFG, 0x08];
const NAV5: [u8; 2] = [CFG, 0x24];

/// From one measurement to the next, in ms.
const PERIOD_MS: u8 = 100;

/// The dynamic model: airborne, less than 4 g.
const AIRBORNE_4G: u8 = 8;

/// CFG-VALSET's version, and the layer: RAM alone. Nothing is stored in the receiver.
const RAM: [u8; 4] = [0, 1, 0, 0];

/// Keys (u-blox M10, interface description: configuration reference).
const UART1INPROT_UBX: [u8; 4] = 0x1073_0001_u32.to_le_bytes();
const UART1OUTPROT_UBX: [u8; 4] = 0x1074_0001_u32.to_le_bytes();
const UART1OUTPROT_NMEA: [u8; 4] = 0x1074_0002_u32.to_le_bytes();
const UART1_BAUDRATE: [u8; 4] = 0x4052_0001_u32.to_le_bytes();
const MSGOUT_NAV_PVT_UART1: [u8; 4] = 0x2091_0007_u32.to_le_bytes();
const RATE_MEAS: [u8; 4] = 0x3021_0001_u32.to_le_bytes();
const RATE_NAV: [u8; 4] = 0x3021_0002_u32.to_le_bytes();
const NAVSPG_DYNMODEL: [u8; 4] = 0x2011_0021_u32.to_le_bytes();

const BAUD: [u8; 4] = TARGET_BAUD.to_le_bytes();

/// A message that is sent, and which it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Command {
    pub id: [u8; 2],
    pub bytes: &'static [u8],
}

/// Asks what every receiver answers, and turns its answers on: values, which only M9 and later
/// take, and then the state of port 1, which only M8 and before tell. What is not known is refused.
pub(super) const PROBE: &[u8] = &join::<31>(&[
    &frame::<22>(VALSET, &[&RAM, &UART1INPROT_UBX, &[1], &UART1OUTPROT_UBX, &[1]]),
    &frame::<9>(PRT, &[&[1]]),
]);

/// Sets the rate of port 1 by value.
pub(super) const PORT_BY_VALUE: &[u8] = &frame::<20>(VALSET, &[&RAM, &UART1_BAUDRATE, &BAUD]);

/// Sets the rate of port 1 by message: 8N1, UBX alone both ways.
pub(super) const PORT_BY_MESSAGE: &[u8] = &frame::<28>(
    PRT,
    &[
        &[1, 0, 0, 0],
        &0x8D0_u32.to_le_bytes(),
        &BAUD,
        &[1, 0, 1, 0],
        &[0; 4],
    ],
);

/// What is sent to M9 and later. The first is necessary.
pub(super) const BY_VALUE: [Command; 2] = [
    Command {
        id: VALSET,
        bytes: &frame::<34>(
            VALSET,
            &[
                &RAM,
                &UART1OUTPROT_NMEA,
                &[0],
                &RATE_MEAS,
                &[PERIOD_MS, 0],
                &RATE_NAV,
                &[1, 0],
                &MSGOUT_NAV_PVT_UART1,
                &[1],
            ],
        ),
    },
    Command {
        id: VALSET,
        bytes: &frame::<17>(VALSET, &[&RAM, &NAVSPG_DYNMODEL, &[AIRBORNE_4G]]),
    },
];

/// What is sent to M8 and before.
pub(super) const BY_MESSAGE: [Command; 3] = [
    Command {
        id: RATE,
        // each measurement is a solution, on GPS time
        bytes: &frame::<14>(RATE, &[&[PERIOD_MS, 0, 1, 0, 1, 0]]),
    },
    Command {
        id: MSG,
        bytes: &frame::<11>(MSG, &[&NAV_PVT, &[1]]),
    },
    Command {
        id: NAV5,
        // of all its fields only the dynamic model
        bytes: &frame::<44>(NAV5, &[&[1, 0, AIRBORNE_4G], &[0; 33]]),
    },
];

/// The sums of a frame (interface description: UBX checksum), over all between sync and sums.
pub(super) fn sums(body: &[u8]) -> [u8; 2] {
    body.iter().fold([0; 2], |sums, byte| add(sums, *byte))
}

const fn add([a, b]: [u8; 2], byte: u8) -> [u8; 2] {
    let a = a.wrapping_add(byte);
    [a, b.wrapping_add(a)]
}

/// A frame of N bytes, whose payload comes in pieces. For constants: a wrong N does not compile.
const fn frame<const N: usize>(id: [u8; 2], payload: &[&[u8]]) -> [u8; N] {
    let [low, high] = (N as u16 - AROUND as u16).to_le_bytes();
    let mut bytes = join::<N>(&[&SYNC, &id, &[low, high]]);
    let filled = fill(&mut bytes, AROUND - 2, payload);
    assert!(filled + 2 == N);
    let (mut place, mut sums) = (2, [0; 2]);
    while place < filled {
        sums = add(sums, bytes[place]);
        place += 1;
    }
    fill(&mut bytes, filled, &[&sums]);
    bytes
}

/// Pieces one behind the other.
const fn join<const N: usize>(pieces: &[&[u8]]) -> [u8; N] {
    let mut bytes = [0; N];
    fill(&mut bytes, 0, pieces);
    bytes
}

/// Writes pieces from a place on. Returns the place behind them.
const fn fill(bytes: &mut [u8], mut place: usize, pieces: &[&[u8]]) -> usize {
    let mut piece = 0;
    while piece < pieces.len() {
        let mut byte = 0;
        while byte < pieces[piece].len() {
            bytes[place] = pieces[piece][byte];
            place += 1;
            byte += 1;
        }
        piece += 1;
    }
    place
}
