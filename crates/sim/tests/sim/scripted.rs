//! A station that sends what a script says, at exact instants, and writes down all that it is told.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_sim::{
    Application, Delivery, Destination, FrameId, NetworkId, Payload, Port, SendError, SendReport, Timer,
};

/// The only network of most tests.
pub(crate) const NETWORK: NetworkId = NetworkId(0);

/// A frame of a script.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    pub(crate) at: Duration,
    pub(crate) network: NetworkId,
    pub(crate) to: Destination,
    pub(crate) payload: Vec<u8>,
}

/// A frame that was delivered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Received {
    pub(crate) at: SimTime,
    pub(crate) network: NetworkId,
    pub(crate) from: StationId,
    pub(crate) payload: Vec<u8>,
}

/// A station that sends what a script says and writes down all that it is told.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scripted {
    is_deaf: bool,
    /// The network in which it opens its receiver at the start, if it is a robot.
    listens_in: Option<NetworkId>,
    orders: Vec<Order>,
    /// What the link said to each order.
    pub(crate) answers: Vec<Result<FrameId, SendError>>,
    pub(crate) reports: Vec<(SimTime, SendReport)>,
    pub(crate) received: Vec<Received>,
}

impl Scripted {
    /// A station that listens, sends nothing, and acknowledges.
    pub(crate) fn listener() -> Self {
        Self::default()
    }

    /// A station whose application looks at nothing that it hears.
    pub(crate) fn deaf() -> Self {
        Self { is_deaf: true, ..Self::default() }
    }

    /// The same, which also sends `payload` at `at`.
    pub(crate) fn and_sends(mut self, at: Duration, to: Destination, payload: &[u8]) -> Self {
        self.orders.push(Order { at, network: NETWORK, to, payload: payload.to_vec() });
        self
    }

    /// The same, of a robot that listens for a second in a network.
    pub(crate) fn and_listens_in(self, network: NetworkId) -> Self {
        Self { listens_in: Some(network), ..self }
    }

    /// The same, with its last frame in another network.
    pub(crate) fn through(mut self, network: NetworkId) -> Self {
        self.orders.last_mut().expect("a frame").network = network;
        self
    }

    /// The payloads that were delivered, in order.
    pub(crate) fn payloads(&self) -> Vec<&[u8]> {
        self.received.iter().map(|received| &*received.payload).collect()
    }
}

impl Application for Scripted {
    fn hears(&self) -> bool {
        !self.is_deaf
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Some(network) = self.listens_in {
            port.listen(network, Duration::from_secs(1));
        }
        for (order, number) in self.orders.iter().zip(0..) {
            port.after(order.at, Timer(number));
        }
    }

    fn timed(&mut self, Timer(number): Timer, port: &mut Port<'_>) {
        let Order { network, to, payload, .. } = &self.orders[usize::from(number)];
        self.answers.push(port.send(*network, *to, Payload::Octets(payload)));
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        self.received.push(Received {
            at: port.now(),
            network: delivery.network,
            from: delivery.from,
            payload: delivery.payload.to_vec(),
        });
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        self.reports.push((port.now(), *report));
    }
}
