//! A node that sends traffic and looks at nothing that it hears.

use std::sync::Arc;

use sextant_kernel::SimTime;

use super::traffic::{Next, Traffic};
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::link::clock::Clock;
use crate::service::network_id::NetworkId;
use crate::service::report::{Destination, Payload, SendReport};

/// A source of traffic in one network.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    network: NetworkId,
    traffic: Arc<Traffic>,
    to: Destination,
    clock: Clock,
    /// Frames offered so far.
    count: u64,
    /// Frames to offer.
    limit: u64,
    /// Size of the next frame (octets).
    octets: u8,
    /// Whether the next frame follows the end of the last one.
    is_saturated: bool,
    /// Whether it sends nothing until somebody who listens comes near.
    rests: bool,
    /// Whether the simulation, or the life of its node, is over.
    is_over: bool,
}

impl Source {
    pub(crate) fn new(network: NetworkId, traffic: Arc<Traffic>, to: Destination) -> Self {
        let clock = Clock::default();
        Self {
            network,
            traffic,
            to,
            clock,
            count: 0,
            limit: u64::MAX,
            octets: 0,
            is_saturated: false,
            rests: false,
            is_over: false,
        }
    }

    /// The same, for a node with this clock.
    pub(crate) fn with_clock(self, clock: Clock) -> Self {
        Self { clock, ..self }
    }

    pub(crate) fn with_limit(self, limit: u64) -> Self {
        Self { limit, ..self }
    }

    pub(crate) fn network(&self) -> NetworkId {
        self.network
    }

    /// The timer of its next frame: each network has its own.
    fn timer(&self) -> Timer {
        Timer(self.network.0.into())
    }

    /// Schedules the next frame, if there is one.
    fn schedule(&mut self, port: &mut Port<'_>) {
        if self.count >= self.limit {
            return;
        }
        let Some(node) = port.node(port.station()) else { return };
        let last = if self.count == 0 { SimTime::ZERO } else { port.now() };
        let next = self.traffic.next(port.seed_of(self.network), node, self.count, last);
        self.expect(next, port);
    }

    /// Waits for the next frame.
    fn expect(&mut self, next: Next, port: &mut Port<'_>) {
        match next {
            Next::At(due, octets) => {
                self.octets = octets;
                port.after(self.true_time(due).saturating_since(port.now()), self.timer());
            }
            Next::AfterTheLast(octets) => {
                self.octets = octets;
                self.is_saturated = true;
            }
            Next::Never => {}
        }
    }

    /// The true time of an instant of the schedule.
    fn true_time(&self, due: SimTime) -> SimTime {
        if self.traffic.follows_clock() { self.clock.instant(due) } else { due }
    }

    /// Whether it could rest while nobody can hear it.
    pub(crate) fn may_rest(&self) -> bool {
        self.traffic.may_rest()
    }

    /// It goes on with the frame that is due next.
    fn go_on(&mut self, port: &mut Port<'_>) {
        let Some(node) = port.node(port.station()) else { return };
        let seed = port.seed_of(self.network);
        let after = self.traffic.after_rest(seed, node, self.count, port.now(), |due| self.true_time(due));
        if let Some(count) = after.count {
            // The next frame has the numbers that it would have had.
            port.skip(self.network, count - self.count);
            self.count = count;
        }
        self.expect(after.next, port);
    }

    fn offer(&mut self, port: &mut Port<'_>) {
        self.count += 1;
        // A frame that finds the queue full is lost, and the link counts it.
        let _ = port.send(self.network, self.to, Payload::Filler(self.octets));
    }
}

impl Application for Source {
    fn started(&mut self, port: &mut Port<'_>) {
        if port.is_out_of_hearing() && self.may_rest() {
            self.rests = true;
        } else {
            self.schedule(port);
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        if port.is_out_of_hearing() {
            // Nothing happens.
            port.discount_event();
            self.rests = true;
            return;
        }
        self.offer(port);
        self.schedule(port);
    }

    fn woken(&mut self, port: &mut Port<'_>) {
        if std::mem::take(&mut self.rests) {
            self.go_on(port);
        }
    }

    fn ended(&mut self, port: &mut Port<'_>) {
        let Some(node) = port.node(port.station()).filter(|_| !std::mem::replace(&mut self.is_over, true)) else {
            return;
        };
        let seed = port.seed_of(self.network);
        let due = |time| self.traffic.due_before(seed, node, time, |due| self.true_time(due));
        port.note_due(self.network, due(port.now()).without(due(port.counted_from())));
    }

    #[inline]
    fn sent(&mut self, _network: NetworkId, _report: &SendReport, port: &mut Port<'_>) {
        if self.is_saturated {
            self.offer(port);
        }
    }
}
