//! The radio of one station, as its protocol machines see it.

use std::time::Duration;

use sextant_kernel::{EventKey, StationId};
use sextant_mac::{Phy, RadioState, coordinator, csma, device, responder};

use super::stack::{Due, Stack};
use crate::air::{Aim, Emission, Sense};
use crate::event::ieee802154::Event;
use crate::event::link::LinkEvent;
use crate::link::radios::Radios;
use crate::scene::Scene;
use crate::service::report::Destination;

/// The radio of one station, as its protocol machines see it.
pub(super) struct Transceiver<'a> {
    pub(super) radios: &'a Radios<Phy>,
    pub(super) stack: &'a mut Stack,
    pub(super) scene: &'a mut Scene,
    pub(super) station: StationId,
    /// Whether channel access turns its receiver on now to wait for an acknowledgement.
    pub(super) awaits_ack: bool,
}

impl Transceiver<'_> {
    /// Schedules an event `span` from now, as the clock of the station says.
    fn schedule(&mut self, span: Duration, event: Event) -> EventKey {
        let span = self.stack.clock.span(span);
        self.schedule_exactly(span, event)
    }

    fn schedule_exactly(&mut self, span: Duration, event: Event) -> EventKey {
        self.radios.after(span, self.station, LinkEvent::Ieee802154(event), self.scene)
    }

    /// Whether the station finds the channel busy in the window that ends now. A station that sent an
    /// acknowledgement in it, or is about to, does.
    pub(super) fn senses_busy(&mut self) -> bool {
        let now = self.scene.now;
        let from = now.saturating_sub(self.radios.phy().cca());
        if self.stack.overriding.is_some() || self.stack.overridden_until > from {
            return true;
        }
        let sense = Sense {
            radio: self.radios.interface(self.station),
            place: self.scene.place(self.station),
            from,
            to: now,
            threshold: self.stack.cca_threshold,
        };
        self.scene.airs[self.radios.air].is_busy(&sense)
    }

    /// Schedules what channel access waits for. A quiet station looks ahead before anything of it goes into the queue.
    #[inline]
    fn await_access(&mut self, span: Duration, event: Event) -> Option<EventKey> {
        if self.stack.is_quiet {
            self.stack.due = Some(Due { at: self.scene.now + span, event });
            None
        } else {
            Some(self.schedule_exactly(span, event))
        }
    }

    /// Brings the receiver in line with the state of the radio.
    pub(super) fn tune(&mut self) {
        self.stack.meter.enter(self.stack.state(), self.scene.now);
        let deafness = self.stack.deafness_now();
        self.radios.tune(self.station, deafness, &mut self.stack.deafness, self.scene);
    }

    /// Puts a frame on air, to one station or to all.
    fn begin_transmission(&mut self, to: Option<StationId>, airtime: Duration) -> crate::air::Transmission {
        let (now, place) = (self.scene.now, self.scene.place(self.station));
        let sender = self.radios.interface(self.station);
        let to = to.map(|to| self.radios.receiver(to));
        let emission = Emission { power: self.stack.tx_power, aim: Aim::Omnidirectional };
        self.scene.airs[self.radios.air].begin(now, sender, to, place, emission, airtime)
    }

    /// The radio sends something that goes before channel access, or ends it with `Receive`.
    fn override_with(&mut self, state: RadioState) {
        self.stack.overriding = (state != RadioState::Receive).then_some(state);
        self.stack.overridden_until = self.scene.now;
        self.tune();
    }
}

impl csma::Radio for Transceiver<'_> {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        if let Some(track) = &mut self.stack.track {
            track.begin_backoff(self.scene.now);
        }
        // Its number is the time and not a count, so that it does not depend on what the station sent before.
        self.scene.backoff(self.radios.network, self.station, self.scene.now.as_nanos(), max_inclusive)
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        let span = self.stack.clock.span(span);
        let span = if event == csma::Event::ReceiveReady { span.saturating_sub(self.stack.lead) } else { span };
        self.stack.timer = self.await_access(span, Event::Csma(event));
    }

    fn cancel_timer(&mut self) {
        (self.stack.due, self.stack.queued) = (None, None);
        if let Some(key) = self.stack.timer.take() {
            self.scene.queue.cancel(key);
        }
    }

    fn enter(&mut self, state: RadioState) {
        self.stack.wanted = state;
        self.stack.awaits_ack = state == RadioState::Receive && self.awaits_ack;
        self.tune();
    }

    fn start_cca(&mut self) {
        if let Some(track) = &mut self.stack.track {
            track.begin_assessment(self.scene.now);
        }
        self.stack.meter.wake(self.radios.phy().turnaround());
        let span = self.stack.clock.span(self.radios.phy().cca());
        self.await_access(span, Event::CcaEnded);
    }

    fn start_transmission(&mut self, frame: csma::OutgoingFrame) {
        let airtime = self.stack.clock.span(self.radios.phy().airtime(frame.mpdu_octets));
        let to = self.stack.frame.and_then(|frame| match frame.to {
            Destination::Station(to) => Some(to),
            Destination::All => None,
        });
        self.stack.transmission = Some(self.begin_transmission(to, airtime));
        self.await_access(airtime, Event::Csma(csma::Event::TransmissionEnded));
    }
}

impl device::Radio for Transceiver<'_> {
    fn track_after(&mut self, span: Duration, event: device::Event) {
        self.stack.tracking = Some(self.schedule(span, Event::Tracking(event)));
    }

    fn cancel_tracking(&mut self) {
        if let Some(key) = self.stack.tracking.take() {
            self.scene.queue.cancel(key);
        }
    }
}

impl responder::Radio for Transceiver<'_> {
    fn after(&mut self, span: Duration, event: responder::Event) {
        self.schedule(span, Event::Responder(event));
    }

    fn enter(&mut self, state: RadioState) {
        self.override_with(state);
    }

    fn start_acknowledgement(&mut self, sequence: u8) {
        let airtime = self.stack.clock.span(self.radios.phy().ack_airtime());
        self.stack.acknowledgement = Some((self.begin_transmission(self.stack.answered, airtime), sequence));
        self.schedule_exactly(airtime, Event::Responder(responder::Event::TransmissionEnded));
    }
}

/// A coordinator keeps the beacon on air itself: see [`Beaconing`].
pub(super) struct Beaconing<'a> {
    pub(super) transceiver: Transceiver<'a>,
    pub(super) beacon: &'a mut Option<crate::air::Transmission>,
}

impl coordinator::Radio for Beaconing<'_> {
    fn after(&mut self, span: Duration, event: coordinator::Event) {
        self.transceiver.schedule(span, Event::Coordinator(event));
    }

    fn enter(&mut self, state: RadioState) {
        self.transceiver.override_with(state);
    }

    fn start_beacon(&mut self, mpdu_octets: u8) {
        // The coordinator has an exact clock: it is a robot or a sink.
        let airtime = self.transceiver.radios.phy().airtime(mpdu_octets);
        *self.beacon = Some(self.transceiver.begin_transmission(None, airtime));
        self.transceiver.schedule(airtime, Event::Coordinator(coordinator::Event::TransmissionEnded));
    }
}
