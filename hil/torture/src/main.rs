//! A program that torments the processor that runs it, and says what came of it.
#![no_std]
#![no_main]

mod conditional;
mod faults;
mod handlers;
mod kernel;
mod scenario;
mod sleep;
mod tester;
mod threads;

use defmt_rtt as _;

use core::panic::PanicInfo;
use cortex_m_rt::entry;
use scenario::Scenario;

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    tester::report(0xDEAD);
    tester::finish()
}

#[entry]
fn main() -> ! {
    threads::enable_lines();
    run(Scenario::ALL[tester::scenario() as usize]);
    tester::finish()
}

fn run(scenario: Scenario) {
    use Scenario as S;
    match scenario {
        S::Storm => threads::storm(),
        S::Pages => threads::pages(),
        S::ProcessStack => threads::process_stack(),
        S::Primask => threads::primask(),
        S::Basepri => threads::basepri(),
        S::Faultmask => threads::faultmask(),
        S::Supervisor => threads::supervisor(),
        S::Order => threads::order(handlers::Duty::LogAndPend),
        S::Subpriority => threads::subpriority(),
        S::Reprioritise => threads::order(handlers::Duty::LogAndSwap),
        S::Pend => threads::pend(),
        S::Level => threads::level(),
        S::Nmi => threads::nmi(),
        S::SkippedFloat => threads::skipped_float(),
        S::Conditional => threads::conditional(),
        S::VectorTable => threads::vector_table(),
        S::Exclusive => threads::exclusive(),
        S::Reset => threads::reset(),
        S::Known => threads::known(true),
        S::Calls => threads::known(false),
        S::Wfi => sleep::wfi(),
        S::Wfe => sleep::wfe(),
        S::WfiPrimask => sleep::wfi_primask(),
        S::SevOnPend => sleep::sev_on_pend(),
        S::SleepOnExit => sleep::sleep_on_exit(),
        S::Yield => sleep::spin(),
        S::SysTick => sleep::systick(),
        S::CycleCounter => sleep::cycle_counter(),
        S::Compute => tester::report(kernel::run(0, &kernel::input(), 1_000_000)[0]),
        S::FlashBusy => sleep::flash_busy(),
        S::FlashProgram => threads::flash_program(),
        S::Log => defmt::info!("{=u32} of {=str}", 3, "four"),
        S::LogReset => threads::log_and_reset(),
        S::SleepForEver => loop {
            cortex_m::asm::wfi();
        },
        fault => provoke(fault),
    }
}

#[inline(never)]
fn provoke(fault: Scenario) {
    use Scenario as S;
    match fault {
        S::StackOverflow => tester::report(faults::overflow(0)),
        S::StackFullAtInterrupt => faults::interrupt_on_full_stack(0),
        S::Undefined => faults::undefined(),
        S::UsageFault => {
            faults::enable_handlers();
            faults::undefined();
        }
        S::UnmappedLoad => faults::load(),
        S::BusFault => {
            faults::enable_handlers();
            faults::load();
        }
        S::UnmappedStore => faults::store_nowhere(),
        S::FlashStore => faults::store(0x0800_0000),
        S::ExecuteRam => faults::jump(0x2000_1001),
        S::ExecuteCcm => faults::jump(0x1000_1001),
        S::ExecutePeripheral => faults::jump(0x4000_0001),
        S::ArmState => faults::jump(0x0800_1000),
        S::NullCall => faults::jump(0),
        S::Breakpoint => cortex_m::asm::bkpt(),
        S::SupervisorInHandler => {
            handlers::duty(0, handlers::Duty::Supervise);
            tester::raise(0);
        }
        S::InvalidReturn => faults::return_to_nobody(),
        S::NoVectors => threads::no_vectors(),
        S::Lockup => faults::fault_again(),
        S::UnknownRegister => faults::store(0x4000_7000),
        _ => tester::report(0xBAD),
    }
}
