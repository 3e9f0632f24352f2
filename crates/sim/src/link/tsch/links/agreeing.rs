//! Cells that stations agree on: MSF and its messages.

use sextant_kernel::{Seed, SimTime, StationId};
use sextant_mac::tsch::frame::SixPFrame;
use sextant_mac::tsch::{Asn, Cell, Ended, Msf, ReturnCode, Schedule, SixP, SixPBody};

use super::Links;
use crate::event::tsch::Event;
use crate::link::ieee802154::header;
use crate::link::payloads::Content;
use crate::link::tsch::stack::{FrameKind, SixPRole, SlotFrame, Stack};
use crate::purpose;
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;
use crate::service::report::{Destination, FrameId, Payload};

/// The random numbers of a station that have no other address.
struct Numbers<'a> {
    seed: Seed,
    station: StationId,
    network: NetworkId,
    drawn: &'a mut u64,
}

impl Numbers<'_> {
    fn next(&mut self) -> f64 {
        let place = [self.station.0.into(), self.network.0.into(), *self.drawn];
        *self.drawn += 1;
        self.seed.uniform(purpose::SLOTS, place)
    }
}

/// What is done with MSF of a station: `now` is its first slot that has not begun.
struct Turn<'a, 'b> {
    msf: &'a mut Msf,
    now: Asn,
    draw: &'b mut dyn FnMut() -> f64,
}

impl Links {
    /// Does something with MSF of a station, if it has it and is in the network, and then what follows from it.
    fn agree<T>(&mut self, station: StationId, scene: &mut Scene, act: impl FnOnce(Turn<'_, '_>) -> T) -> Option<T> {
        let network = self.radios[0].network;
        let Stack { msf, clock, draws, .. } = &mut self.stacks[station.index()];
        let msf = msf.as_mut()?;
        let now = clock.next_from(scene.now);
        let mut numbers = Numbers { seed: scene.seed, station, network, drawn: draws };
        Some(act(Turn { msf, now, draw: &mut || numbers.next() }))
    }

    /// Sends what MSF of a station asks, brings its schedule in line with its cells, and plans when it acts again.
    fn follow_up(&mut self, station: StationId, scene: &mut Scene) {
        if !self.stacks[station.index()].is_joined() {
            return;
        }
        loop {
            let asked = self.agree(station, scene, |Turn { msf, now, draw }| (msf.act(now, draw), msf.take_change()));
            let Some((request, has_changed)) = asked else { return };
            if has_changed {
                self.change_cells(station, scene);
            }
            let Some((to, request)) = request else { break };
            self.offer_six_p(station, to, &request, SixPRole::Request, scene);
        }
        let stack = &mut self.stacks[station.index()];
        let due = stack.msf.as_ref().and_then(|msf| msf.due());
        let at = due.map(|due| stack.clock.start_of(due).max(scene.now));
        if stack.agreement.map(|(at, _)| at) == at {
            return;
        }
        if let Some((_, key)) = stack.agreement.take() {
            scene.queue.cancel(key);
        }
        if let Some(at) = at {
            let key = self.schedule(station, at.saturating_since(scene.now), Event::CellsDue, scene);
            self.stacks[station.index()].agreement = Some((at, key));
        }
    }

    /// The cells of a station have changed.
    fn change_cells(&mut self, station: StationId, scene: &mut Scene) {
        self.count_idle(station, scene.now);
        let time_source = self.stacks[station.index()].time_source;
        let plain = self.plan.schedule(&self.settings, station, time_source);
        let stack = &mut self.stacks[station.index()];
        let negotiated = stack.msf.iter().flat_map(|msf| msf.cells());
        let schedule: Schedule = plain.with_cells(negotiated);
        self.listeners.remove(station, &stack.schedule);
        self.listeners.add(station, &schedule);
        stack.history.change(schedule.cells(), scene.now);
        stack.schedule = schedule;
        self.replan(station, scene);
    }

    /// A station is in the network, and agrees on cells with its parent from now on.
    pub(super) fn begin_agreement(&mut self, station: StationId, scene: &mut Scene) {
        let parent = self.stacks[station.index()].parent;
        self.agree(station, scene, |Turn { msf, now, draw }| msf.begin(parent, now, draw));
        self.follow_up(station, scene);
    }

    /// A station has lost the network.
    pub(super) fn end_agreement(&mut self, station: StationId, scene: &mut Scene) {
        self.agree(station, scene, |Turn { msf, now, .. }| msf.forget(now));
        if let Some((_, key)) = self.stacks[station.index()].agreement.take() {
            scene.queue.cancel(key);
        }
    }

    /// A station has another parent from now on. With MSF that is its time source too.
    pub(super) fn change_parent(&mut self, station: StationId, parent: Option<StationId>, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        if stack.msf.is_none() {
            return;
        }
        stack.parent = parent;
        if parent.is_some() && stack.is_joined() {
            stack.time_source = parent;
        }
        if stack.is_joined() {
            self.agree(station, scene, |Turn { msf, now, .. }| msf.follow(parent, now));
            self.follow_up(station, scene);
        }
    }

    /// Something is due in MSF of a station.
    pub(super) fn act_on_cells(&mut self, station: StationId, scene: &mut Scene) {
        self.stacks[station.index()].agreement = None;
        self.follow_up(station, scene);
    }

    /// A frame was sent in a slot, and acknowledged or not.
    pub(super) fn note_use(&mut self, station: StationId, cell: &Cell, ended: Ended) {
        if let Some(msf) = &mut self.stacks[station.index()].msf {
            msf.sent(cell, ended);
        }
    }

    fn offer_six_p(&mut self, station: StationId, to: StationId, message: &SixP, role: SixPRole, scene: &mut Scene) {
        let mut octets = Vec::new();
        message.write(&mut octets);
        let length = u8::try_from(octets.len()).expect("messages fit into a frame");
        let overhead = header(self.pan, station, Destination::Station(to)).overhead_octets();
        let stack = &mut self.stacks[station.index()];
        let frame = SlotFrame {
            kind: FrameKind::SixP(role),
            id: FrameId(0),
            to: Destination::Station(to),
            content: self.payloads.keep(Payload::Octets(&octets)),
            mpdu_octets: overhead + SixPFrame::ELEMENT_OCTETS + length,
            offered: scene.now,
            sequence: stack.next_sequence(),
            transmissions: 0,
            outcome: FrameOutcome::WORST,
            track: None,
        };
        stack.sender.offer_first(to, frame);
        self.replan(station, scene);
    }

    /// The message that a frame carries.
    fn message_in(&self, content: Content) -> Option<SixP> {
        match content {
            Content::Octets(slot) => SixP::read(self.payloads.octets(slot)),
            Content::Filler => None,
        }
    }

    /// A frame with a message, which ends now, has reached the station that it is for.
    pub(super) fn receive_six_p(&mut self, from: StationId, to: StationId, content: Content, scene: &mut Scene) {
        let message = self.message_in(content).filter(|_| self.stacks[to.index()].is_joined());
        let Some(message) = message else { return };
        let answer = self.agree(to, scene, |Turn { msf, now, draw }| msf.receive(from, &message, now, draw));
        if let Some(answer) = answer.flatten() {
            let role = match &answer.body {
                SixPBody::Response { code: ReturnCode::Success, .. } => SixPRole::Answer,
                SixPBody::Response { .. } | SixPBody::Request(_) => SixPRole::Refusal,
            };
            self.offer_six_p(to, from, &answer, role, scene);
        }
        self.follow_up(to, scene);
    }

    /// The sending of a message has ended.
    pub(super) fn finish_six_p(
        &mut self,
        station: StationId,
        frame: &SlotFrame,
        role: SixPRole,
        ended: Ended,
        scene: &mut Scene,
    ) {
        let message = self.message_in(frame.content);
        self.payloads.release(frame.content);
        let (Some(SixP { sequence, .. }), Destination::Station(to)) = (message, frame.to) else { return };
        self.agree(station, scene, |Turn { msf, now, draw }| match role {
            SixPRole::Request => msf.asked(to, sequence, ended, now, draw),
            SixPRole::Answer => msf.answered(to, sequence, ended),
            SixPRole::Refusal => {}
        });
        self.follow_up(station, scene);
    }

    /// What a station did with MSF until now is no longer counted.
    pub(super) fn restart_agreement(&mut self, station: StationId, now: SimTime) {
        let Stack { msf, clock, .. } = &mut self.stacks[station.index()];
        if let Some(msf) = msf {
            msf.count_from(clock.next_from(now));
        }
    }
}
