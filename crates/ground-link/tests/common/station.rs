//! A ground station: it frames its messages and reads those of the vehicle.

use mavlink::dialects::common::STATUSTEXT_DATA;
use mavlink::{MavlinkVersion, MessageData};
use windhover_ground_link::Address;
use windhover_ground_link::frame::{MAX_FRAME, Parser, Writer};

/// A message as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub id: u32,
    pub payload: Vec<u8>,
}

impl Seen {
    pub fn read<M: MessageData>(&self) -> Option<M> {
        (self.id == M::ID).then(|| M::deser(MavlinkVersion::V2, &self.payload).expect("our own is valid"))
    }
}

/// All messages of one type.
pub fn all<M: MessageData>(seen: &[Seen]) -> Vec<M> {
    seen.iter().filter_map(Seen::read).collect()
}

/// Text of a status message.
pub fn texts(seen: &[Seen]) -> Vec<String> {
    let text = |data: STATUSTEXT_DATA| data.text.to_str().unwrap().to_string();
    all(seen).into_iter().map(text).collect()
}

/// A ground station: frames its messages and reads those of the vehicle.
pub struct Station {
    pub address: Address,
    writer: Writer,
    parser: Parser,
}

impl Station {
    pub fn new(system: u8) -> Self {
        let address = Address {
            system,
            component: 190,
        };
        Self {
            address,
            writer: Writer::new(address),
            parser: Parser::default(),
        }
    }

    pub fn frame<M: MessageData>(&mut self, message: &M) -> Vec<u8> {
        let mut payload = [0; 255];
        message.ser(MavlinkVersion::V2, &mut payload);
        self.raw(M::ID, &payload[..M::ENCODED_LEN])
    }

    pub fn raw(&mut self, id: u32, payload: &[u8]) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let length = self.writer.write(&mut buffer, id, payload, None).unwrap();
        buffer[..length].to_vec()
    }

    pub fn read(&mut self, frames: &[Vec<u8>]) -> Vec<Seen> {
        let mut seen = Vec::new();
        for frame in frames {
            self.parser.feed(frame, |frame| {
                seen.push(Seen {
                    id: frame.id,
                    payload: frame.payload.to_vec(),
                });
            });
        }
        assert_eq!(
            self.parser.counts().skipped,
            0,
            "the vehicle sends nothing but frames"
        );
        seen
    }
}
