//! Bytes between the sockets of ground stations and the board's serial line, of which there is one.
//!
//! To the board goes what is whole: a packet as it came, of a stream a frame at a time, so that
//! nobody's frame gets into another's. What the board sends is split into its frames, for all.

use windhover_ground_link::frame::{Frame, MAX_FRAME, Parser};
use windhover_sim::sitl::net::{Arrival, STREAMS};

use crate::rig::serial::Port;

/// Bytes that wait for the line to the board, at most: a third of a second of it at 115,200 baud.
/// What comes while there is no room for it is lost.
pub const ROOM: usize = 4096;

/// What went through since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Packets and frames to the board.
    pub up: u64,
    /// Packets and frames that found no room on the line to the board.
    pub lost: u64,
    /// Frames from the board.
    pub down: u64,
    /// Bytes that belong to no frame: of streams, and from the board.
    pub noise: u64,
}

/// The pump.
#[derive(Clone, Debug, Default)]
pub struct Pump {
    streams: [Parser; STREAMS],
    board: Parser,
    counts: Counts,
}

impl Pump {
    /// What went through since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Something came from outside: to the board with it, at `now`.
    pub fn hear(&mut self, arrival: &Arrival<'_>, now: u64, port: &mut Port) {
        match arrival {
            Arrival::Packet(_, packet) => put(&mut self.counts, now, port, packet),
            Arrival::Bytes(link, bytes) => {
                let counts = &mut self.counts;
                if let Some(parser) = stream(&mut self.streams, *link) {
                    let frames = |counts: &mut Counts, frame: &[u8]| put(counts, now, port, frame);
                    split(parser, bytes, counts, frames);
                }
            }
            // A frame that was not ended will not be.
            Arrival::Opened(link, _) | Arrival::Closed(link) => {
                if let Some(parser) = stream(&mut self.streams, *link) {
                    *parser = Parser::default();
                }
            }
        }
    }

    /// Gives the frames that the board has sent by now.
    pub fn speak(&mut self, port: &mut Port, to_all: &mut dyn FnMut(&[u8])) {
        let bytes: Vec<u8> = port.take_received().into_iter().map(|(_, byte)| byte).collect();
        split(&mut self.board, &bytes, &mut self.counts, |counts, frame| {
            counts.down += 1;
            to_all(frame);
        });
    }
}

/// Where a stream's frames are put together; links of packets have none.
fn stream(streams: &mut [Parser; STREAMS], link: usize) -> Option<&mut Parser> {
    streams.get_mut(link.checked_sub(1)?)
}

/// Sends what is whole, if there is room for it.
fn put(counts: &mut Counts, now: u64, port: &mut Port, whole: &[u8]) {
    if port.queued() + whole.len() > ROOM {
        counts.lost += 1;
    } else {
        counts.up += 1;
        port.send(now, whole);
    }
}

/// Gives the frames that end in these bytes, as they came.
fn split(parser: &mut Parser, bytes: &[u8], counts: &mut Counts, mut sink: impl FnMut(&mut Counts, &[u8])) {
    let skipped = parser.counts().skipped;
    parser.feed(bytes, |frame| {
        let mut buffer = [0; MAX_FRAME];
        sink(counts, whole(frame, &mut buffer));
    });
    counts.noise += u64::from(parser.counts().skipped - skipped);
}

/// A frame with its signature.
fn whole<'a>(frame: &Frame<'_>, buffer: &'a mut [u8; MAX_FRAME]) -> &'a [u8] {
    let signature: &[u8] = frame.signature.map_or(&[], |signature| signature);
    let bytes = frame.covered.iter().chain(signature);
    let length = frame.covered.len() + signature.len();
    for (to, from) in buffer.iter_mut().zip(bytes) {
        *to = *from;
    }
    &buffer[..length]
}

#[cfg(test)]
mod tests {
    use windhover_ground_link::Address;
    use windhover_ground_link::frame::{SIGNATURE, Sign, Writer};

    use super::*;
    use crate::board::Format;
    use crate::time::SECOND;

    /// PING and HEARTBEAT.
    const IDS: [u32; 2] = [4, 0];

    fn port() -> Port {
        Port::new(Format::plain(115_200))
    }

    /// Some frames, the second one signed.
    fn frames() -> Vec<Vec<u8>> {
        let mut writer = Writer::new(Address {
            system: 255,
            component: 190,
        });
        let mut frame = |n: usize| {
            let mut buffer = [0; MAX_FRAME];
            let mut sign = |_: &[u8]| [7_u8; SIGNATURE];
            let signed = (n == 1).then_some(&mut sign as Sign<'_>);
            let length = writer.write(&mut buffer, IDS[n % 2], &[n as u8 + 1; 9], signed);
            buffer[..length.unwrap()].to_vec()
        };
        (0..4).map(&mut frame).collect()
    }

    /// What has arrived at the board, an hour later.
    fn arrived(port: &mut Port) -> Vec<u8> {
        std::iter::from_fn(|| port.advance(3600 * SECOND))
            .map(|frame| frame.data as u8)
            .collect()
    }

    #[test]
    fn frames_of_several_stations_do_not_get_into_each_other() {
        let (mut pump, mut port) = (Pump::default(), port());
        let [one, two, three, four] = frames().try_into().unwrap();
        let (half, rest) = one.split_at(5);
        pump.hear(&Arrival::Bytes(1, half), 0, &mut port);
        pump.hear(&Arrival::Packet(0, &two), 0, &mut port);
        pump.hear(&Arrival::Bytes(2, &[b"noise", &three[..]].concat()), 0, &mut port);
        pump.hear(&Arrival::Bytes(1, rest), 0, &mut port);
        pump.hear(&Arrival::Bytes(3, &four), 0, &mut port);
        assert_eq!(arrived(&mut port), [two, three, one, four].concat());
        let counts = Counts {
            up: 4,
            noise: 5,
            ..Counts::default()
        };
        assert_eq!(pump.counts(), counts);
    }

    #[test]
    fn who_comes_next_does_not_end_the_frame_of_who_went() {
        let (mut pump, mut port) = (Pump::default(), port());
        let [one, two, ..] = <[Vec<u8>; 4]>::try_from(frames()).unwrap();
        pump.hear(&Arrival::Bytes(4, &one[..one.len() - 1]), 0, &mut port);
        pump.hear(&Arrival::Closed(4), 0, &mut port);
        pump.hear(&Arrival::Opened(4, ([127, 0, 0, 1], 1).into()), 0, &mut port);
        pump.hear(&Arrival::Bytes(4, &two), 0, &mut port);
        assert_eq!(arrived(&mut port), two);
    }

    #[test]
    fn a_flood_is_lost_by_whole_packets_and_counted() {
        let (mut pump, mut port) = (Pump::default(), port());
        let packets = 2 * ROOM / 30;
        for n in 0..packets {
            pump.hear(&Arrival::Packet(0, &[n as u8; 30]), 0, &mut port);
            assert!(port.queued() <= ROOM);
        }
        let Counts { up, lost, .. } = pump.counts();
        assert_eq!((up, up + lost), ((ROOM / 30) as u64, packets as u64));
        let bytes = arrived(&mut port);
        for (n, packet) in bytes.chunks(30).enumerate() {
            assert_eq!(packet, [n as u8; 30]);
        }
        // And then there is room again.
        pump.hear(&Arrival::Packet(0, b"late"), 3600 * SECOND, &mut port);
        assert_eq!(pump.counts().up, up + 1);
    }

    #[test]
    fn what_the_board_sends_is_split_into_its_frames() {
        let (mut pump, mut port) = (Pump::default(), port());
        let mut told: Vec<Vec<u8>> = Vec::new();
        let format = Format::plain(115_200);
        for (n, byte) in frames().concat().into_iter().enumerate() {
            let frame = crate::board::Frame {
                data: byte.into(),
                format,
            };
            port.receive(n as u64 * format.frame_time(), frame);
            // Looked at while a frame is under way.
            if n % 7 == 0 {
                pump.speak(&mut port, &mut |frame| told.push(frame.to_vec()));
            }
        }
        pump.speak(&mut port, &mut |frame| told.push(frame.to_vec()));
        assert_eq!(told, frames());
        assert_eq!(pump.counts().down, 4);
    }
}
