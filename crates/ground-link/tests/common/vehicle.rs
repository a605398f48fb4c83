//! A vehicle around a link: it takes requests and answers them.

use windhover_autopilot::Parameters;
use windhover_ground_link::{CommandResult, Config, Context, Link, Order, Request, Signing, Telemetry};

use super::Store;

/// What a vehicle does with a request.
pub type Answer = fn(&Request) -> Option<CommandResult>;

/// A link with all that it needs.
pub struct Vehicle {
    pub link: Link,
    pub store: Store,
    pub signing: Signing,
    pub parameters: Parameters,
    pub telemetry: Telemetry,
    pub orders: Vec<Order>,
    /// `None` answers nothing.
    pub answer: Answer,
    /// Whether requests are taken out of the queue.
    pub takes: bool,
}

impl Vehicle {
    /// With all the bandwidth that one could wish for.
    pub fn new() -> Self {
        Self::with(Config {
            bandwidth: 1_000_000,
            ..Config::default()
        })
    }

    pub fn with(config: Config) -> Self {
        Self {
            link: Link::new(config),
            store: Store::default(),
            signing: Signing::default(),
            parameters: Parameters::default(),
            telemetry: Telemetry::default(),
            orders: Vec::new(),
            answer: |_| Some(CommandResult::Accepted),
            takes: true,
        }
    }

    pub fn receive(&mut self, bytes: &[u8], now: u64) {
        self.take(bytes, now, Link::receive);
    }

    pub fn receive_packet(&mut self, packet: &[u8], now: u64) {
        self.take(packet, now, Link::receive_packet);
    }

    fn take(&mut self, bytes: &[u8], now: u64, receive: fn(&mut Link, &[u8], u64, &mut Context<'_>)) {
        let mut context = Context {
            telemetry: &self.telemetry,
            parameters: &self.parameters,
            plans: &mut self.store,
            signing: &mut self.signing,
        };
        receive(&mut self.link, bytes, now, &mut context);
        while self.takes
            && let Some(order) = self.link.next_request()
        {
            self.act(order, now);
        }
    }

    fn act(&mut self, order: Order, now: u64) {
        self.orders.push(order);
        if let Request::WriteParameter { index, value } = order.request {
            let outcome = self.parameters.set(usize::from(index), value);
            if let Err(refusal) = outcome {
                self.link.parameter_refused(index, refusal, &self.parameters, now);
            }
        }
        if let (Some(id), Some(result)) = (order.id, (self.answer)(&order.request)) {
            self.link.finish(id, result, now);
        }
    }

    pub fn poll(&mut self, now: u64) -> Vec<Vec<u8>> {
        let mut context = Context {
            telemetry: &self.telemetry,
            parameters: &self.parameters,
            plans: &mut self.store,
            signing: &mut self.signing,
        };
        let mut frames = Vec::new();
        self.link
            .poll(now, &mut context, &mut |frame| frames.push(frame.to_vec()));
        frames
    }

    pub fn requests(&self) -> Vec<Request> {
        self.orders.iter().map(|order| order.request).collect()
    }

    /// How many writes of parameters were asked for; each must be one that the table takes.
    pub fn valid_writes(&self) -> usize {
        let mut writes = 0;
        for order in &self.orders {
            if let Request::WriteParameter { index, value } = order.request {
                let declaration = Parameters::declaration(usize::from(index)).expect("there is one");
                assert_eq!(declaration.check(value), Ok(()), "{}: {value}", declaration.name);
                writes += 1;
            }
        }
        writes
    }
}
