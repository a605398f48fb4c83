//! SpeedyBee F405 V4: STM32F405RG, 8 MHz crystal.
//!
//! Pins as in ArduPilot's `speedybeef4v4/hwdef.dat` and Betaflight's `SPEEDYBEEF405V4/config.h`.
//!
//! | what | pins | peripheral, DMA |
//! |---|---|---|
//! | inertial sensors | SCK PA5, MISO PA6, MOSI PA7, select PA4, data-ready PC4 | SPI1, D2S0 and D2S3 |
//! | M1 | PB6 | TIM4 channel 1 |
//! | M2 | PB7 | TIM4 channel 2 |
//! | M3 | PB0 | TIM3 channel 3 |
//! | M4 | PB1 | TIM3 channel 4 |
//! | log | TX PC10 | USART3, D1S3 |
//! | ground link | RX PA10, TX PA9 | USART1, D2S2 and D2S7 |
//! | satellite receiver | RX PC7, TX PC6 | USART6, D2S1 and D2S6 |
//! | remote control | RX PA3 | USART2, D1S5 |
//! | barometer, compass | SCL PB8, SDA PB9 | I2C1 |
//! | battery | voltage PC0, current PC1 | ADC1 |
//! | light | PC13, on when low | |

use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::gpio::{Level, Output, OutputType, Speed};
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::mode::Async;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::pac::{self, EXTI, GPIOB, GPIOC, RCC, SYSCFG};
use embassy_stm32::peripherals::{
    ADC1, IWDG, PB0, PB1, PB6, PB7, PC0, PC1, TIM3, TIM4, USART1, USART2, USART6,
};
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm, SimplePwmChannel};
use embassy_stm32::usart::{self, Uart, UartRx, UartTx};
use embassy_stm32::{Peri, bind_interrupts, dma, interrupt, peripherals};
use embassy_time::Instant;
use static_cell::ConstStaticCell;
use windhover_autopilot::MotorCommand;
use windhover_autopilot::sensing::BoardRotation;
use windhover_drivers::icm42688p::Icm42688p;
use windhover_drivers::pulse;

use super::sensor_bus::SensorBus;
use super::serial::{SerialReceiver, baud};
use super::stm32f405;
use crate::shared::DATA_READY;

/// The board's name, as its maker writes it.
pub const NAME: &str = "SpeedyBee F405 V4";

/// How the inertial sensors sit: front is the part's y, right its x, down against its z.
/// ArduPilot's PITCH_180_YAW_270 (axes front, right, down) and Betaflight's CW90 (front, left,
/// up) both say so. To verify: nose up must turn the specific force to the front positive, right
/// side down to the right negative; at rest down reads −1 g.
pub const ROTATION: BoardRotation = BoardRotation([[0, 1, 0], [1, 0, 0], [0, 0, -1]]);

/// Baud rate of the port to ground stations.
pub const GROUND_LINK_BAUD: u32 = 115_200;

/// The inertial sensors on their bus.
pub type Imu = Icm42688p<Spi<'static, Async, spi::mode::Master>, Output<'static>>;

/// Pads M1 to M4: their pin numbers on port B.
const MOTOR_PINS: [u32; 4] = [6, 7, 0, 1];

/// A register with these bits for each of the motors' pins, so many bits a pin.
const fn spread(width: u32, bits: u32) -> u32 {
    let [m1, m2, m3, m4] = MOTOR_PINS;
    bits << (width * m1) | bits << (width * m2) | bits << (width * m3) | bits << (width * m4)
}

bind_interrupts!(struct Interrupts {
    DMA2_STREAM0 => dma::InterruptHandler<peripherals::DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
    DMA1_STREAM3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
    DMA1_STREAM5 => dma::InterruptHandler<peripherals::DMA1_CH5>;
    DMA2_STREAM1 => dma::InterruptHandler<peripherals::DMA2_CH1>;
    DMA2_STREAM2 => dma::InterruptHandler<peripherals::DMA2_CH2>;
    DMA2_STREAM6 => dma::InterruptHandler<peripherals::DMA2_CH6>;
    DMA2_STREAM7 => dma::InterruptHandler<peripherals::DMA2_CH7>;
    USART1 => usart::InterruptHandler<USART1>;
    USART2 => usart::InterruptHandler<USART2>;
    USART6 => usart::InterruptHandler<USART6>;
});

/// Drives the motor pins low, and holds the timers behind them in reset: an electronic speed
/// controller that sees no pulse does not turn.
///
/// It needs no clock setup, no driver and no memory, so it can be the first thing that runs, and
/// it may be called at any time. The level is set before the direction, so that no pin goes high
/// meanwhile. Whoever sets up a timer releases it.
pub fn motors_off() {
    RCC.ahb1enr().modify(|enable| enable.set_gpioben(true));
    RCC.ahb1enr().read(); // errata: a port answers two cycles after its clock is enabled
    // As masks: built for size, pin by pin takes too long at the clock of a reset.
    GPIOB.bsrr().write(|set| set.0 = const { spread(1, 1) } << 16);
    GPIOB.otyper().modify(|kind| kind.0 &= !const { spread(1, 1) });
    GPIOB
        .moder()
        .modify(|mode| mode.0 = mode.0 & !const { spread(2, 0b11) } | const { spread(2, 0b01) });
    RCC.apb1rstr().modify(|reset| {
        reset.set_tim3rst(true);
        reset.set_tim4rst(true);
    });
}

/// The light's pin for on or off.
pub fn light(on: bool) -> Level {
    if on { Level::Low } else { Level::High }
}

/// Everything that hangs on the microcontroller.
pub struct Board {
    /// The inertial sensors, not set up yet.
    pub imu: Imu,
    /// What the motors' pins and timers are made of, still off.
    pub motors: MotorParts,
    /// Where the log goes.
    pub log: UartTx<'static, Async>,
    /// The port to ground stations.
    pub ground_link: (SerialReceiver, UartTx<'static, Async>),
    /// The port of the satellite receiver.
    pub gnss: (SerialReceiver, UartTx<'static, Async>),
    /// The port of the remote control's receiver.
    pub remote: SerialReceiver,
    /// The bus of barometer and compass.
    pub sensor_bus: SensorBus,
    /// The battery's voltage and current.
    pub battery: BatteryInputs,
    /// The light.
    pub light: Output<'static>,
    /// The watchdog, not running yet.
    pub watchdog: Peri<'static, IWDG>,
    /// The flash that parameters are stored in.
    pub storage: stm32f405::Storage,
}

/// The battery's two inputs.
pub struct BatteryInputs {
    converter: Adc<'static, ADC1>,
    voltage: Peri<'static, PC0>,
    current: Peri<'static, PC1>,
}

impl BatteryInputs {
    /// Counts of voltage and current. Takes 50 µs.
    pub fn read(&mut self) -> [u16; 2] {
        [
            self.converter
                .blocking_read(&mut self.voltage, SampleTime::CYCLES480),
            self.converter
                .blocking_read(&mut self.current, SampleTime::CYCLES480),
        ]
    }
}

/// Pins and timers of the motors, before their pulse rate is known.
pub struct MotorParts {
    tim3: Peri<'static, TIM3>,
    tim4: Peri<'static, TIM4>,
    m1: Peri<'static, PB6>,
    m2: Peri<'static, PB7>,
    m3: Peri<'static, PB0>,
    m4: Peri<'static, PB1>,
}

/// Sets up everything but the motors, whose pins stay low.
pub fn take() -> Board {
    static GROUND: ConstStaticCell<[u8; 1024]> = ConstStaticCell::new([0; _]);
    static GNSS: ConstStaticCell<[u8; 512]> = ConstStaticCell::new([0; _]);
    static REMOTE: ConstStaticCell<[u8; 512]> = ConstStaticCell::new([0; _]);
    stm32f405::set_brown_out_level_3();
    let p = embassy_stm32::init(stm32f405::config());
    stm32f405::count_cycles();
    let mut bus = spi::Config::default();
    bus.mode = spi::MODE_3;
    bus.frequency = Hertz(10_500_000);
    let bus = Spi::new(
        p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, bus,
    );
    let select = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    listen_to_data_ready();
    // SAFETY (of each clone): the HAL's receiver holds its channel and never uses it.
    let ground_link = {
        let stream = dma::Channel::new(unsafe { p.DMA2_CH2.clone_unchecked() }, Interrupts);
        let port = Uart::new(
            p.USART1,
            p.PA10,
            p.PA9,
            p.DMA2_CH7,
            p.DMA2_CH2,
            Interrupts,
            baud(GROUND_LINK_BAUD),
        );
        both_ways(port, pac::USART1, stream, 4, GROUND.take())
    };
    let gnss = {
        let stream = dma::Channel::new(unsafe { p.DMA2_CH1.clone_unchecked() }, Interrupts);
        let port = Uart::new(
            p.USART6,
            p.PC7,
            p.PC6,
            p.DMA2_CH6,
            p.DMA2_CH1,
            Interrupts,
            baud(115_200),
        );
        both_ways(port, pac::USART6, stream, 5, GNSS.take())
    };
    let remote = {
        let stream = dma::Channel::new(unsafe { p.DMA1_CH5.clone_unchecked() }, Interrupts);
        let port = UartRx::new(p.USART2, p.PA3, p.DMA1_CH5, Interrupts, baud(420_000));
        let receiver = port.expect("420,000 baud are 100 cycles of the port's clock");
        SerialReceiver::new(receiver, pac::USART2, stream, 4, REMOTE.take())
    };
    Board {
        imu: Icm42688p::new(bus, select),
        motors: MotorParts {
            tim3: p.TIM3,
            tim4: p.TIM4,
            m1: p.PB6,
            m2: p.PB7,
            m3: p.PB0,
            m4: p.PB1,
        },
        log: UartTx::new(p.USART3, p.PC10, p.DMA1_CH3, Interrupts, baud(2_000_000))
            .expect("2 Mbaud are 21 cycles of the port's clock"),
        ground_link,
        gnss,
        remote,
        sensor_bus: SensorBus::new(p.I2C1, p.PB8, p.PB9),
        battery: BatteryInputs {
            converter: Adc::new(p.ADC1),
            voltage: p.PC0,
            current: p.PC1,
        },
        light: Output::new(p.PC13, light(false), Speed::Low),
        watchdog: p.IWDG,
        storage: stm32f405::storage(p.FLASH),
    }
}

/// The halves of a port that receives into `buffer`; see [`SerialReceiver::new`].
fn both_ways(
    port: Result<Uart<'static, Async>, usart::ConfigError>,
    registers: pac::usart::Usart,
    stream: dma::Channel<'static>,
    request: u8,
    buffer: &'static mut [u8],
) -> (SerialReceiver, UartTx<'static, Async>) {
    let (sender, receiver) = port.expect("115,200 baud are possible").split();
    (
        SerialReceiver::new(receiver, registers, stream, request, buffer),
        sender,
    )
}

/// The inertial sensors' data-ready line is PC4: EXTI line 4, rising edge.
fn listen_to_data_ready() {
    RCC.ahb1enr().modify(|enable| enable.set_gpiocen(true));
    RCC.apb2enr().modify(|enable| enable.set_syscfgen(true));
    RCC.apb2enr().read(); // errata: a port answers two cycles after its clock is enabled
    GPIOC.moder().modify(|mode| mode.set_moder(4, Moder::INPUT));
    /// Port C in `EXTICR` (RM0090, 9.2.4).
    const PORT_C: u8 = 2;
    SYSCFG.exticr(1).modify(|line| line.set_exti(0, PORT_C));
    EXTI.rtsr(0).modify(|rising| rising.set_line(4, true));
    EXTI.imr(0).modify(|mask| mask.set_line(4, true));
    // SAFETY: its handler shares nothing but a signal with the rest.
    unsafe { interrupt::EXTI4.enable() };
}

#[embassy_stm32::interrupt]
fn EXTI4() {
    EXTI.pr(0).write(|pending| pending.set_line(4, true));
    DATA_READY.signal(Instant::now().as_micros());
}

/// The four motors, in the core's rotor order.
pub struct Motors {
    front_right: SimplePwmChannel<'static, TIM4>,
    rear_left: SimplePwmChannel<'static, TIM3>,
    front_left: SimplePwmChannel<'static, TIM3>,
    rear_right: SimplePwmChannel<'static, TIM4>,
    /// Counts of the timers in a millisecond.
    per_millisecond: u16,
}

impl Motors {
    /// Starts the pulses, all at the length that stops a motor. `rate` in Hz, 50 to 490.
    ///
    /// Pads in the order of Betaflight's quad X, as ArduPilot says of this board: M1 rear right,
    /// M2 front right, M3 rear left, M4 front left. The motor test shows whether that is so.
    pub fn new(parts: MotorParts, rate: u32) -> Self {
        let (rate, up) = (Hertz(rate.clamp(50, 490)), CountingMode::EdgeAlignedUp);
        let m1 = Some(PwmPin::new(parts.m1, OutputType::PushPull));
        let m2 = Some(PwmPin::new(parts.m2, OutputType::PushPull));
        let m3 = Some(PwmPin::new(parts.m3, OutputType::PushPull));
        let m4 = Some(PwmPin::new(parts.m4, OutputType::PushPull));
        let right = SimplePwm::new(parts.tim4, m1, m2, None, None, rate, up).split();
        let left = SimplePwm::new(parts.tim3, None, None, m3, m4, rate, up).split();
        let per_millisecond = right.ch1.max_duty_cycle() * rate.0 / 1000;
        let mut motors = Self {
            front_right: right.ch2,
            rear_left: left.ch3,
            front_left: left.ch4,
            rear_right: right.ch1,
            per_millisecond: per_millisecond.min(u32::from(u16::MAX)) as u16,
        };
        motors.write(MotorCommand::Disarmed);
        motors.front_right.enable();
        motors.rear_left.enable();
        motors.front_left.enable();
        motors.rear_right.enable();
        motors
    }

    /// Writes the four compare registers; the timers take them over at their next period.
    #[inline]
    pub fn write(&mut self, command: MotorCommand) {
        let counts = match command.rotors() {
            None => [pulse::stop(self.per_millisecond); 4],
            Some(rotors) => rotors.map(|rotor| pulse::counts(rotor, self.per_millisecond)),
        };
        let [front_right, rear_left, front_left, rear_right] = counts;
        self.front_right.set_duty_cycle(front_right);
        self.rear_left.set_duty_cycle(rear_left);
        self.front_left.set_duty_cycle(front_left);
        self.rear_right.set_duty_cycle(rear_right);
    }
}
