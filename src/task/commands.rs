//! The command port of bench tests, until the ground link takes its place.

use embassy_stm32::usart::BufferedUart;
use embedded_io_async::Read;
use windhover_bench_port::{Parser, Request};

use crate::fault;
use crate::shared::{self, COUNTERS};

/// Takes in requests for ever.
#[embassy_executor::task]
pub async fn commands(mut port: BufferedUart<'static>) {
    let mut parser = Parser::default();
    let mut bytes = [0; 32];
    loop {
        // A damaged byte damages its frame; the parser finds the next one.
        let count = port.read(&mut bytes).await.unwrap_or(0);
        for byte in bytes.iter().take(count) {
            if let Some(request) = parser.push(*byte) {
                act(request);
            }
        }
    }
}

fn act(request: Request) {
    match request {
        Request::Input(input) => shared::with(|shared| input.queue(&mut shared.mailboxes.queues)),
        Request::Urgent(urgent) => shared::urge(urgent),
        Request::Restart if shared::value(&COUNTERS.armed) == 0 => fault::restart(),
        Request::Restart => defmt::warn!("no restart while armed"),
        Request::SaveParameter(_) => defmt::warn!("parameters are not stored yet"),
    }
}
