//! The satellite receiver: found, configured, and what it reports.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::UartTx;
use embassy_time::{Duration, Instant, Timer};
use windhover_autopilot::GnssSample;
use windhover_drivers::ublox::{Action, Message, NavPvt, Parser, Setup};
use windhover_math::geodesy::GlobalPosition;

use super::report::Reported;
use crate::board::{self, SerialReceiver};
use crate::shared;

/// Between two looks at what came: how late a report's time can be.
const PERIOD: Duration = Duration::from_millis(2);

/// Serves the receiver for ever.
#[embassy_executor::task]
pub async fn gnss(mut receiver: SerialReceiver, mut sender: UartTx<'static, Async>) {
    let (mut parser, mut setup) = (Parser::new(), Setup::new());
    let mut health = Reported::new("satellite receiver");
    let mut bytes = [0; 128];
    loop {
        Timer::after(PERIOD).await;
        let now = Instant::now().as_micros();
        let count = receiver.take(&mut bytes).count;
        parser.feed(bytes.get(..count).unwrap_or_default(), |message| {
            setup.heard(&message, now);
            if let Message::NavPvt(report) = message {
                shared::with(|shared| shared.mailboxes.queues.gnss.push(sample(&report, now)));
            }
        });
        match setup.poll(now) {
            None => {}
            Some(Action::SetBaud(baud)) => {
                let line = board::baud(baud);
                // Rates that the port cannot make are not among those that are tried.
                let _ = receiver.set_line(&line);
            }
            // Sent by DMA, which has no end but the port's rate: 46 ms at 9,600 baud.
            Some(Action::Send(command)) => {
                let mut copy = heapless::Vec::<u8, 64>::new();
                let _ = copy.extend_from_slice(command);
                let _ = sender.write(&copy).await;
            }
        }
        health.tell(setup.health());
    }
}

fn sample(report: &NavPvt, now: u64) -> GnssSample {
    GnssSample {
        time: now,
        position: GlobalPosition {
            latitude: report.latitude,
            longitude: report.longitude,
            altitude: report.altitude,
        },
        velocity: report.velocity,
        horizontal_accuracy: report.horizontal_accuracy,
        vertical_accuracy: report.vertical_accuracy,
        speed_accuracy: report.speed_accuracy,
        fix: report.fix,
        satellites: report.satellites,
    }
}
