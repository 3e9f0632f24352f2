//! Receiving: frames begin and end at the stations that they reach.

use sextant_kernel::StationId;

use super::Links;
use crate::air::{Arrival, Transmission};
use crate::link::programmed::packet::Outgoing;
use crate::link::programmed::stack::{Acknowledging, Hearing};
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::radio_event::{RadioNews, ReceivedNews};
use crate::service::report::Destination;
use crate::service::upcall::Upcall;

impl Links {
    /// The start-of-frame delimiter of what a station has on air ends: those that are locked on to it say so.
    pub(super) fn end_delimiter(&mut self, station: StationId, scene: &mut Scene) {
        let Some(on_air) = self.stacks[station.index()].on_air else { return };
        let channel = self.stacks[station.index()].channel;
        let radios = &self.radios[channel];
        let (transmission, air) = (on_air.transmission, radios.air);
        let (number, start) = (transmission.number(), transmission.start());
        self.reached.clear();
        self.reached.extend_from_slice(scene.airs[air].reached_by(&transmission));
        for &(receiver, listener) in &self.reached {
            let stack = &mut self.stacks[listener.index()];
            let is_tuned = stack.channel == channel && radios.receiver(listener) == receiver;
            // Who waits for an acknowledgement is told of that alone.
            if !is_tuned || stack.deafness.is_some() || stack.radio.is_awaiting() {
                continue;
            }
            if scene.airs[air].follows(scene.now, receiver, &transmission) {
                stack.followed = Some(number);
                scene.upcalls.push(Upcall::Radio { station: listener, news: RadioNews::Began { start } });
            }
        }
    }

    /// A frame of `from` ends at those that it has reached.
    pub(super) fn receive_frame(
        &mut self,
        from: StationId,
        outgoing: &Outgoing,
        transmission: &Transmission,
        scene: &mut Scene,
    ) {
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            let was_followed = self.take_followed(&arrival, transmission);
            let station = arrival.station;
            let news = if arrival.outcome != FrameOutcome::Received {
                was_followed.then_some(RadioNews::Garbled { start: transmission.start() })
            } else if self.is_told(outgoing.to, station) {
                Some(RadioNews::Received(self.receive(from, outgoing, transmission, &arrival, scene)))
            } else {
                was_followed.then_some(RadioNews::Ignored { start: transmission.start() })
            };
            scene.upcalls.extend(news.map(|news| Upcall::Radio { station, news }));
        }
    }

    /// Whether a station is told of a frame for this destination.
    fn is_told(&self, to: Destination, station: StationId) -> bool {
        match to {
            Destination::All => true,
            Destination::Station(to) => to == station || self.stacks[station.index()].hearing == Hearing::All,
        }
    }

    /// A frame was received, and is acknowledged if it asks this station for that.
    fn receive(
        &mut self,
        from: StationId,
        outgoing: &Outgoing,
        transmission: &Transmission,
        arrival: &Arrival,
        scene: &mut Scene,
    ) -> ReceivedNews {
        let &Arrival { station, power, sinr, .. } = arrival;
        let &Outgoing { to, sequence, acknowledged: asks, packet, .. } = outgoing;
        let is_own = to == Destination::Station(station);
        let automatic = self.stacks[station.index()].acknowledging == Acknowledging::Automatic;
        let acknowledged = asks
            && is_own
            && automatic
            && self.command(station, scene, |radio, now, timers| radio.acknowledge(now, timers));
        if acknowledged {
            self.stacks[station.index()].answered = Some((from, sequence));
        }
        if let Some(packet) = packet.filter(|_| is_own || to == Destination::All) {
            self.note_delivery(from, packet, station);
        }
        let (start, end) = (transmission.start(), scene.now);
        ReceivedNews { from, to, sequence, start, end, power, sinr, acknowledged }
    }

    /// An acknowledgement ends at those that it has reached: one of them may wait for it.
    pub(super) fn receive_acknowledgement(&mut self, transmission: &Transmission, sequence: u8, scene: &mut Scene) {
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            let was_followed = self.take_followed(&arrival, transmission);
            let (station, start) = (arrival.station, transmission.start());
            let is_received = arrival.outcome == FrameOutcome::Received;
            let is_awaited = is_received
                && self.command(station, scene, |radio, now, timers| {
                    radio.receive_acknowledgement(sequence, now, timers)
                });
            let news = if is_awaited {
                if let Some(packet) = self.stacks[station.index()].sent_packet {
                    self.note_acknowledgement(station, packet, scene.now);
                }
                Some(RadioNews::Acknowledged { rssi: arrival.power.to_dbm() })
            } else if is_received {
                was_followed.then_some(RadioNews::Ignored { start })
            } else {
                was_followed.then_some(RadioNews::Garbled { start })
            };
            scene.upcalls.extend(news.map(|news| Upcall::Radio { station, news }));
        }
    }

    /// Whether the station of an arrival was locked on to the transmission, which ends now.
    fn take_followed(&mut self, arrival: &Arrival, transmission: &Transmission) -> bool {
        let followed = &mut self.stacks[arrival.station.index()].followed;
        followed.take_if(|followed| *followed == transmission.number()).is_some()
    }
}
