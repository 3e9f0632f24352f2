//! Receiving: what a frame that ends means to those that have received it.

use sextant_kernel::StationId;
use sextant_mac::sleep::{Form, MeantFor, Sent};

use super::Links;
use super::frames::NodeFrame;
use crate::air::Transmission;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::report::Destination;
use crate::service::upcall::Upcall;

impl Links {
    /// A frame of `from` ends at those that have received it.
    pub(super) fn receive(&mut self, from: StationId, frame: NodeFrame, _on_air: &Transmission, scene: &mut Scene) {
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            let station = arrival.station;
            if arrival.outcome != FrameOutcome::Received || !self.stacks[station.index()].is_there {
                continue;
            }
            let meant_for = match frame.to {
                Destination::Station(to) if to == station => MeantFor::This,
                Destination::Station(_) => MeantFor::Another,
                Destination::All => MeantFor::All,
            };
            match frame.sent {
                Sent::Acknowledgement => self.hear_acknowledgement(station, from, &frame, scene),
                Sent::Strobe => {
                    self.note_answer(station, from, &frame, meant_for);
                    self.command(station, scene, |sleeper, port| sleeper.hear_strobe(meant_for, port));
                }
                Sent::WakeUp { rendezvous } => {
                    // The receiver's clock measures what the frame tells in whole units.
                    let told = self.told_rendezvous(rendezvous);
                    let span = self.stacks[station.index()].checks.span(told);
                    self.command(station, scene, |sleeper, port| sleeper.hear_wake_up(meant_for, span, port));
                }
                Sent::Data => {
                    self.note_answer(station, from, &frame, meant_for);
                    if meant_for != MeantFor::Another {
                        self.deliver(station, from, &frame, arrival.power, scene);
                    }
                    self.command(station, scene, |sleeper, port| sleeper.hear_data(meant_for, port));
                }
            }
            self.go_on(station, scene);
        }
    }

    /// A frame that a station may acknowledge is noted.
    fn note_answer(&mut self, station: StationId, from: StationId, frame: &NodeFrame, meant_for: MeantFor) {
        // What it acknowledges already comes first.
        if meant_for == MeantFor::This && self.stacks[station.index()].on_air.is_none() {
            self.stacks[station.index()].answered = Some((from, frame.sequence));
        }
    }

    /// Delivers a packet to a station, once.
    fn deliver(
        &mut self,
        station: StationId,
        from: StationId,
        frame: &NodeFrame,
        power: sextant_channel::Milliwatts,
        scene: &mut Scene,
    ) {
        let Some(packet) = self.stacks[from.index()].waiting.front_mut() else { return };
        if packet.delivered.contains(&station) {
            return;
        }
        packet.delivered.push(station);
        let counts = packet.offered >= self.ledger.counted_from;
        if self.hears[station.index()] {
            self.ledger.deliveries[station.index()] += u64::from(counts);
            let sequence = frame.sequence;
            scene.upcalls.push(Upcall::Delivered { station, from, sequence, power, sector: None, snr: None });
        }
    }

    /// An acknowledgement of `from` ends at a station, which may wait for it.
    fn hear_acknowledgement(&mut self, station: StationId, from: StationId, frame: &NodeFrame, scene: &mut Scene) {
        let packet = self.stacks[station.index()].waiting.front();
        // Only the acknowledgement of CSL that tells when its sender listens next carries a destination.
        let names_receiver = self.settings.form == Form::Csl && !self.is_always_on(from);
        let is_for_this = !names_receiver || frame.to == Destination::Station(station);
        let is_awaited = is_for_this
            && packet
                .is_some_and(|packet| packet.to == Destination::Station(from) && packet.sequence == frame.sequence);
        if !is_awaited {
            return;
        }
        let ended = self.command(station, scene, |sleeper, port| sleeper.hear_acknowledgement(port));
        if ended.is_some() {
            self.learn_phase(station, from, scene);
        }
        if let Some(ended) = ended {
            self.note_end(station, Some(ended), scene);
        }
    }
}
