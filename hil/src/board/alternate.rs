//! Which pin carries which signal, by which alternate function (datasheet table 9, LQFP64).

use super::gpio::Port;
use super::wiring::Pin;

/// A signal of a peripheral that a pin can carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Signal {
    SpiClock,
    SpiMiso,
    SpiMosi,
    I2cClock,
    I2cData,
    /// Index of the port.
    UsartTransmit(u8),
    /// Index of the port.
    UsartReceive(u8),
    /// Index of the timer, and of the channel.
    Channel(u8, u8),
    /// The complementary output of a channel.
    Complement(u8, u8),
}
use Signal::{
    Channel, Complement, I2cClock, I2cData, SpiClock, SpiMiso, SpiMosi, UsartReceive, UsartTransmit,
};

/// A pin, the alternate function to switch it to, and the signal that it then carries.
pub(super) struct Route {
    pub pin: Pin,
    pub function: u8,
    pub signal: Signal,
}

const fn route(port: char, number: u8, function: u8, signal: Signal) -> Route {
    Route {
        pin: Pin::new(port, number),
        function,
        signal,
    }
}

/// Every route of the signals that are modelled.
pub(super) const ROUTES: [Route; 77] = [
    route('A', 5, 5, SpiClock),
    route('B', 3, 5, SpiClock),
    route('A', 6, 5, SpiMiso),
    route('B', 4, 5, SpiMiso),
    route('A', 7, 5, SpiMosi),
    route('B', 5, 5, SpiMosi),
    route('B', 6, 4, I2cClock),
    route('B', 8, 4, I2cClock),
    route('B', 7, 4, I2cData),
    route('B', 9, 4, I2cData),
    route('A', 10, 7, UsartReceive(0)),
    route('B', 7, 7, UsartReceive(0)),
    route('A', 9, 7, UsartTransmit(0)),
    route('B', 6, 7, UsartTransmit(0)),
    route('A', 3, 7, UsartReceive(1)),
    route('A', 2, 7, UsartTransmit(1)),
    route('B', 11, 7, UsartReceive(2)),
    route('C', 11, 7, UsartReceive(2)),
    route('B', 10, 7, UsartTransmit(2)),
    route('C', 10, 7, UsartTransmit(2)),
    route('C', 7, 8, UsartReceive(3)),
    route('C', 6, 8, UsartTransmit(3)),
    route('A', 8, 1, Channel(0, 0)),
    route('A', 9, 1, Channel(0, 1)),
    route('A', 10, 1, Channel(0, 2)),
    route('A', 11, 1, Channel(0, 3)),
    route('A', 7, 1, Complement(0, 0)),
    route('B', 13, 1, Complement(0, 0)),
    route('B', 0, 1, Complement(0, 1)),
    route('B', 14, 1, Complement(0, 1)),
    route('B', 1, 1, Complement(0, 2)),
    route('B', 15, 1, Complement(0, 2)),
    route('A', 0, 1, Channel(1, 0)),
    route('A', 5, 1, Channel(1, 0)),
    route('A', 15, 1, Channel(1, 0)),
    route('A', 1, 1, Channel(1, 1)),
    route('B', 3, 1, Channel(1, 1)),
    route('A', 2, 1, Channel(1, 2)),
    route('B', 10, 1, Channel(1, 2)),
    route('A', 3, 1, Channel(1, 3)),
    route('B', 11, 1, Channel(1, 3)),
    route('A', 6, 2, Channel(2, 0)),
    route('B', 4, 2, Channel(2, 0)),
    route('C', 6, 2, Channel(2, 0)),
    route('A', 7, 2, Channel(2, 1)),
    route('B', 5, 2, Channel(2, 1)),
    route('C', 7, 2, Channel(2, 1)),
    route('B', 0, 2, Channel(2, 2)),
    route('C', 8, 2, Channel(2, 2)),
    route('B', 1, 2, Channel(2, 3)),
    route('C', 9, 2, Channel(2, 3)),
    route('B', 6, 2, Channel(3, 0)),
    route('B', 7, 2, Channel(3, 1)),
    route('B', 8, 2, Channel(3, 2)),
    route('B', 9, 2, Channel(3, 3)),
    route('A', 0, 2, Channel(4, 0)),
    route('A', 1, 2, Channel(4, 1)),
    route('A', 2, 2, Channel(4, 2)),
    route('A', 3, 2, Channel(4, 3)),
    route('C', 6, 3, Channel(7, 0)),
    route('C', 7, 3, Channel(7, 1)),
    route('C', 8, 3, Channel(7, 2)),
    route('C', 9, 3, Channel(7, 3)),
    route('A', 5, 3, Complement(7, 0)),
    route('A', 7, 3, Complement(7, 0)),
    route('B', 0, 3, Complement(7, 1)),
    route('B', 14, 3, Complement(7, 1)),
    route('B', 1, 3, Complement(7, 2)),
    route('B', 15, 3, Complement(7, 2)),
    route('A', 2, 3, Channel(8, 0)),
    route('A', 3, 3, Channel(8, 1)),
    route('B', 8, 3, Channel(9, 0)),
    route('B', 9, 3, Channel(10, 0)),
    route('B', 14, 9, Channel(11, 0)),
    route('B', 15, 9, Channel(11, 1)),
    route('A', 6, 9, Channel(12, 0)),
    route('A', 7, 9, Channel(13, 0)),
];

/// Whether a pin is switched to this route.
pub(super) fn connected(ports: &[Port; 9], route: &Route) -> bool {
    ports[usize::from(route.pin.port)].alternate_function(route.pin.number) == Some(route.function)
}

/// The pin that carries a signal.
pub(super) fn carrier(ports: &[Port; 9], signal: Signal) -> Option<Pin> {
    let mut routes = ROUTES.iter().filter(|route| route.signal == signal);
    routes
        .find(|route| connected(ports, route))
        .map(|route| route.pin)
}

/// Nothing if a pin carries the signal; otherwise which pins could, and how.
pub(super) fn missing(ports: &[Port; 9], signal: Signal) -> Option<String> {
    let routes = || ROUTES.iter().filter(move |route| route.signal == signal);
    if routes().any(|route| connected(ports, route)) {
        return None;
    }
    let choices: Vec<String> = routes()
        .map(|route| format!("{} in AF{}", route.pin, route.function))
        .collect();
    Some(choices.join(" or "))
}
