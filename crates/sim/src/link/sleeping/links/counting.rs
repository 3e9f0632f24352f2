//! Packets that are left at the end, and traces of all.

use std::collections::VecDeque;

use sextant_kernel::StationId;

use super::Links;
use crate::link::sleeping::stack::OpenFrame;
use crate::link::track::Origin;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};

impl Links {
    /// Counts the packets of a station that have not ended: one that was received counts so.
    pub(super) fn count_open(&mut self, station: StationId) {
        let open = std::mem::take(&mut self.stacks[station.index()].waiting);
        self.count_left(station, &open);
    }

    /// The packets of a station whose battery is empty are lost.
    pub(super) fn abandon(&mut self, station: StationId, scene: &mut Scene) {
        let open = std::mem::take(&mut self.stacks[station.index()].waiting);
        self.count_left(station, &open);
        for frame in open {
            let fate = match frame.outcome {
                FrameOutcome::Received => PacketFate::Sent(FrameOutcome::Received),
                _ => PacketFate::Depleted,
            };
            let content = frame.content;
            self.trace_frame(station, frame, PacketEnd::Depleted, fate, scene);
            self.payloads.release(content);
        }
    }

    /// Counts packets that a station leaves behind.
    fn count_left(&mut self, station: StationId, left: &VecDeque<OpenFrame>) {
        let is_depleted = self.ledger.is_depleted(station);
        for frame in left {
            if frame.offered < self.ledger.counted_from {
                continue;
            }
            let overhead = self.header(station, frame.to).overhead_octets();
            let packets = &mut self.ledger.packets[station.index()];
            if frame.outcome == FrameOutcome::Received {
                // The attempt in which it was received is the last one.
                packets.transmissions += u64::from(frame.attempts) + 1;
                packets.count_sent(frame.outcome);
                packets.octets_received += u64::from(frame.mpdu_octets - overhead);
            } else {
                packets.transmissions += u64::from(frame.attempts);
                if is_depleted {
                    packets.depleted += 1;
                } else {
                    packets.pending += 1;
                }
            }
        }
    }

    /// Traces the packets that have not ended.
    pub(super) fn trace_all_pending(&mut self, scene: &mut Scene) {
        let (network, counted_from) = (self.radios.network, self.ledger.counted_from);
        for (i, stack) in self.stacks.iter_mut().enumerate() {
            let origin = Origin { network, station: StationId::from_index(i), counted_from };
            for frame in &mut stack.waiting {
                let Some(mut track) = frame.track.take() else { continue };
                let fate = match frame.outcome {
                    FrameOutcome::Received => PacketFate::Sent(FrameOutcome::Received),
                    _ => PacketFate::Pending,
                };
                let traced = origin.traced(frame.packet(), PacketEnd::Pending, fate);
                scene.traced.push(track.end(&traced, &self.ledger.radio_states, stack.tx_power, scene.now));
            }
        }
    }

    /// Traces a packet that has ended.
    pub(super) fn trace_frame(
        &self,
        station: StationId,
        mut frame: OpenFrame,
        end: PacketEnd,
        fate: PacketFate,
        scene: &mut Scene,
    ) {
        let Some(mut track) = frame.track.take() else { return };
        let origin = Origin { network: self.radios.network, station, counted_from: self.ledger.counted_from };
        let (traced, power) = (origin.traced(frame.packet(), end, fate), self.stacks[station.index()].tx_power);
        scene.traced.push(track.end(&traced, &self.ledger.radio_states, power, scene.now));
    }
}
