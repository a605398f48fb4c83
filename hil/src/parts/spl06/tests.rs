use super::*;

const MS: u64 = 1000 * MICROSECOND;
const COUNTS: BarometerCounts = BarometerCounts {
    pressure: -3_123_456,
    temperature: 212_345,
};

fn write(part: &mut Spl06, now: u64, writes: &[(u8, u8)]) {
    for (register, value) in writes {
        part.write(now, *register, *value);
    }
}

fn read<const N: usize>(part: &mut Spl06, now: u64, register: u8) -> [u8; N] {
    part.begin();
    core::array::from_fn(|n| part.read(now, register + n as u8))
}

/// The two raw counts.
fn counts(part: &mut Spl06, now: u64) -> (i32, i32) {
    let [a, b, c, d, e, f] = read(part, now, PSR_B2);
    let signed = |high, middle, low| i32::from_be_bytes([high, middle, low, 0]) >> 8;
    (signed(a, b, c), signed(d, e, f))
}

/// 32 a second, eight samples and one.
fn measuring() -> (Spl06, u64) {
    let mut part = Spl06::new(Formula::default(), 0);
    let now = 50 * MS;
    write(
        &mut part,
        now,
        &[(PRS_CFG, 0x53), (TMP_CFG, 0xD0), (CFG_REG, 0), (MEAS_CFG, 7)],
    );
    (part, now)
}

/// Lets it measure the same again and again.
fn run(part: &mut Spl06, until: u64) -> Vec<u64> {
    let mut times = vec![];
    while part.next_event() <= until {
        let now = part.next_event();
        part.put(now, Some(COUNTS));
        times.push(now);
    }
    times
}

// Data sheet: start-up timing, MEAS_CFG
#[test]
fn sensors_and_coefficients_are_ready_one_after_the_other() {
    let mut part = Spl06::new(Formula::default(), MS);
    let mut ready = |now| part.read(now, MEAS_CFG);
    assert_eq!([ready(2 * MS), ready(13 * MS), ready(41 * MS)], [0, 0x40, 0xC0]);
    assert_eq!(part.read(2 * MS, ID), 0x10);
}

// Data sheet: calibration coefficients, put together as a driver does it
#[test]
fn coefficients_are_those_of_the_formula() {
    let mut part = Spl06::new(Formula::default(), 0);
    let b: [u8; 18] = read(&mut part, 50 * MS, COEF);
    let signed = |value: u32, bits: u32| (value << (32 - bits)) as i32 >> (32 - bits);
    let [c0, c1, c00, c10] = [
        signed(u32::from(b[0]) << 4 | u32::from(b[1]) >> 4, 12),
        signed(u32::from(b[1] & 0xF) << 8 | u32::from(b[2]), 12),
        signed(
            u32::from(b[3]) << 12 | u32::from(b[4]) << 4 | u32::from(b[5]) >> 4,
            20,
        ),
        signed(
            u32::from(b[5] & 0xF) << 16 | u32::from(b[6]) << 8 | u32::from(b[7]),
            20,
        ),
    ];
    let pair = |n: usize| i16::from_be_bytes([b[n], b[n + 1]]);
    let read = Coefficients {
        c0: c0 as i16,
        c1: c1 as i16,
        c00,
        c10,
        c01: pair(8),
        c11: pair(10),
        c20: pair(12),
        c21: pair(14),
        c30: pair(16),
    };
    assert_eq!(read, Coefficients::default());
    assert!(part.misuse().is_empty());
}

// Data sheet: pressure configuration: times; temperature and pressure in turn
#[test]
fn measurements_in_the_background_come_at_their_rates() {
    let (mut part, start) = measuring();
    let times = run(&mut part, start + 100 * MS);
    let us = |time: &u64| (time - start) / MICROSECOND;
    assert_eq!(
        times.iter().map(us).collect::<Vec<_>>(),
        [3_600, 18_400, 34_850, 49_650, 66_100, 80_900, 97_350]
    );
    assert_eq!(part.misuse(), []);
}

#[test]
fn results_are_what_was_measured_and_ready_until_they_are_read() {
    let (mut part, start) = measuring();
    let now = start + 20 * MS;
    assert_eq!(part.read(start, MEAS_CFG), 0xC7);
    run(&mut part, now);
    assert_eq!(part.read(now, MEAS_CFG), 0xF7);
    assert_eq!(counts(&mut part, now), (COUNTS.pressure, COUNTS.temperature));
    assert_eq!(part.read(now, MEAS_CFG), 0xC7);
    // A sensor that fails leaves what was, and nothing is ready.
    let next = part.next_event();
    part.put(next, None);
    assert_eq!(part.read(next, MEAS_CFG), 0xC7);
    assert_eq!(counts(&mut part, next), (COUNTS.pressure, COUNTS.temperature));
}

// Data sheet: compensation scale factors
#[test]
fn other_oversampling_reads_the_same_pressure() {
    for (setting, oversampling) in OVERSAMPLING.into_iter().enumerate() {
        let mut part = Spl06::new(Formula::default(), 0);
        let shift = if setting > 3 { P_SHIFT } else { 0 };
        let now = 50 * MS;
        write(
            &mut part,
            now,
            &[(PRS_CFG, setting as u8), (TMP_CFG, 0x80), (CFG_REG, shift)],
        );
        for command in [TEMPERATURE, PRESSURE] {
            part.write(now, MEAS_CFG, command);
            run(&mut part, SECOND);
            assert_eq!(part.read(SECOND, MEAS_CFG) & 7, 0, "it stands by");
        }
        let (pressure, temperature) = counts(&mut part, SECOND);
        let read = Formula {
            pressure: oversampling,
            ..Formula::default()
        };
        let is = read.pressure(pressure, temperature);
        let was = Formula::default().pressure(COUNTS.pressure, COUNTS.temperature);
        assert!((is - was).abs() < 0.3, "{oversampling:?}: {is} Pa, {was} Pa");
        assert_eq!(part.misuse(), []);
    }
}

// Data sheet: RESET
#[test]
fn a_reset_forgets_the_configuration() {
    let (mut part, _) = measuring();
    part.write(SECOND, RESET, 0x89);
    assert_eq!(part.read(SECOND, PRS_CFG), 0);
    assert_eq!(part.read(SECOND, MEAS_CFG), 0);
    assert_eq!(part.next_event(), NEVER);
    assert_eq!(part.read(SECOND + 40 * MS, MEAS_CFG), 0xC0);
}

#[test]
fn what_its_data_sheet_forbids_is_noted() {
    let said = |writes: &[(u8, u8)]| {
        let mut part = Spl06::new(Formula::default(), 0);
        write(&mut part, 50 * MS, writes);
        part.misuse()
            .iter()
            .map(|(_, what)| what.clone())
            .collect::<Vec<_>>()
            .join("; ")
    };
    assert!(said(&[(PRS_CFG, 4), (TMP_CFG, 0x80), (MEAS_CFG, 1)]).contains("P_SHIFT"));
    assert!(said(&[(MEAS_CFG, 1)]).contains("TMP_EXT"));
    assert!(said(&[(PRS_CFG, 0x73), (TMP_CFG, 0x80), (MEAS_CFG, 7)]).contains("fit in a second"));
    assert!(said(&[(TMP_CFG, 0x80), (MEAS_CFG, 3)]).contains("does not exist"));
    assert!(said(&[(TMP_CFG, 0x80), (MEAS_CFG, 5), (PRS_CFG, 1)]).contains("while it measures"));
    assert!(said(&[(0x30, 1)]).contains("0x30"));
    let mut part = Spl06::new(Formula::default(), 0);
    part.read(MS, COEF);
    part.write(MS, TMP_CFG, 0x80);
    part.write(MS, MEAS_CFG, 1);
    assert_eq!(part.misuse().len(), 2, "{:?}", part.misuse());
}
