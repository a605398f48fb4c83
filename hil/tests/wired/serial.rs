//! Satellite and RC receivers on their ports, and ports on which something babbles.

use windhover_hil::board::Pin;
use windhover_hil::parts::rc::Protocol;
use windhover_hil::time::SECOND;
use windhover_model::sensor::ubx;

use super::desk::{Desk, MS};

const USART2: u32 = 0x4000_4400;
pub const USART6: u32 = 0x4001_1400;
const SR: u32 = 0x00;
const DR: u32 = 0x04;
const RXNE: u32 = 1 << 5;
const TXE: u32 = 1 << 7;
/// PE and FE.
const WRONG: u32 = 3;

/// What a port is set to: bits of CR1, of CR2.
pub const PLAIN: (u32, u32) = (0, 0);
const EVEN: (u32, u32) = (1 << 12 | 1 << 10, 2 << 12);

impl Desk {
    pub fn open(&mut self, port: u32, baud: u32, (control, stop): (u32, u32)) {
        let (transmit, receive, function) = match port {
            USART2 => (Pin::new('A', 2), Pin::new('A', 3), 7),
            _ => (Pin::new('C', 6), Pin::new('C', 7), 8),
        };
        self.switch(transmit, 2, function);
        self.switch(receive, 2, function);
        self.write(port + 0x0C, 0);
        self.write(port + 0x08, 16_000_000 / baud);
        self.write(port + 0x10, stop);
        self.write(port + 0x0C, 1 << 13 | 3 << 2 | control);
    }

    /// Bytes that come within a time, and how many of them were flagged.
    pub fn listen(&mut self, port: u32, time: u64) -> (Vec<u8>, usize) {
        let (end, mut bytes, mut wrong) = (self.now + time, vec![], 0);
        while self.now < end {
            let status = self.read(port + SR);
            if status & RXNE != 0 {
                bytes.push(self.read(port + DR) as u8);
                wrong += usize::from(status & WRONG != 0);
            }
            self.wait(SECOND / 100_000);
        }
        (bytes, wrong)
    }

    pub fn say(&mut self, port: u32, bytes: &[u8]) {
        for byte in bytes {
            while self.read(port + SR) & TXE == 0 {
                self.wait(SECOND / 100_000);
            }
            self.write(port + DR, (*byte).into());
        }
    }
}

fn messages(bytes: &[u8]) -> Vec<ubx::Message> {
    let mut parser = ubx::Parser::default();
    bytes.iter().filter_map(|byte| parser.take(*byte)).collect()
}

fn valset(values: &[(u32, &[u8])]) -> Vec<u8> {
    let mut payload = vec![0, 1, 0, 0];
    for (key, value) in values {
        payload.extend(key.to_le_bytes());
        payload.extend(*value);
    }
    ubx::frame([6, 0x8A], &payload)
}

#[test]
fn a_receiver_is_found_configured_and_reports_where_it_is() {
    let mut desk = Desk::new(&[], |_| {});
    desk.wait(SECOND);
    // At another rate there is noise, and no answer.
    desk.open(USART6, 115_200, PLAIN);
    desk.say(USART6, &ubx::frame([0x0A, 0x04], &[]));
    let (bytes, _) = desk.listen(USART6, SECOND);
    assert!(messages(&bytes).is_empty() && !String::from_utf8_lossy(&bytes).contains("$GN"));
    desk.open(USART6, 38_400, PLAIN);
    desk.say(USART6, &ubx::frame([0x0A, 0x04], &[]));
    let (bytes, wrong) = desk.listen(USART6, SECOND);
    assert_eq!((messages(&bytes)[0].id, wrong), ([0x0A, 0x04], 0));

    desk.say(USART6, &valset(&[(0x4052_0001, &115_200u32.to_le_bytes())]));
    desk.wait(100 * MS);
    desk.open(USART6, 115_200, PLAIN);
    desk.say(
        USART6,
        &valset(&[
            (0x1074_0002, &[0]),
            (0x2091_0007, &[1]),
            (0x3021_0001, &100u16.to_le_bytes()),
        ]),
    );
    desk.listen(USART6, SECOND + SECOND / 5);
    let (bytes, wrong) = desk.listen(USART6, SECOND);
    let reports = messages(&bytes);
    assert_eq!((reports.len(), wrong), (10, 0));
    let signed = |report: &ubx::Message, place: usize| {
        i32::from_le_bytes(report.payload[place..place + 4].try_into().unwrap())
    };
    for report in &reports {
        assert!(
            (signed(report, 28) - 473_977_419).abs() < 1_000,
            "within 10 m of home"
        );
        assert!((signed(report, 24) - 85_455_938).abs() < 1_500);
        assert!((signed(report, 36) - 488_000).abs() < 12_000);
        assert_eq!(report.payload[20], 3);
    }
    let weeks: Vec<i32> = reports.iter().map(|report| signed(report, 0)).collect();
    assert!(weeks.windows(2).all(|pair| pair[1] - pair[0] == 100));
}

#[test]
fn a_receiver_that_is_unplugged_falls_silent() {
    let mut desk = Desk::new(&["gnss-unplugged@2"], |_| {});
    desk.open(USART6, 38_400, PLAIN);
    let (bytes, _) = desk.listen(USART6, 2 * SECOND);
    assert!(String::from_utf8_lossy(&bytes).contains("$GNRMC"));
    let (bytes, _) = desk.listen(USART6, 2 * SECOND);
    assert!(bytes.is_empty());
}

#[test]
fn crsf_comes_50_times_a_second_and_loses_some() {
    let mut desk = Desk::new(&[], |setup| setup.remote = Some(Protocol::Crsf));
    desk.open(USART2, 420_000, PLAIN);
    let mut desk_bytes = vec![];
    for _ in 0..100 {
        // Faster than the bytes come.
        desk_bytes.extend(desk.fast(USART2, 20 * MS));
    }
    let frames = desk_bytes
        .windows(3)
        .filter(|bytes| *bytes == [0xC8, 24, 0x16])
        .count();
    assert!((92..=100).contains(&frames), "{frames}");
    // Throttle low, in the third channel: 172 of 11 bits.
    let at = desk_bytes
        .windows(3)
        .position(|bytes| bytes == [0xC8, 24, 0x16])
        .unwrap();
    let payload = &desk_bytes[at + 3..];
    let throttle = u32::from_le_bytes(payload[2..6].try_into().unwrap()) >> 6 & 0x7FF;
    assert!(throttle.abs_diff(172) <= 3, "{throttle}");
}

impl Desk {
    /// Bytes that come at up to 420,000 baud.
    fn fast(&mut self, port: u32, time: u64) -> Vec<u8> {
        let (end, mut bytes) = (self.now + time, vec![]);
        while self.now < end {
            if self.read(port + SR) & RXNE != 0 {
                bytes.push(self.read(port + DR) as u8);
            }
            self.wait(SECOND / 60_000);
        }
        bytes
    }
}

#[test]
fn sbus_needs_its_own_rate_and_parity() {
    let mut desk = Desk::new(&[], |setup| setup.remote = Some(Protocol::Sbus));
    desk.open(USART2, 100_000, EVEN);
    let (bytes, wrong) = desk.listen(USART2, SECOND);
    assert_eq!((bytes.len(), wrong), (50 * 25, 0));
    assert!(bytes.chunks(25).all(|frame| frame[0] == 0x0F && frame[24] == 0));
    desk.open(USART2, 420_000, PLAIN);
    let heard = desk.fast(USART2, SECOND);
    assert!(!heard.windows(3).any(|bytes| bytes == [0xC8, 24, 0x16]));
    assert!(
        heard.len() > 1000,
        "a receiver that is too quick hears many bytes"
    );
}

#[test]
fn crsf_is_not_read_as_sbus() {
    let mut desk = Desk::new(&[], |setup| setup.remote = Some(Protocol::Crsf));
    desk.open(USART2, 100_000, EVEN);
    let (bytes, wrong) = desk.listen(USART2, SECOND);
    assert!(wrong > bytes.len() / 4, "{wrong} of {}", bytes.len());
}

#[test]
fn a_remote_that_is_unplugged_falls_silent() {
    let mut desk = Desk::new(&["rc-unplugged@1"], |setup| setup.remote = Some(Protocol::Sbus));
    desk.open(USART2, 100_000, EVEN);
    assert!(!desk.listen(USART2, SECOND).0.is_empty());
    desk.wait(10 * MS);
    desk.read(USART2 + DR);
    assert!(desk.listen(USART2, SECOND).0.is_empty());
}

/// At full speed: as many bytes as the rate can carry.
#[test]
fn babble_fills_a_line() {
    let mut desk = Desk::new(&["babble-usart6@1+1"], |_| {});
    desk.open(USART6, 38_400, PLAIN);
    desk.wait(SECOND);
    let (bytes, wrong) = desk.listen(USART6, SECOND);
    assert!((3835..=3845).contains(&bytes.len()), "{}", bytes.len());
    assert_eq!(wrong, 0);
    let ones: u32 = bytes.iter().map(|byte| byte.count_ones()).sum();
    assert!((14_500..16_500).contains(&ones), "{ones}");
    desk.wait(10 * MS);
    desk.read(USART6 + DR);
    let (bytes, _) = desk.listen(USART6, 2 * SECOND);
    assert!(
        String::from_utf8_lossy(&bytes).contains("$GNRMC"),
        "and then it is the receiver's again"
    );
}
