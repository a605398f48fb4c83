//! The model of the ICM-42688-P against its data sheet (DS-000347 rev. 1.7), one test a
//! statement. The clock here has 1000 ticks in a microsecond: times are in ns.

use windhover_model::sensor::icm42688p::{DataLine, Event, Icm42688p, Measurement, Misuse, NEVER};

const US: u64 = 1_000;
const MS: u64 = 1_000_000;

const INT_CONFIG: u8 = 0x14;
const TEMP_DATA1: u8 = 0x1D;
const ACCEL_DATA_X1: u8 = 0x1F;
const INT_STATUS: u8 = 0x2D;
const INTF_CONFIG0: u8 = 0x4C;
const PWR_MGMT0: u8 = 0x4E;
const GYRO_CONFIG0: u8 = 0x4F;
const ACCEL_CONFIG0: u8 = 0x50;
const INT_CONFIG0: u8 = 0x63;
const INT_CONFIG1: u8 = 0x64;
const INT_SOURCE0: u8 = 0x65;
const WHO_AM_I: u8 = 0x75;
const BANK: u8 = 0x76;

const MEASURED: Measurement = Measurement {
    accel: [0x0102, -2, 3],
    gyro: [-4, 5, -6],
    temperature: 0x0708,
};

struct Bench {
    part: Icm42688p,
    now: u64,
    measured: Measurement,
}

impl Bench {
    /// A part that can be accessed.
    fn new() -> Self {
        let mut bench = Self::cold();
        bench.wait(MS);
        bench
    }

    /// A part whose power comes on now.
    fn cold() -> Self {
        Self {
            part: Icm42688p::new(US),
            now: 0,
            measured: MEASURED,
        }
    }

    /// Both sensors at 1 kHz, past their start, INT1 pushed high in short pulses.
    fn sampling(int_config: u8, int_config1: u8) -> Self {
        let mut bench = Self::new();
        bench.write(INT_CONFIG, int_config);
        bench.write(INT_CONFIG1, int_config1);
        bench.write(INT_SOURCE0, 0x08);
        bench.write(PWR_MGMT0, 0x0F);
        bench.wait(50 * MS + 100 * US);
        bench
    }

    fn wait(&mut self, time: u64) -> Vec<Event> {
        self.now += time;
        let mut events = vec![];
        while let Some(event) = self.part.advance(self.now) {
            if let Event::Sample { .. } = event {
                self.part.put(&self.measured);
            }
            events.push(event);
        }
        events
    }

    /// When samples were taken during a wait.
    fn samples(&mut self, time: u64) -> Vec<u64> {
        let events = self.wait(time);
        events
            .iter()
            .filter_map(|event| match event {
                Event::Sample { time } => Some(*time),
                Event::Int1 { .. } => None,
            })
            .collect()
    }

    /// Changes of INT1 during a wait.
    fn edges(&mut self, time: u64) -> Vec<(u64, bool)> {
        let events = self.wait(time);
        events
            .iter()
            .filter_map(|event| match event {
                Event::Int1 { time, level } => Some((*time, *level)),
                Event::Sample { .. } => None,
            })
            .collect()
    }

    fn transaction<const N: usize>(&mut self, mosi: [u8; N]) -> [u8; N] {
        self.part.select();
        let miso = mosi.map(|byte| self.part.exchange(self.now, byte));
        self.part.deselect();
        miso
    }

    fn read(&mut self, address: u8) -> u8 {
        self.transaction([0x80 | address, 0])[1]
    }

    fn write(&mut self, address: u8, value: u8) {
        self.transaction([address, value]);
    }

    fn burst(&mut self) -> [u8; 14] {
        let mut mosi = [0; 15];
        mosi[0] = 0x80 | TEMP_DATA1;
        let [_, bytes @ ..] = self.transaction(mosi);
        bytes
    }
}

#[test]
fn identity_is_0x47() {
    assert_eq!(Bench::new().read(WHO_AM_I), 0x47);
}

#[test]
fn registers_hold_their_reset_values() {
    let mut bench = Bench::new();
    let bank0 = [
        (0x11, 0x00),
        (0x13, 0x05),
        (0x14, 0x00),
        (0x16, 0x00),
        (0x4C, 0x30),
        (0x4D, 0x91),
        (0x4E, 0x00),
        (0x4F, 0x06),
        (0x50, 0x06),
        (0x51, 0x16),
        (0x52, 0x11),
        (0x53, 0x0D),
        (0x54, 0x23),
        (0x56, 0x82),
        (0x62, 0x10),
        (0x63, 0x00),
        (0x64, 0x10),
        (0x65, 0x10),
    ];
    for (address, value) in bank0 {
        assert_eq!(bench.read(address), value, "{address:#04x}");
    }
    bench.write(BANK, 1);
    for (address, value) in [
        (0x0B, 0xA0),
        (0x0C, 0x0D),
        (0x0D, 0xAA),
        (0x0E, 0x80),
        (0x7A, 0x83),
    ] {
        assert_eq!(bench.read(address), value, "bank 1, {address:#04x}");
    }
    bench.write(BANK, 2);
    for (address, value) in [(0x03, 0x30), (0x04, 0x40), (0x05, 0x62)] {
        assert_eq!(bench.read(address), value, "bank 2, {address:#04x}");
    }
    bench.write(BANK, 4);
    assert_eq!(bench.read(0x40), 0xA2, "bank 4");
    assert_eq!(bench.part.misuse(), []);
}

#[test]
fn the_bank_selection_is_in_every_bank() {
    let mut bench = Bench::new();
    for bank in [1, 2, 3, 4, 0] {
        bench.write(BANK, bank);
        assert_eq!(bench.read(BANK), bank);
    }
}

#[test]
fn banks_do_not_share_registers() {
    let mut bench = Bench::new();
    bench.write(BANK, 2);
    bench.write(0x04, 0xAB);
    bench.write(BANK, 0);
    assert_eq!(bench.part.register(2, 0x04), 0xAB);
    assert_eq!(bench.part.register(0, 0x04), 0x00);
    assert_eq!(bench.part.register(4, 0x04), 0x00);
}

#[test]
fn addresses_count_up_within_a_transaction() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.transaction([0x80 | GYRO_CONFIG0, 0, 0, 0, 0])[1..],
        [0x06, 0x06, 0x16, 0x11]
    );
    bench.transaction([GYRO_CONFIG0, 0x04, 0x05]);
    assert_eq!((bench.read(GYRO_CONFIG0), bench.read(ACCEL_CONFIG0)), (4, 5));
}

#[test]
fn registers_answer_from_1_ms_after_power_on() {
    let mut bench = Bench::cold();
    bench.wait(MS - 1);
    assert_eq!(bench.read(WHO_AM_I), 0);
    bench.wait(1);
    assert_eq!(bench.read(WHO_AM_I), 0x47);
    assert_eq!(bench.part.misuse(), [Misuse::DuringReset]);
}

#[test]
fn a_soft_reset_restores_everything_within_1_ms() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.write(0x11, 0x01);
    assert_eq!(bench.read(WHO_AM_I), 0, "no access yet");
    bench.wait(MS);
    assert_eq!(bench.read(WHO_AM_I), 0x47);
    assert_eq!((bench.read(PWR_MGMT0), bench.read(INT_CONFIG)), (0, 0));
    assert_eq!(bench.samples(10 * MS), [0; 0]);
}

#[test]
fn a_finished_reset_shows_in_the_status_until_it_is_read() {
    let mut bench = Bench::new();
    assert_eq!(bench.read(INT_STATUS), 0x10);
    assert_eq!(bench.read(INT_STATUS), 0x00);
}

#[test]
fn data_registers_hold_minus_32768_until_the_first_sample() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.burst(),
        [0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80, 0]
    );
}

#[test]
fn the_accelerometer_starts_in_10_ms_and_the_gyroscope_in_30_ms() {
    let mut bench = Bench::new();
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(10 * MS);
    assert_eq!(bench.burst()[2..4], [0x80, 0]);
    bench.wait(MS);
    assert_eq!(bench.burst()[2..4], [0x01, 0x02]);
    assert_eq!(bench.burst()[8..10], [0x80, 0]);
    bench.wait(20 * MS);
    assert_eq!(bench.burst()[8..10], [0xFF, 0xFC]);
}

#[test]
fn samples_follow_the_output_data_rate() {
    for (code, period) in [(3, 125 * US), (4, 250 * US), (5, 500 * US), (6, MS), (15, 2 * MS)] {
        let mut bench = Bench::new();
        bench.write(GYRO_CONFIG0, code);
        bench.write(ACCEL_CONFIG0, code);
        bench.write(PWR_MGMT0, 0x0F);
        bench.wait(40 * MS);
        let samples = bench.samples(20 * MS);
        assert_eq!(samples.len() as u64, 20 * MS / period);
        assert!(samples.windows(2).all(|pair| pair[1] - pair[0] == period));
    }
}

#[test]
fn a_fast_oscillator_shortens_the_period() {
    let mut bench = Bench {
        part: Icm42688p::new(US).with_clock_error(10_000),
        ..Bench::cold()
    };
    bench.wait(MS);
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(11 * MS);
    assert_eq!(bench.samples(1000 * MS).len(), 1010);
}

#[test]
fn data_are_big_endian_after_a_reset() {
    let mut bench = Bench::sampling(0x03, 0x60);
    let expected = [7, 8, 1, 2, 0xFF, 0xFE, 0, 3, 0xFF, 0xFC, 0, 5, 0xFF, 0xFA];
    assert_eq!(bench.burst(), expected);
}

#[test]
fn data_can_be_little_endian() {
    let mut bench = Bench::new();
    bench.write(INTF_CONFIG0, 0x20);
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(50 * MS);
    assert_eq!(bench.burst()[..4], [8, 7, 2, 1]);
}

#[test]
fn a_burst_is_of_one_sample() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.part.select();
    bench.part.exchange(bench.now, 0x80 | ACCEL_DATA_X1);
    assert_eq!(bench.part.exchange(bench.now, 0), 0x01);
    bench.measured.accel[0] = 0x1234;
    bench.wait(MS);
    assert_eq!(bench.part.exchange(bench.now, 0), 0x02, "as when the burst began");
    bench.part.deselect();
    assert_eq!(bench.burst()[2..4], [0x12, 0x34]);
}

#[test]
fn a_valid_sample_is_never_minus_32768() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.measured.gyro[0] = i16::MIN;
    bench.wait(MS);
    assert_eq!(bench.burst()[8..10], [0x80, 0x01]);
}

#[test]
fn narrower_ranges_give_more_counts_and_end_sooner() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.write(GYRO_CONFIG0, 0x26); // ±1000 °/s
    bench.write(ACCEL_CONFIG0, 0x66); // ±2 g
    bench.measured.accel = [100, 5000, -5000];
    bench.wait(MS);
    let burst = bench.burst();
    assert_eq!(burst[2..4], 800_i16.to_be_bytes());
    assert_eq!(burst[4..6], i16::MAX.to_be_bytes());
    assert_eq!(burst[6..8], (-i16::MAX).to_be_bytes());
    assert_eq!(burst[8..10], (-8_i16).to_be_bytes());
}

#[test]
fn data_ready_shows_in_the_status_until_it_is_read() {
    let mut bench = Bench::sampling(0x03, 0x60);
    assert_eq!(bench.read(INT_STATUS) & 0x08, 0x08);
    assert_eq!(bench.read(INT_STATUS), 0);
    bench.wait(MS);
    assert_eq!(bench.read(INT_STATUS), 0x08);
}

#[test]
fn pulses_last_8_us_or_100_us() {
    for (int_config1, width) in [(0x60, 8 * US), (0x20, 100 * US)] {
        let mut bench = Bench::sampling(0x03, int_config1);
        let edges = bench.edges(2 * MS);
        assert_eq!(edges.len(), 4);
        assert_eq!((edges[0].1, edges[1].1), (true, false));
        assert_eq!(edges[1].0 - edges[0].0, width);
        assert_eq!(edges[2].0 - edges[0].0, MS);
    }
}

#[test]
fn an_active_low_pin_falls_at_a_sample() {
    let mut bench = Bench::sampling(0x02, 0x60);
    assert!(bench.part.int1());
    assert!(!bench.edges(MS)[0].1);
}

#[test]
fn long_pulses_do_not_fit_into_8_khz() {
    let mut bench = Bench::new();
    bench.write(INT_CONFIG, 0x03);
    bench.write(INT_CONFIG1, 0x00); // 100 µs, and as long a rest
    bench.write(INT_SOURCE0, 0x08);
    bench.write(GYRO_CONFIG0, 0x03);
    bench.write(ACCEL_CONFIG0, 0x03);
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(40 * MS);
    assert_eq!(bench.edges(10 * MS).len(), 80, "every other pulse is lost");
}

#[test]
fn int_async_reset_has_to_be_cleared() {
    let mut bench = Bench::sampling(0x03, 0x70);
    assert_eq!(bench.edges(10 * MS), []);
}

#[test]
fn int_source0_routes_data_ready() {
    let mut bench = Bench::new();
    bench.write(INT_CONFIG, 0x03);
    bench.write(INT_CONFIG1, 0x60);
    bench.write(INT_SOURCE0, 0x00);
    bench.write(PWR_MGMT0, 0x0F);
    assert_eq!(bench.edges(50 * MS), []);
}

#[test]
fn a_latched_pin_stays_until_the_status_is_read() {
    let mut bench = Bench::sampling(0x07, 0x60);
    assert!(bench.part.int1());
    bench.burst();
    assert!(bench.part.int1(), "reading data does not clear it");
    bench.read(INT_STATUS);
    assert!(!bench.part.int1());
    assert_eq!(bench.part.next_event(), bench.now, "the change is to be told");
}

#[test]
fn a_latched_pin_can_be_cleared_by_reading_data() {
    let mut bench = Bench::new();
    bench.write(INT_CONFIG0, 0x20);
    bench.write(INT_CONFIG, 0x07);
    bench.write(INT_CONFIG1, 0x60);
    bench.write(INT_SOURCE0, 0x08);
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(50 * MS);
    bench.read(INT_STATUS);
    assert!(bench.part.int1());
    bench.burst();
    assert!(!bench.part.int1());
}

#[test]
fn no_writes_for_200_us_after_a_sensor_is_turned_on() {
    let mut bench = Bench::new();
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(200 * US - 1);
    bench.write(GYRO_CONFIG0, 0x04);
    assert_eq!(bench.read(GYRO_CONFIG0), 0x06);
    let (bank, address) = (0, GYRO_CONFIG0);
    assert_eq!(bench.part.misuse(), [Misuse::TooSoon { bank, address }]);
}

#[test]
fn only_rate_range_and_mode_may_change_while_a_sensor_runs() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.write(GYRO_CONFIG0, 0x06);
    bench.write(ACCEL_CONFIG0, 0x06);
    assert_eq!(bench.part.misuse(), []);
    bench.write(0x52, 0x00);
    let (bank, address) = (0, 0x52);
    assert_eq!(bench.part.misuse(), [Misuse::WhileRunning { bank, address }]);
}

#[test]
fn the_gyroscope_stays_on_for_45_ms() {
    let mut bench = Bench::new();
    bench.write(PWR_MGMT0, 0x0F);
    bench.wait(45 * MS - 1);
    bench.write(PWR_MGMT0, 0x00);
    assert_eq!(bench.part.misuse(), [Misuse::GyroscopeTooShort]);
}

#[test]
fn reserved_and_read_only_registers_are_told_apart() {
    let mut bench = Bench::new();
    bench.write(0x12, 1);
    bench.write(WHO_AM_I, 1);
    let expected = [
        Misuse::Reserved {
            bank: 0,
            address: 0x12,
        },
        Misuse::ReadOnly {
            bank: 0,
            address: WHO_AM_I,
        },
    ];
    assert_eq!(bench.part.misuse(), expected);
}

#[test]
fn nobody_answers_where_no_part_is() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.part.unplug(bench.now);
    assert_eq!(bench.burst(), [0xFF; 14]);
    assert_eq!(bench.samples(10 * MS), [0; 0]);
    assert_eq!((bench.part.int1(), bench.part.next_event()), (false, NEVER));
}

#[test]
fn a_part_that_is_plugged_in_again_is_as_after_a_reset() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.part.unplug(bench.now);
    bench.wait(5 * MS);
    bench.part.plug(bench.now);
    bench.wait(MS);
    assert_eq!((bench.read(WHO_AM_I), bench.read(PWR_MGMT0)), (0x47, 0x00));
}

#[test]
fn a_damaged_line_gives_the_same_byte_always() {
    let mut bench = Bench::sampling(0x03, 0x60);
    for (line, byte) in [(DataLine::StuckHigh, 0xFF), (DataLine::StuckLow, 0x00)] {
        bench.part.set_data_line(line);
        assert_eq!(bench.burst(), [byte; 14]);
    }
    bench.part.set_data_line(DataLine::Connected);
    bench.read(WHO_AM_I);
    bench.part.set_data_line(DataLine::Repeats);
    assert_eq!(bench.burst(), [0x47; 14]);
}

#[test]
fn samples_go_on_while_the_interrupt_wire_is_broken() {
    let mut bench = Bench::sampling(0x03, 0x60);
    bench.part.connect_int1(bench.now, false);
    assert_eq!(bench.edges(5 * MS), []);
    bench.measured.accel[0] = 0x1234;
    bench.wait(MS);
    assert_eq!(bench.burst()[2..4], [0x12, 0x34]);
    bench.part.connect_int1(bench.now, true);
    assert_eq!(bench.edges(MS).len(), 2);
}
