//! A board on a desk, wired to sensors, its clock at 16 MHz.

use windhover_hil::board::{Board, Memory, Pin};
use windhover_hil::machine::Bus;
use windhover_hil::rig::{Rig, Setup, world};
use windhover_hil::time::{MICROSECOND, SECOND};
use windhover_model::sensor::gnss::GnssSite;
use windhover_model::{Conditions, Vehicle};
use windhover_sim::sensors::Sensors;

pub const MS: u64 = SECOND / 1000;
pub const GPIOB: u32 = 0x4002_0400;
pub const MODER: u32 = 0x00;
pub const IDR: u32 = 0x10;
pub const BSRR: u32 = 0x18;

/// No SRAM is used but by DMA.
pub struct Sram(Vec<u8>);

impl Memory for Sram {
    fn read(&mut self, address: u32, bytes: &mut [u8]) {
        let from = (address - 0x2000_0000) as usize;
        bytes.copy_from_slice(&self.0[from..from + bytes.len()]);
    }
    fn write(&mut self, address: u32, bytes: &[u8]) {
        let from = (address - 0x2000_0000) as usize;
        self.0[from..from + bytes.len()].copy_from_slice(bytes);
    }
}

pub struct Desk {
    pub board: Board<Rig>,
    pub memory: Sram,
    pub now: u64,
}

impl Desk {
    /// With a vehicle at rest and its sensors, and what else a test wants of the setup.
    pub fn new(faults: &[&str], change: impl FnOnce(&mut Setup)) -> Self {
        let vehicle = Vehicle::named("x450").unwrap();
        let home = GnssSite::default().home;
        let mut setup = Setup {
            faults: faults.iter().map(|text| text.parse().unwrap()).collect(),
            sensors: Some(Sensors::default().suite(&vehicle, home, 1000, 5)),
            ..Setup::default()
        };
        change(&mut setup);
        let world = world(&vehicle.plant, &Conditions::default());
        let mut desk = Self {
            board: Board::new(Rig::new(world, &setup)),
            memory: Sram(vec![0; 0x1000]),
            now: 0,
        };
        const RCC: u32 = 0x4002_3800;
        desk.write(RCC + 0x30, 0x0060_0007);
        desk.write(RCC + 0x40, 0x1022_0000);
        desk.write(RCC + 0x44, 0x0000_4130);
        desk
    }

    #[track_caller]
    pub fn read(&mut self, address: u32) -> u32 {
        self.board.read(self.now, address, 4, &mut self.memory).unwrap()
    }

    #[track_caller]
    pub fn write(&mut self, address: u32, value: u32) {
        self.board
            .write(self.now, address, 4, value, &mut self.memory)
            .unwrap();
    }

    #[track_caller]
    pub fn modify(&mut self, address: u32, change: impl FnOnce(u32) -> u32) {
        let old = self.read(address);
        self.write(address, change(old));
    }

    #[track_caller]
    pub fn wait(&mut self, ticks: u64) {
        self.now += ticks;
        self.board.advance(self.now, &mut self.memory).unwrap();
    }

    /// Reads a register each microsecond until these bits are set, or the time is over.
    #[track_caller]
    pub fn poll(&mut self, address: u32, bits: u32, until: u64) -> Option<u32> {
        loop {
            let value = self.read(address);
            if value & bits != 0 {
                return Some(value);
            }
            if self.now > until {
                return None;
            }
            self.wait(MICROSECOND);
        }
    }

    /// Switches a pin: MODER's two bits, and the alternate function.
    pub fn switch(&mut self, pin: Pin, mode: u32, function: u32) {
        let port = 0x4002_0000 + 0x400 * u32::from(pin.port);
        let number = u32::from(pin.number);
        let shift = 4 * (number % 8);
        self.modify(port + 0x20 + 4 * (number / 8), |afr| {
            afr & !(0xF << shift) | function << shift
        });
        self.modify(port + MODER, |moder| {
            moder & !(3 << (2 * number)) | mode << (2 * number)
        });
    }
}
