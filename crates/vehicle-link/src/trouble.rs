//! What ended the last run, for ground stations.

use windhover_autopilot::Phase;
use windhover_ground_link::{Link, Severity};

use crate::VehicleLink;

/// Bytes of the trouble in a line, which takes 104.
const PIECE: usize = 88;

impl VehicleLink {
    /// Tells each ground station that has come what ended the last run: lines of its own, whole.
    #[inline(never)]
    pub(crate) fn tell_trouble(&self, links: &mut [Link]) {
        for link in links {
            if !link.take_arrival() || self.report.phase != Phase::Disarmed {
                continue;
            }
            let mut rest = self.trouble;
            while !rest.is_empty() {
                let (piece, more) = split(rest);
                link.say(Severity::Critical, format_args!("Last run: {piece}"));
                rest = more;
            }
        }
    }
}

/// The words that fit into a line, and the rest behind the space between.
fn split(text: &str) -> (&str, &str) {
    let end = text.floor_char_boundary(PIECE);
    let whole = (text, "");
    let (piece, rest) = text.split_at_checked(end).unwrap_or(whole);
    if let Some(rest) = rest.strip_prefix(' ') {
        return (piece, rest);
    }
    // Bytes: the search for a character has a panic that cannot happen, and the proof does not know that.
    let space = piece.bytes().rposition(|byte| byte == b' ');
    let space = space.filter(|_| !rest.is_empty());
    let split = space.and_then(|space| Some((text.get(..space)?, text.get(space + 1..)?)));
    split.unwrap_or((piece, rest))
}

#[cfg(test)]
mod tests {
    use windhover_autopilot::mission::PlanMemory;
    use windhover_autopilot::{OuterReport, Parameters};
    use windhover_ground_link::frame::{MAX_FRAME, Parser, Writer};
    use windhover_ground_link::{Address, Config};

    use super::*;
    use crate::{Fitting, Told};

    /// Numbers of messages (MAVLink, common).
    const HEARTBEAT: u32 = 0;
    const STATUSTEXT: u32 = 253;

    const TROUBLE: &str = "bus fault at 0x08012346; in the outer loop, tick 12345, log at 456789 bytes; \
                           cfsr 0x8200, hfsr 0x40000000, address 0xe0000000, lr 0x8012345, r12 c";

    /// A vehicle, its link, and a ground station at its other end.
    struct Bench {
        vehicle: VehicleLink,
        links: [Link; 2],
        station: Writer,
        now: u64,
    }

    impl Bench {
        fn new(trouble: &'static str) -> Self {
            let mut vehicle =
                VehicleLink::new(&Parameters::default(), Fitting::default(), Default::default());
            vehicle.set_trouble(trouble);
            Self {
                vehicle,
                links: [(); 2].map(|()| Link::new(Config::default())),
                station: Writer::new(Address {
                    system: 255,
                    component: 190,
                }),
                now: 0,
            }
        }

        /// The heartbeat of a ground station on a link.
        fn heartbeat(&mut self, link: usize) {
            let (mut frame, mut medium) = ([0; MAX_FRAME], PlanMemory::new());
            let beat = [0, 0, 0, 0, 6, 8, 0, 4, 3];
            let length = self.station.write(&mut frame, HEARTBEAT, &beat, None).unwrap();
            let link = &mut self.links[link];
            self.vehicle
                .receive(link, &frame[..length], self.now, &mut medium);
        }

        /// For two seconds: the lines that come on a link, with their severity.
        fn lines(&mut self, link: usize) -> Vec<(u8, String)> {
            let (mut medium, mut parser) = (PlanMemory::new(), Parser::default());
            let mut lines: Vec<(u8, String)> = Vec::new();
            for _ in 0..500 {
                self.now += 4_000;
                let said = &mut |_, _: core::fmt::Arguments<'_>| {};
                self.vehicle
                    .step(&mut self.links, &Told::default(), self.now, said);
                let mut sent = Vec::new();
                let link = &mut self.links[link];
                self.vehicle.poll(link, self.now, &mut medium, &mut |frame| {
                    sent.extend_from_slice(frame)
                });
                parser.feed(&sent, |frame| {
                    if frame.id != STATUSTEXT {
                        return;
                    }
                    let mut payload = frame.payload.to_vec();
                    payload.resize(54, 0);
                    let text = payload[1..51].iter().take_while(|byte| **byte != 0);
                    let text: String = text.map(|byte| char::from(*byte)).collect();
                    match lines.last_mut().filter(|_| payload[53] > 0) {
                        Some((_, line)) => line.push_str(&text),
                        None => lines.push((payload[0], text)),
                    }
                });
            }
            lines
        }
    }

    /// Lines that come to a station, put together again.
    fn whole(lines: &[(u8, String)]) -> String {
        let lines = lines.iter().map(|(severity, line)| {
            assert_eq!(*severity, Severity::Critical as u8, "{line}");
            line.strip_prefix("Last run: ").expect("it says what it is about")
        });
        lines.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_ground_station_is_told_once_and_whole() {
        let mut bench = Bench::new(TROUBLE);
        assert_eq!(bench.lines(0), [], "nobody is there yet");
        bench.heartbeat(0);
        assert_eq!(whole(&bench.lines(0)), TROUBLE);
        bench.heartbeat(0);
        assert_eq!(bench.lines(0), [], "it knows");
    }

    #[test]
    fn whoever_comes_later_is_told_too() {
        let mut bench = Bench::new(TROUBLE);
        bench.heartbeat(0);
        bench.lines(0);
        bench.heartbeat(1);
        assert_eq!(whole(&bench.lines(1)), TROUBLE);
        assert_eq!(bench.lines(0), [], "the other one knows");
        bench.now += 11_000_000;
        bench.heartbeat(0);
        assert_eq!(whole(&bench.lines(0)), TROUBLE, "after a silence it is a new one");
    }

    /// A link that comes and goes in flight must not tell old stories as if they were new.
    #[test]
    fn in_flight_nobody_is_told() {
        let mut bench = Bench::new(TROUBLE);
        bench.vehicle.report = OuterReport {
            phase: Phase::Flying,
            ..OuterReport::default()
        };
        bench.heartbeat(0);
        assert_eq!(bench.lines(0), []);
    }

    #[test]
    fn without_trouble_nothing_is_told() {
        let mut bench = Bench::new("");
        bench.heartbeat(0);
        assert_eq!(bench.lines(0), []);
    }

    /// Every text comes through whole, whatever its words are, and each step takes some of it.
    #[test]
    fn texts_are_split_between_words_and_nothing_is_lost() {
        let long = "ä".repeat(PIECE);
        let words: Vec<String> = (0..60).map(|n| "x".repeat(n)).collect();
        let even = format!("{} {}", "a".repeat(PIECE), "b".repeat(PIECE));
        for text in [TROUBLE, &words.join(" ")[1..], &even] {
            let (mut pieces, mut rest) = (Vec::new(), text);
            while !rest.is_empty() {
                let (piece, more) = split(rest);
                assert!(piece.len() <= PIECE && more.len() < rest.len());
                pieces.push(piece);
                rest = more;
            }
            assert_eq!(pieces.join(" "), text);
        }
        let (piece, rest) = split(&long);
        assert_eq!(
            format!("{piece}{rest}"),
            long,
            "a word that is too long is broken"
        );
    }
}
