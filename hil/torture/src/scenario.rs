//! What the program can be told to do; the tests on the other side of the bus include this file.

macro_rules! scenarios {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// One run of the program.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u32)]
        pub enum Scenario {
            $($(#[$doc])* $name,)*
        }

        impl Scenario {
            /// All of them, by number.
            #[allow(dead_code, reason = "the program looks itself up, the tests do not")]
            pub const ALL: &'static [Self] = &[$(Self::$name),*];
        }
    };
}

scenarios! {
    /// The kernel under a storm of interrupts: mismatches, interrupts handled, deepest nesting.
    Storm,
    /// The same with a page boundary at each halfword of the kernel: mismatches, interrupts.
    Pages,
    /// The same on the process stack: mismatches, interrupts.
    ProcessStack,
    /// A storm under PRIMASK: handled before and after it is opened.
    Primask,
    /// A storm under BASEPRI 0x50: of each line handled before it is opened, then after.
    Basepri,
    /// Under FAULTMASK a line is raised, then a handler sets it: handled inside, FAULTMASK after.
    Faultmask,
    /// SVC from a thread: how often its handler ran after each, the number it was given.
    Supervisor,
    /// The order in which pending exceptions of several priorities run.
    Order,
    /// The same when a group priority bit takes part.
    Subpriority,
    /// A handler lowers and raises priorities of pending interrupts: the order.
    Reprioritise,
    /// Pending set and cleared by software: handled after ISPR, ICPR, STIR.
    Pend,
    /// A line that is not acknowledged at once: handled.
    Level,
    /// NMI in a handler of priority 0 under PRIMASK: the order.
    Nmi,
    /// S0 to S15 of a context whose first floating-point instruction is skipped: mismatches.
    SkippedFloat,
    /// A thousand WFI: how many woke, interrupts handled.
    Wfi,
    /// SEV before WFE, and WFE until an interrupt: ticks asleep in each.
    Wfe,
    /// WFI under PRIMASK: handled before and after it is opened.
    WfiPrimask,
    /// WFE under PRIMASK with SEVONPEND: handled before and after it is opened.
    SevOnPend,
    /// SLEEPONEXIT: thread rounds between two interrupts.
    SleepOnExit,
    /// YIELD is no operation.
    Yield,
    /// SysTick: exceptions in a thousand microseconds, COUNTFLAG once and then not.
    SysTick,
    /// CYCCNT: counts awake; counted while asleep.
    CycleCounter,
    /// A vector table in RAM: which handler ran.
    VectorTable,
    /// Accesses in IT blocks to memory that nobody touched, and branches to code that never ran:
    /// those that went wrong with RAM, with registers, with flash.
    Conditional,
    /// LDREX and STREX against handlers that do the same: sum in the end, expected sum.
    Exclusive,
    /// Pushes until the stack overflows into nothing.
    StackOverflow,
    /// An interrupt comes when the stack is full.
    StackFullAtInterrupt,
    /// An undefined instruction.
    Undefined,
    /// The same, with UsageFault enabled and a handler that steps over it.
    UsageFault,
    /// A load from nowhere.
    UnmappedLoad,
    /// The same, with BusFault enabled and a handler that steps over it.
    BusFault,
    /// A store to nowhere.
    UnmappedStore,
    /// A store into flash that nobody unlocked.
    FlashStore,
    /// A jump into SRAM.
    ExecuteRam,
    /// A jump into CCM.
    ExecuteCcm,
    /// A jump to a peripheral.
    ExecutePeripheral,
    /// A jump to an even address.
    ArmState,
    /// A call of the null pointer.
    NullCall,
    /// BKPT.
    Breakpoint,
    /// SVC in a handler of higher priority.
    SupervisorInHandler,
    /// A handler returns by an EXC_RETURN that does not fit.
    InvalidReturn,
    /// A vector table that is nowhere.
    NoVectors,
    /// A fault in the HardFault handler.
    Lockup,
    /// SYSRESETREQ: what RAM held across it.
    Reset,
    /// A register that does not exist.
    UnknownRegister,
    /// Calls a function of known length under a storm.
    Known,
    /// Calls the same function in peace, ten microseconds apart, and says when.
    Calls,
    /// The kernel in peace, for long: a word of its result.
    Compute,
    /// Flash is busy for a millisecond and an interrupt comes meanwhile: handled, microseconds.
    FlashBusy,
    /// A store into unlocked flash: what is read back.
    FlashProgram,
    /// Says a few words by defmt.
    Log,
    /// The same, and resets at once; nothing at the second boot.
    LogReset,
    /// Sleeps for ever without an interrupt.
    SleepForEver,
}
