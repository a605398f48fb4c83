//! The remote control's receiver.

use embassy_stm32::usart::{self, DataBits};
use embassy_time::{Duration, Instant, Timer};
use windhover_autopilot::RcFrame;
use windhover_drivers::rc_receiver::{Line, Parity, RcReceiver, StopBits};

use crate::board::{self, SerialReceiver};
use crate::shared::{self, COUNTERS};

/// Between two looks at what came: pauses between frames show by it.
const PERIOD: Duration = Duration::from_millis(1);

/// Reads the receiver for ever.
#[embassy_executor::task]
pub async fn remote(mut receiver: SerialReceiver) {
    let mut remote = RcReceiver::default();
    let mut protocol = None;
    let mut bytes = [0; 64];
    loop {
        Timer::after(PERIOD).await;
        let now = Instant::now().as_micros();
        let taken = receiver.take(&mut bytes);
        if taken.faulty {
            remote.line_error(now);
        } else if let Some(channels) = remote.bytes(bytes.get(..taken.count).unwrap_or_default(), now) {
            shared::with(|shared| shared.mailboxes.queues.rc.push(RcFrame { channels }));
        }
        if let Some(line) = remote.poll(now, shared::value(&COUNTERS.armed) != 0) {
            // Both protocols' rates are possible.
            let _ = receiver.set_line(&config(&line));
        }
        if remote.protocol() != protocol {
            protocol = remote.protocol();
            match protocol {
                Some(protocol) => defmt::info!("remote control: {}", protocol),
                None => defmt::warn!("remote control: silent"),
            }
        }
    }
}

/// The line as the port has it. The port does not invert: where a protocol wants that, the board does.
fn config(line: &Line) -> usart::Config {
    let mut config = board::baud(line.baud);
    config.data_bits = DataBits::DataBits8;
    config.parity = match line.parity {
        Parity::None => usart::Parity::ParityNone,
        Parity::Even => usart::Parity::ParityEven,
    };
    config.stop_bits = match line.stop_bits {
        StopBits::One => usart::StopBits::STOP1,
        StopBits::Two => usart::StopBits::STOP2,
    };
    config
}
