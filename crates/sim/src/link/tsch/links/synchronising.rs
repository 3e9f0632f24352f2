//! How stations come into the network and keep its time: scans, enhanced beacons, corrections, keep-alive frames.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::tsch::{Asn, JoiningConfig};

use super::Links;
use crate::air::Transmission;
use crate::event::tsch::Event;
use crate::link::ieee802154::header;
use crate::link::payloads::Content;
use crate::link::tsch::stack::{FrameKind, Membership, SlotFrame};
use crate::purpose;
use crate::scene::Scene;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::{Destination, FrameId};

/// How long a scan stays on a channel.
const SCAN_STEP: Duration = Duration::from_secs(1);

/// How long it stays longer if the receiver follows a frame.
const SCAN_EXTENSION: Duration = Duration::from_millis(5);

/// Shares of a period from which the instants of beacons and of keep-alive frames are drawn, as in Contiki-NG.
const EARLIEST_BEACON: f64 = 0.75;
const EARLIEST_KEEP_ALIVE: f64 = 0.9;

/// Largest join metric.
const MOST_JOIN_METRIC: u8 = u8::MAX;

impl Links {
    /// A number of a station from 0 to 1, of those that have no other address.
    fn draw(&mut self, station: StationId, scene: &Scene) -> f64 {
        let stack = &mut self.stacks[station.index()];
        let place = [station.0.into(), self.radios[0].network.0.into(), stack.draws];
        stack.draws += 1;
        scene.seed.uniform(purpose::SLOTS, place)
    }

    /// A share of a period, from `least` to 1.
    fn part_of(&mut self, period: Duration, least: f64, station: StationId, scene: &Scene) -> Duration {
        let share = least + (1.0 - least) * self.draw(station, scene);
        period.mul_f64(share)
    }

    /// The network starts to work at a station.
    pub(super) fn begin_station(&mut self, station: StationId, scene: &mut Scene) {
        if !self.stacks[station.index()].is_joined() {
            return;
        }
        for radios in &self.radios {
            scene.tune(radios.air, radios.interface(station), Some(Deafness::Asleep));
        }
        self.stacks[station.index()].deafness = Some(Deafness::Asleep);
        let is_node = scene.roll.is_node(station);
        if is_node && self.settings.synchronisation.joining == JoiningConfig::ByScan {
            return self.scan(station, scene);
        }
        self.stacks[station.index()].join_metric = self.depth(station);
        self.begin_membership(station, scene);
    }

    /// How many time sources are between a station and one that has none.
    fn depth(&self, station: StationId) -> u8 {
        let mut at = station;
        for depth in 0..MOST_JOIN_METRIC {
            match self.plan.time_sources.get(at.index()).copied().flatten() {
                None => return depth,
                Some(source) => at = source,
            }
        }
        MOST_JOIN_METRIC
    }

    /// A station is in the network: its timers run.
    fn begin_membership(&mut self, station: StationId, scene: &mut Scene) {
        if let Some(interval) = self.settings.beacon_interval
            && !std::mem::replace(&mut self.stacks[station.index()].beacons, true)
        {
            let first = self.part_of(interval, 0.0, station, scene);
            self.schedule(station, first, Event::BeaconDue, scene);
        }
        if self.has_drift && scene.roll.is_node(station) {
            self.plan_check(station, scene);
        }
        self.begin_agreement(station, scene);
    }

    /// The next beacon of a station is due.
    pub(super) fn offer_beacon(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let interval = self.settings.beacon_interval.filter(|_| stack.is_joined());
        let Some(interval) = interval else {
            stack.beacons = false;
            return;
        };
        let sequence = stack.next_sequence();
        let beacon = self.own_frame(station, FrameKind::Beacon, Destination::All, sequence, scene.now);
        self.stacks[station.index()].sender.offer_beacon(beacon);
        self.replan(station, scene);
        let next = self.part_of(interval, EARLIEST_BEACON, station, scene);
        self.schedule(station, next, Event::BeaconDue, scene);
    }

    /// A frame of the link itself.
    fn own_frame(
        &self,
        station: StationId,
        kind: FrameKind,
        to: Destination,
        sequence: u8,
        now: SimTime,
    ) -> SlotFrame {
        let mpdu_octets = match kind {
            FrameKind::Beacon => self.plan.beacon_octets(&self.settings, station),
            FrameKind::Data | FrameKind::KeepAlive | FrameKind::SixP(_) => {
                header(self.pan, station, to).overhead_octets()
            }
        };
        SlotFrame {
            kind,
            id: FrameId(0),
            to,
            content: Content::Filler,
            mpdu_octets,
            offered: now,
            sequence,
            transmissions: 0,
            outcome: FrameOutcome::WORST,
            track: None,
        }
    }

    /// A station scans from now on.
    fn scan(&mut self, station: StationId, scene: &mut Scene) {
        self.count_idle(station, scene.now);
        self.end_agreement(station, scene);
        let place = self.scanned_place(station, scene);
        let change = self.schedule(station, SCAN_STEP, Event::ChannelChanged, scene);
        let stack = &mut self.stacks[station.index()];
        self.listeners.remove(station, &stack.schedule);
        stack.history.change(&[], scene.now);
        stack.membership = Membership::Scanning { place, change };
        stack.usage.begin_scan(scene.now);
        if let Some(planned) = stack.planned.take() {
            scene.queue.cancel(planned.key);
        }
        self.tune(station, place, None, scene);
    }

    fn scanned_place(&mut self, station: StationId, scene: &Scene) -> usize {
        let channels = self.radios.len();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the sequence")]
        let place = (self.draw(station, scene) * channels as f64) as usize;
        place.min(channels - 1)
    }

    /// A station that scans changes to another channel, unless it follows a frame.
    pub(super) fn change_channel(&mut self, station: StationId, scene: &mut Scene) {
        let Membership::Scanning { place, .. } = self.stacks[station.index()].membership else { return };
        let radios = &self.radios[place];
        let receiver = radios.receiver(station);
        let follows = scene.airs[radios.air].followed_until(scene.now, receiver, scene.now).is_some();
        let (next, span) = if follows {
            (place, SCAN_EXTENSION)
        } else {
            self.tune(station, place, Some(Deafness::Asleep), scene);
            let next = self.scanned_place(station, scene);
            self.tune(station, next, None, scene);
            (next, SCAN_STEP)
        };
        let change = self.schedule(station, span, Event::ChannelChanged, scene);
        self.stacks[station.index()].membership = Membership::Scanning { place: next, change };
    }

    /// The beacon of a station ends: those that scan join, and those that have their time from it correct their clocks.
    pub(super) fn receive_beacon(
        &mut self,
        from: StationId,
        asn: Asn,
        transmission: &Transmission,
        scene: &mut Scene,
    ) {
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            if arrival.outcome != FrameOutcome::Received {
                continue;
            }
            let stack = &self.stacks[arrival.station.index()];
            if let Membership::Scanning { place, change } = stack.membership {
                scene.queue.cancel(change);
                self.tune(arrival.station, place, Some(Deafness::Asleep), scene);
                self.join(arrival.station, from, asn, transmission.start(), scene);
            } else if stack.time_source == Some(from) {
                let metric = self.stacks[from.index()].join_metric.saturating_add(1);
                self.stacks[arrival.station.index()].join_metric = metric;
            }
        }
        self.correct_clocks(from, asn, transmission, scene);
    }

    /// A station joins by the beacon of another one, which becomes its time source.
    fn join(&mut self, station: StationId, from: StationId, asn: Asn, starts: SimTime, scene: &mut Scene) {
        let metric = self.stacks[from.index()].join_metric.saturating_add(1);
        let schedule = self.plan.schedule(&self.settings, station, Some(from));
        let stack = &mut self.stacks[station.index()];
        stack.usage.count_scan(scene.now);
        // One that was in from the start and comes back has not joined.
        if stack.usage.slots.lost == 0 {
            stack.usage.slots.joined_after.get_or_insert(scene.now - SimTime::ZERO);
        }
        stack.membership = Membership::Joined;
        stack.time_source = Some(from);
        stack.join_metric = metric;
        stack.corrected = scene.now;
        stack.clock.set(asn, starts.saturating_sub(self.settings.timeslot.frame_begins()));
        stack.used = None;
        stack.usage.go_on(stack.clock.next_from(scene.now));
        stack.schedule = schedule;
        self.listeners.add(station, &stack.schedule);
        stack.history.change(stack.schedule.cells(), scene.now);
        self.replan(station, scene);
        self.begin_membership(station, scene);
    }

    /// A station in the network has its time from another one from now on. Acknowledgements of that one, and frames in cells of
    /// all, correct its clock; the cell in which it hears beacons stays.
    pub(super) fn change_time_source(&mut self, station: StationId, source: StationId) {
        let metric = self.stacks[source.index()].join_metric.saturating_add(1);
        let stack = &mut self.stacks[station.index()];
        if stack.is_joined() {
            (stack.time_source, stack.join_metric) = (Some(source), metric);
        }
    }

    /// By how much a frame begins earlier than a station expects it in its slot (us).
    pub(super) fn early_us(&self, station: StationId, asn: Asn, transmission: &Transmission) -> i64 {
        let expected = self.stacks[station.index()].clock.start_of(asn) + self.settings.timeslot.frame_begins();
        let begins = transmission.start();
        let us = |span: Duration| i64::try_from((span.as_nanos() + 500) / 1000).expect("less than an age");
        if expected >= begins { us(expected - begins) } else { -us(begins - expected) }
    }

    /// A frame of a station ends: those that have their time from it and received it in a cell that keeps the time correct their
    /// clocks.
    pub(super) fn correct_clocks(
        &mut self,
        from: StationId,
        asn: Asn,
        transmission: &Transmission,
        scene: &mut Scene,
    ) {
        if !self.has_drift {
            return;
        }
        for i in 0..self.arrivals.len() {
            let arrival = self.arrivals[i];
            let station = arrival.station;
            let stack = &self.stacks[station.index()];
            let keeps_time = stack.time_source == Some(from)
                && stack.listening.is_some_and(|listening| listening.asn == asn)
                && stack.schedule.heard_at(asn).is_some_and(|heard| heard.is_timekeeping);
            if arrival.outcome == FrameOutcome::Received && keeps_time {
                // It expected the frame later than it came: its own slots are late.
                let later_us = -self.early_us(station, asn, transmission);
                self.correct(station, asn, later_us, scene);
            }
        }
    }

    /// An acknowledgement of `from` corrects the clock of a station that has its time from it.
    pub(super) fn correct_by_acknowledgement(
        &mut self,
        station: StationId,
        from: StationId,
        correction_us: i16,
        scene: &mut Scene,
    ) {
        let stack = &self.stacks[station.index()];
        let asn = stack.sending.map(|sending| sending.chance.asn);
        if let Some(asn) = asn.filter(|_| self.has_drift && stack.time_source == Some(from)) {
            self.correct(station, asn, correction_us.into(), scene);
        }
    }

    fn correct(&mut self, station: StationId, asn: Asn, later_us: i64, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        stack.clock.correct(asn, 1000 * later_us);
        stack.corrected = scene.now;
        self.replan(station, scene);
    }

    /// Plans the next look at the clock of a station.
    fn plan_check(&mut self, station: StationId, scene: &mut Scene) {
        let period = self.settings.synchronisation.keep_alive;
        let corrected = self.stacks[station.index()].corrected;
        let due = corrected + self.part_of(period, EARLIEST_KEEP_ALIVE, station, scene);
        let lost = corrected + self.settings.synchronisation.lost_after;
        let next = if due > scene.now { due } else { lost.min(scene.now + period) };
        let next = next.saturating_since(scene.now);
        let check = self.schedule(station, next, Event::SynchronisationChecked, scene);
        self.stacks[station.index()].check = Some(check);
    }

    /// A station looks whether its clock was corrected: it asks its time source, or has lost the network.
    pub(super) fn check_synchronisation(&mut self, station: StationId, scene: &mut Scene) {
        let synchronisation = self.settings.synchronisation;
        let stack = &mut self.stacks[station.index()];
        stack.check = None;
        if !stack.is_joined() {
            return;
        }
        let uncorrected = scene.now.saturating_since(stack.corrected);
        let is_free = stack.sending.is_none() && stack.listening.is_none() && stack.answer.is_none();
        if uncorrected >= synchronisation.lost_after {
            if !is_free {
                // It looks again when the slot under way is over.
                let check =
                    self.schedule(station, self.settings.timeslot.length(), Event::SynchronisationChecked, scene);
                self.stacks[station.index()].check = Some(check);
                return;
            }
            stack.usage.slots.lost += 1;
            return self.scan(station, scene);
        }
        let asks = uncorrected >= synchronisation.keep_alive.mul_f64(EARLIEST_KEEP_ALIVE) && !stack.keeps_alive;
        if asks && let Some(source) = stack.time_source {
            let sequence = stack.next_sequence();
            let to = Destination::Station(source);
            let frame = self.own_frame(station, FrameKind::KeepAlive, to, sequence, scene.now);
            let stack = &mut self.stacks[station.index()];
            // If its queue is full, packets to the time source correct the clock.
            stack.keeps_alive = stack.sender.offer(Some(source), frame).is_ok();
            self.replan(station, scene);
        }
        self.plan_check(station, scene);
    }

    /// A frame of a station has left its link: another one may ask for a correction.
    pub(super) fn note_kept_alive(&mut self, station: StationId, kind: FrameKind) {
        if kind == FrameKind::KeepAlive {
            self.stacks[station.index()].keeps_alive = false;
        }
    }
}
