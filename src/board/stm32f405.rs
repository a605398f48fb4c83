//! What all boards with an STM32F405 share: clocks, brown-out, priorities, stack, sleep.

use core::cell::RefCell;
use core::ops::Range;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use embassy_embedded_hal::adapter::BlockingAsync;
use embassy_executor::{InterruptExecutor, SendSpawner, Spawner, raw};
use embassy_futures::block_on;
use embassy_stm32::flash::{Bank1Region1, Blocking, Flash};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{FLASH, IWDG, TIM5};
use embassy_stm32::time::Hertz;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, Peri, peripherals, rcc};
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_time::Instant;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use static_cell::StaticCell;
use windhover_autopilot::mission::PlanMemory;

use crate::shared::{self, COUNTERS};

/// Processor cycles in a microsecond.
pub const CYCLES_PER_MICROSECOND: f32 = 168.0;

/// The start of the core-coupled memory is stack (memory.x): below it there is nothing, so that an
/// overflow faults. DMA cannot reach it.
pub const STACK: Range<u32> = 0x1000_0000..0x1000_a800;

/// What cortex-m-rt paints the stack with before `main`.
const PAINT: u32 = 0xcccc_cccc;

/// The executor of the inner loop. Its interrupt, like that of the outer one, is of a peripheral
/// that no board uses; software raises it.
pub static INNER: InterruptExecutor = InterruptExecutor::new();

/// The executor of the log.
pub static LOG: InterruptExecutor = InterruptExecutor::new();

/// The executor of the outer loop.
pub static OUTER: InterruptExecutor = InterruptExecutor::new();

/// The number of the inner executor's interrupt.
pub const INNER_INTERRUPT: u16 = interrupt::CAN1_TX as u16;

/// The number of the log executor's interrupt.
pub const LOG_INTERRUPT: u16 = interrupt::CAN1_RX1 as u16;

/// The number of the outer executor's interrupt.
pub const OUTER_INTERRUPT: u16 = interrupt::CAN1_RX0 as u16;

#[embassy_stm32::interrupt]
unsafe fn CAN1_TX() {
    // SAFETY: this is the interrupt that `INNER` was started with.
    unsafe { INNER.on_interrupt() }
}

#[embassy_stm32::interrupt]
unsafe fn CAN1_RX0() {
    // SAFETY: this is the interrupt that `OUTER` was started with.
    unsafe { OUTER.on_interrupt() }
}

#[embassy_stm32::interrupt]
unsafe fn CAN1_RX1() {
    // SAFETY: this is the interrupt that `LOG` was started with.
    unsafe { LOG.on_interrupt() }
}

/// 168 MHz from a crystal of 8 MHz; APB1 at 42 MHz, APB2 at 84 MHz, all timers at 84 or 168 MHz.
pub fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(rcc::Hse {
        freq: Hertz(8_000_000),
        mode: rcc::HseMode::Oscillator,
    });
    config.rcc.pll_src = rcc::PllSource::HSE;
    config.rcc.pll = Some(rcc::Pll {
        prediv: rcc::PllPreDiv::DIV4,
        mul: rcc::PllMul::MUL168,
        divp: Some(rcc::PllPDiv::DIV2),
        divq: Some(rcc::PllQDiv::DIV7),
        divr: None,
    });
    config.rcc.ahb_pre = rcc::AHBPrescaler::DIV1;
    config.rcc.apb1_pre = rcc::APBPrescaler::DIV4;
    config.rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config.rcc.sys = rcc::Sysclk::PLL1_P;
    // No calendar: without this the HAL selects its clock in one place and clears it in another.
    config.rcc.ls = rcc::LsConfig::off();
    config
}

/// Starts the processor's cycle counter, by which loads are measured.
pub fn count_cycles() {
    // SAFETY: called once, before any other code uses these registers.
    let mut processor = unsafe { cortex_m::Peripherals::steal() };
    processor.DCB.enable_trace();
    processor.DWT.enable_cycle_counter();
}

/// The first four sectors of the flash, 16 KiB each. Nothing is changed while motors may turn.
pub struct Storage(BlockingAsync<Bank1Region1<'static, Blocking>>);

/// Where in [`Storage`] the journal is: sectors 1 to 3 (memory.x), behind the vector table.
pub const STORED: Range<u32> = 0x4000..0x1_0000;

/// The flash for what outlasts power.
pub fn storage(flash: Peri<'static, peripherals::FLASH>) -> Storage {
    let flash = Flash::new_blocking(flash).into_blocking_regions();
    Storage(BlockingAsync::new(flash.bank1_region1))
}

impl ErrorType for Storage {
    type Error = embassy_stm32::flash::Error;
}

impl ReadNorFlash for Storage {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Storage {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 0x4000;

    /// The processor stands still for 0.4 to 0.8 s, since its code lies in the same flash.
    /// Time stands still with it: its interrupts come more often than that. The watchdog waits longer
    /// meanwhile.
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        cortex_m::interrupt::free(|_| {
            refuse_while_armed()?;
            let before = relax_watchdog();
            TIM5.cr1().modify(|control| control.set_cen(false));
            let outcome = block_on(self.0.erase(from, to));
            TIM5.cr1().modify(|control| control.set_cen(true));
            tighten_watchdog(before);
            outcome
        })
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        refuse_while_armed()?;
        // Word by word, 16 µs each: interrupts come in between.
        self.0.write(offset, bytes).await
    }
}

/// Whoever names tasks does not do so while armed; this is the second guard.
fn refuse_while_armed() -> Result<(), embassy_stm32::flash::Error> {
    match shared::value(&COUNTERS.armed) {
        0 => Ok(()),
        _ => Err(embassy_stm32::flash::Error::Protected),
    }
}

/// The watchdog's key for access to its registers, and the one that feeds it.
const WATCHDOG_ACCESS: u16 = 0x5555;
const WATCHDOG_FEED: u16 = 0xaaaa;

/// Prescaler 32 in place of 4: 2 s in place of 250 ms.
const RELAXED: u8 = 3;

/// Gives the watchdog eight times its time, if it runs; its prescaler before.
fn relax_watchdog() -> Option<u8> {
    if !WATCHDOG_RUNS.load(Ordering::Relaxed) {
        return None;
    }
    let before = IWDG.pr().read().pr().to_bits();
    set_watchdog_prescaler(RELAXED);
    Some(before)
}

fn tighten_watchdog(before: Option<u8>) {
    if let Some(before) = before {
        set_watchdog_prescaler(before);
    }
}

/// Sets the prescaler and feeds the watchdog with it. The new value takes five cycles of 30 µs to
/// arrive; were it not to, the watchdog resets, which is what it is for.
fn set_watchdog_prescaler(prescaler: u8) {
    const PATIENCE: u32 = 168_000;
    IWDG.kr()
        .write(|key| key.set_key(Key::from_bits(WATCHDOG_ACCESS)));
    IWDG.pr().write(|value| value.set_pr(Pr::from_bits(prescaler)));
    for _ in 0..PATIENCE {
        if !IWDG.sr().read().pvu() {
            break;
        }
    }
    IWDG.kr().write(|key| key.set_key(Key::from_bits(WATCHDOG_FEED)));
}

static WATCHDOG_RUNS: AtomicBool = AtomicBool::new(false);

/// Starts the watchdog: it resets when it is not fed for `timeout` µs.
pub fn watch(
    watchdog: Peri<'static, peripherals::IWDG>,
    timeout: u32,
) -> IndependentWatchdog<'static, peripherals::IWDG> {
    let mut watchdog = IndependentWatchdog::new(watchdog, timeout);
    watchdog.unleash();
    WATCHDOG_RUNS.store(true, Ordering::Relaxed);
    watchdog
}

/// Sets the brown-out reset to level 3, 2.7 V, once and for all: below it flash and processor are
/// out of their range while the supply collapses. To be called before clocks are set up: while
/// option bytes are written the processor stands still, and the time driver would lose periods.
pub fn set_brown_out_level_3() {
    /// `BOR_LEV` of level 3 (RM0090, 3.9.10).
    const LEVEL_3: u8 = 0;
    if FLASH.optcr().read().bor_lev() == LEVEL_3 {
        return;
    }
    FLASH.optkeyr().write_value(0x0819_2A3B);
    FLASH.optkeyr().write_value(0x4C5D_6E7F);
    while FLASH.sr().read().bsy() {}
    FLASH.optcr().modify(|options| options.set_bor_lev(LEVEL_3));
    FLASH.optcr().modify(|options| options.set_optstrt(true));
    while FLASH.sr().read().bsy() {}
    FLASH.optcr().modify(|options| options.set_optlock(true));
}

/// The deepest that the stack has been since start, in bytes.
pub fn stack_used() -> u32 {
    let untouched = STACK
        .step_by(4)
        // SAFETY: aligned words of memory that exists; others may write the ones above, and any
        // value is fine.
        .take_while(|address| unsafe { (*address as *const u32).read_volatile() } == PAINT)
        .count();
    STACK.len() as u32 - 4 * untouched as u32
}

/// The chip's own number, as ground stations know the vehicle by.
pub fn uid() -> u64 {
    let [a, b, c, d, e, f, g, h, ..] = embassy_stm32::uid::uid();
    u64::from_le_bytes([a, b, c, d, e, f, g, h])
}

/// The plans on board, in core-coupled memory above the stack (memory.x).
#[unsafe(link_section = ".ccm")]
pub static PLANS: CriticalSectionMutex<RefCell<PlanMemory>> =
    CriticalSectionMutex::new(RefCell::new(PlanMemory::new()));

/// Zeroes the core-coupled memory above the stack. To be called once, before `main`.
pub fn clear_core_coupled() {
    unsafe extern "C" {
        static mut __sccm: u64;
        static mut __eccm: u64;
    }
    let (mut word, end) = (&raw mut __sccm, &raw mut __eccm);
    while word < end {
        // SAFETY: the linker puts both ends around the section, which holds statics whose first value
        // is nothing but zeros; nobody uses them yet.
        unsafe {
            word.write_volatile(0);
            word = word.add(1);
        }
    }
}

/// Starts the four executors: `spawn` gets those of the inner loop, of the log, of the outer loop and
/// of the thread, which runs for ever and sleeps while there is nothing to do.
///
/// The log is above the outer loop: it takes little time, and is to have it also where that loop takes
/// nearly all there is, which is when one wants to read it.
pub fn on_every_priority(spawn: impl FnOnce(SendSpawner, SendSpawner, SendSpawner, Spawner)) -> ! {
    static THREAD: StaticCell<raw::Executor> = StaticCell::new();
    // The context is what embassy-executor's pender takes for "wake the thread".
    let thread = THREAD.init(raw::Executor::new(usize::MAX as *mut ()));
    interrupt::CAN1_TX.set_priority(Priority::P4);
    interrupt::CAN1_RX1.set_priority(Priority::P6);
    interrupt::CAN1_RX0.set_priority(Priority::P8);
    spawn(
        INNER.start(interrupt::CAN1_TX),
        LOG.start(interrupt::CAN1_RX1),
        OUTER.start(interrupt::CAN1_RX0),
        thread.spawner(),
    );
    loop {
        // SAFETY: polled from here only.
        unsafe { thread.poll() };
        sleep();
    }
}

/// Sleeps until something happens. Interrupts stay off until the time asleep is known, so that
/// what they do does not count as sleep; a pending one wakes all the same (`SEVONPEND`). A function
/// of its own: here the emulated board lets the thread spin.
#[inline(never)]
fn sleep() {
    cortex_m::interrupt::free(|_| {
        // SAFETY: only this code writes the register.
        unsafe { (*SCB::PTR).scr.modify(|scr| scr | 1 << 4) };
        let begin = Instant::now();
        cortex_m::asm::wfe();
        shared::add(&COUNTERS.asleep, begin.elapsed().as_micros() as u32);
    });
}
