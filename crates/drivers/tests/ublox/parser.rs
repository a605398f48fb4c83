//! Messages are found as the model makes them, whatever is around them; nothing else is.

use proptest::collection::vec;
use proptest::prelude::*;
use windhover_drivers::ublox::{Message, NavPvt, Parser};
use windhover_model::random::Random;
use windhover_model::sensor::{nav_pvt, ubx};

fn found(parser: &mut Parser, bytes: &[u8]) -> Vec<Message> {
    let mut messages = vec![];
    parser.feed(bytes, |message| messages.push(message));
    messages
}

/// A report of the model, and what is to be read of it.
fn arb_report() -> impl Strategy<Value = (nav_pvt::NavPvt, NavPvt)> {
    (any::<[i32; 8]>(), any::<[u32; 4]>(), any::<[u8; 3]>()).prop_map(|(signed, unsigned, bytes)| {
        let [
            latitude,
            longitude,
            height,
            height_msl,
            north,
            east,
            down,
            ground_speed,
        ] = signed;
        let [
            time_of_week,
            horizontal_accuracy,
            vertical_accuracy,
            speed_accuracy,
        ] = unsigned;
        let [fix_type, flags, satellites] = bytes;
        let velocity = [north, east, down];
        let sent = nav_pvt::NavPvt {
            time_of_week,
            latitude,
            longitude,
            height,
            height_msl,
            horizontal_accuracy,
            vertical_accuracy,
            velocity,
            ground_speed,
            speed_accuracy,
            fix_type,
            flags,
            satellites,
            ..nav_pvt::NavPvt::default()
        };
        let read = NavPvt {
            time_of_week,
            latitude,
            longitude,
            altitude: height_msl,
            velocity,
            horizontal_accuracy,
            vertical_accuracy,
            speed_accuracy,
            fix: if flags & nav_pvt::GNSS_FIX_OK != 0 {
                fix_type
            } else {
                0
            },
            satellites,
        };
        (sent, read)
    })
}

fn report(sent: &nav_pvt::NavPvt) -> Vec<u8> {
    ubx::frame(ubx::NAV_PVT, &ubx::nav_pvt(sent))
}

proptest! {
    /// In pieces of any size, behind any noise.
    #[test]
    fn every_field_of_a_report_is_read(
        (sent, read) in arb_report(),
        noise in vec(any::<u8>(), 0..300),
        piece in 1..120usize,
    ) {
        let bytes = [noise.as_slice(), &report(&sent)].concat();
        let mut parser = Parser::new();
        let mut messages = vec![];
        for piece in bytes.chunks(piece) {
            messages.extend(found(&mut parser, piece));
        }
        prop_assert_eq!(messages, [Message::NavPvt(read)]);
        prop_assert_eq!(parser.counts().skipped() as usize, noise.len());
    }

    #[test]
    fn acknowledgements_are_read(id in any::<[u8; 2]>()) {
        let bytes = [ubx::frame([5, 1], &id), ubx::frame([5, 0], &id)].concat();
        let messages = found(&mut Parser::new(), &bytes);
        prop_assert_eq!(messages, [Message::Acknowledged(id), Message::Refused(id)]);
    }

    /// Any one byte changed: the message is lost and counted, and the next one is read.
    #[test]
    fn a_damaged_report_is_not_read(
        (sent, read) in arb_report(),
        place in 0..100usize,
        change in 1..=255u8,
    ) {
        let mut damaged = report(&sent);
        damaged[place] ^= change;
        let mut parser = Parser::new();
        prop_assert_eq!(found(&mut parser, &damaged), []);
        prop_assert_eq!(parser.counts().damaged, u32::from(place >= 6));
        prop_assert_eq!(found(&mut parser, &report(&sent)), [Message::NavPvt(read)]);
    }
}

/// Bytes that nobody sent, with beginnings of messages strewn in: no panic, and no more messages
/// than 16 bits of sums let pass.
#[test]
fn a_million_bytes_of_noise_are_noise() {
    let mut random = Random::new(8, 0);
    let mut parser = Parser::new();
    let mut messages = 0;
    let mut noise = 0;
    while noise < 1_000_000 {
        let bits = random.bits();
        let mut piece = bits.to_le_bytes().to_vec();
        if bits.is_multiple_of(16) {
            piece.extend([0xB5, 0x62, 5, 1, 2, 0]);
        } else if bits % 64 == 1 {
            piece.extend([0xB5, 0x62, 1, 7, 92, 0]);
        }
        noise += piece.len();
        messages += found(&mut parser, &piece).len();
    }
    let counts = parser.counts();
    assert_eq!(counts.bytes as usize, noise);
    assert!(counts.damaged > 7_000, "{counts:?}");
    assert!(messages <= 3, "{messages}");
    assert_eq!(found(&mut parser, &ubx::frame([5, 1], &[6, 1])).len(), 1);
}

/// As a parser that waits for a length that noise made up would.
#[test]
fn a_length_that_none_has_hides_nothing() {
    let mut parser = Parser::new();
    found(&mut parser, &[0xB5, 0x62, 1, 7, 0xFF, 0xFF]);
    assert_eq!(
        found(&mut parser, &ubx::frame([5, 1], &[6, 0x8A])),
        [Message::Acknowledged([6, 0x8A])]
    );
}

/// flags3, invalidLlh: the receiver holds on to a position that is none.
#[test]
fn a_position_that_is_not_valid_is_no_fix() {
    let mut payload = ubx::nav_pvt(&nav_pvt::NavPvt {
        fix_type: 3,
        flags: 1,
        ..nav_pvt::NavPvt::default()
    });
    for (flags3, expected) in [(0, 3), (1, 0)] {
        payload[78] = flags3;
        let messages = found(&mut Parser::new(), &ubx::frame(ubx::NAV_PVT, &payload));
        let [Message::NavPvt(report)] = messages[..] else {
            panic!("{messages:?}");
        };
        assert_eq!(report.fix, expected);
    }
}
