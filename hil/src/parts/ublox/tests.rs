use super::*;

const FIX: NavPvt = NavPvt {
    time_of_week: 302_400_000,
    latitude: 473_977_419,
    longitude: 85_455_938,
    height: 0,
    height_msl: 488_000,
    horizontal_accuracy: 2_000,
    vertical_accuracy: 3_000,
    velocity: [1, 2, 3],
    ground_speed: 2,
    heading_of_motion: 0,
    speed_accuracy: 90,
    heading_accuracy: 0,
    position_dop: 130,
    fix_type: 3,
    flags: 1,
    satellites: 16,
};

/// The board's end of the line.
struct Driver {
    receiver: Ublox,
    port: Port,
    now: u64,
    parser: ubx::Parser,
    /// Bytes that came, and the messages among them.
    bytes: Vec<u8>,
    messages: Vec<ubx::Message>,
    /// When it measured.
    epochs: Vec<u64>,
}

impl Driver {
    fn new(generation: Generation, baud: u64) -> Self {
        let mut driver = Self {
            receiver: Ublox::new(generation, 0),
            port: Port::new(Format::plain(baud)),
            now: 0,
            parser: ubx::Parser::default(),
            bytes: vec![],
            messages: vec![],
            epochs: vec![],
        };
        driver.wait(SECOND);
        driver
    }

    /// Lets time pass; each measurement is reported at once.
    fn wait(&mut self, ticks: u64) {
        let end = self.now + ticks;
        loop {
            let next = self.receiver.next_event().min(self.port.next_event());
            if next > end {
                break;
            }
            self.now = self.now.max(next);
            if let Some(frame) = self.port.advance(self.now) {
                self.receiver.receive(self.now, frame);
            }
            if self.receiver.measures(self.now) {
                self.epochs.push(self.now);
                self.receiver.report(self.now, &FIX);
            }
            if let Some(frame) = self.receiver.advance(self.now) {
                self.port.receive(self.now, frame);
            }
            for (_, byte) in self.port.take_received() {
                self.bytes.push(byte);
                self.messages.extend(self.parser.take(byte));
            }
        }
        self.now = end;
    }

    /// Sends a message and waits: the messages that came meanwhile.
    fn ask(&mut self, id: [u8; 2], payload: &[u8]) -> Vec<ubx::Message> {
        self.messages.clear();
        self.port.send(self.now, &ubx::frame(id, payload));
        self.wait(SECOND / 2);
        std::mem::take(&mut self.messages)
    }

    fn tell(&mut self, number: u8, payload: &[u8]) -> bool {
        let answers = self.ask([0x06, number], payload);
        answers.contains(&answer(1, number))
    }

    fn set(&mut self, values: &[(u32, &[u8])]) -> bool {
        let mut payload = vec![0, 1, 0, 0];
        for (key, value) in values {
            payload.extend(key.to_le_bytes());
            payload.extend(*value);
        }
        self.tell(configuration::VALSET, &payload)
    }

    /// Reports of a second.
    fn reports(&mut self) -> usize {
        self.messages.clear();
        self.wait(SECOND);
        let reports = self.messages.iter().filter(|message| message.id == ubx::NAV_PVT);
        reports.count()
    }
}

fn answer(kind: u8, number: u8) -> ubx::Message {
    ubx::Message {
        id: [5, kind],
        payload: vec![6, number],
    }
}

#[test]
fn unconfigured_it_speaks_sentences_once_a_second() {
    for (generation, baud) in [(Generation::M8, 9_600), (Generation::M10, 38_400)] {
        let mut driver = Driver::new(generation, baud);
        driver.wait(2 * SECOND);
        let text = String::from_utf8(driver.bytes.clone()).unwrap();
        assert_eq!(text.matches("$GNRMC").count(), 3);
        assert!(driver.messages.is_empty());
    }
}

#[test]
fn at_another_rate_neither_understands_the_other() {
    let mut driver = Driver::new(Generation::M10, 115_200);
    assert!(driver.ask([0x0A, 0x04], &[]).is_empty());
    driver.wait(3 * SECOND);
    assert!(!String::from_utf8_lossy(&driver.bytes).contains("$GN"));
}

#[test]
fn it_says_which_protocol_it_speaks() {
    for (generation, baud, protocol) in [
        (Generation::M8, 9_600, "PROTVER=18.00"),
        (Generation::M10, 38_400, "PROTVER=34.10"),
    ] {
        let answers = Driver::new(generation, baud).ask([0x0A, 0x04], &[]);
        assert_eq!(answers[0].payload.len(), 70);
        assert!(answers[0].payload[40..].starts_with(protocol.as_bytes()));
    }
}

/// The rate of the line first, then what goes over it.
#[test]
fn an_m10_is_configured_by_values() {
    let mut driver = Driver::new(Generation::M10, 38_400);
    assert!(driver.set(&[(0x4052_0001, &115_200u32.to_le_bytes())]));
    assert!(!driver.set(&[]), "it is not heard at the old rate any more");
    driver.port.set_format(Format::plain(115_200));
    assert!(driver.set(&[
        (0x1074_0002, &[0]),
        (0x2091_0007, &[1]),
        (0x3021_0001, &100u16.to_le_bytes()),
        (0x2011_0021, &[8]),
    ]));
    driver.wait(SECOND);
    assert_eq!(driver.reports(), 10);
    driver.bytes.clear();
    driver.wait(SECOND);
    assert_eq!(driver.bytes.len(), 10 * 100, "no sentences");
    assert!(
        driver
            .epochs
            .windows(2)
            .rev()
            .take(10)
            .all(|pair| pair[1] - pair[0] == SECOND / 10)
    );
    assert!(driver.set(&[(0x3021_0002, &2u16.to_le_bytes())]));
    assert_eq!(driver.reports(), 5);
}

#[test]
fn values_are_taken_all_or_none() {
    let mut driver = Driver::new(Generation::M10, 38_400);
    for wrong in [
        (0x2FFF_0001, &[1u8][..]),
        (0x3021_0001, &[1, 0]),
        (0x3021_0001, &[100]),
    ] {
        let answers = driver.ask(
            [6, configuration::VALSET],
            &[
                &[0, 1, 0, 0][..],
                &0x2091_0007u32.to_le_bytes(),
                &[1],
                &u32::to_le_bytes(wrong.0),
                wrong.1,
            ]
            .concat(),
        );
        assert_eq!(answers, [answer(0, configuration::VALSET)]);
    }
    assert_eq!(driver.reports(), 0);
}

/// CFG-PRT of port 1: UBX alone, at a rate.
fn port_of(baud: u32) -> [u8; 20] {
    let mut port = [0; 20];
    port[0] = 1;
    port[4..8].copy_from_slice(&0x8D0u32.to_le_bytes());
    port[8..12].copy_from_slice(&baud.to_le_bytes());
    port[12] = 1;
    port[14] = 1;
    port
}

#[test]
fn an_m8_is_configured_by_messages() {
    let mut driver = Driver::new(Generation::M8, 9_600);
    assert!(!driver.set(&[(0x2091_0007, &[1])]), "it does not know values");
    assert!(driver.tell(0x00, &port_of(115_200)));
    driver.port.set_format(Format::plain(115_200));
    assert!(driver.tell(0x08, &[200, 0, 1, 0, 1, 0]));
    assert!(driver.tell(0x01, &[0x01, 0x07, 1]));
    driver.wait(SECOND);
    assert_eq!(driver.reports(), 5);
    driver.bytes.clear();
    driver.wait(SECOND);
    assert_eq!(driver.bytes.len(), 500);
    assert!(driver.tell(0x01, &[0x01, 0x07, 0, 0, 0, 0, 0, 0]));
    assert_eq!(driver.reports(), 0);
    assert!(!driver.tell(0x55, &[]));
}

#[test]
fn with_its_power_it_loses_its_configuration() {
    let mut driver = Driver::new(Generation::M10, 38_400);
    assert!(driver.set(&[(0x4052_0001, &115_200u32.to_le_bytes())]));
    driver.receiver.unplug();
    assert_eq!(driver.receiver.next_event(), NEVER);
    driver.receiver.plug(driver.now);
    assert_eq!(driver.receiver.format(), Format::plain(38_400));
    assert!(
        driver.set(&[]) || driver.set(&[]),
        "it listens again after it has started"
    );
}

#[test]
fn what_a_slow_line_cannot_carry_is_dropped_by_messages() {
    let mut driver = Driver::new(Generation::M8, 9_600);
    assert!(driver.tell(0x00, &port_of(9_600)));
    assert!(driver.tell(0x08, &[50, 0, 1, 0, 1, 0]));
    assert!(driver.tell(0x01, &[0x01, 0x07, 1]));
    driver.wait(5 * SECOND);
    assert!(driver.receiver.dropped() > 20);
    let reports = driver.reports();
    assert!((9..=10).contains(&reports), "{reports}");
}
