//! scratch
use std::sync::Arc;
use windhover_hil::board::{Board, Inputs, Pin, PwmPulse, Usart, Wiring};
use windhover_hil::elf::Elf;
use windhover_hil::machine::{Machine, Options};
use windhover_hil::time::{NEVER, SECOND};
#[derive(Default)]
struct Null { bytes: Vec<u8>, pulses: Vec<(u64, Pin, PwmPulse)> }
impl Wiring for Null {
    fn spi(&mut self, _: u64, _: u8) -> u8 { 0xff }
    fn output(&mut self, now: u64, pin: Pin, level: bool) { if now < SECOND/50 {println!("{now} {pin:?} {level}");} }
    fn pwm(&mut self, now: u64, pin: Pin, pulse: PwmPulse) { self.pulses.push((now, pin, pulse)); }
    fn pwm_stopped(&mut self, now: u64, pin: Pin) {println!("{now} {pin:?} stopped"); }
    fn transmitted(&mut self, _: u64, port: Usart, byte: u8) { if port == Usart(3) { self.bytes.push(byte); } }
    fn next_event(&self) -> u64 { NEVER }
    fn advance(&mut self, _: u64, _: &mut Inputs) {}
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let bytes = std::fs::read(&a[1]).unwrap();
    let elf = Arc::new(Elf::parse(bytes).unwrap());
    let mut m = Machine::new(Board::new(Null::default()), elf, Options::default()).unwrap();
    let t = std::time::Instant::now();
    let r = m.run(SECOND * 2);
    if let Err(e) = &r { println!("{e}"); }
    println!("{} s virtual in {:?}, {} instructions, resets {:?}", m.now() as f64 / SECOND as f64, t.elapsed(), m.instructions(), m.resets());
    println!("asleep {:.3}", m.load().asleep as f64 / m.load().total() as f64);
    let b = m.bus();
    println!("log {} bytes, pulses {} {:?}", b.wiring.bytes.len(), b.wiring.pulses.len(), b.wiring.pulses.last());
    std::fs::write("/tmp/boot.ulg", &b.wiring.bytes).unwrap();
}
