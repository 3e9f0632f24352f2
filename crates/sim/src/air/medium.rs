//! The signals on air, and the receivers that can hear them.

use std::collections::VecDeque;
use std::ops::Range;
use std::time::Duration;

use sextant_channel::{Dbm, Milliwatts, Position};
use sextant_kernel::{SimTime, StationId};

use super::ReceptionRules;
use super::budget::Budget;
use super::carrier::{Carrier, Enough, energy_in, overlap_ns};
use super::cells::Cells;
use super::changes::Changes;
use super::footprint::{Audible, Footprints, Link};
use super::items::LinkItems;
use super::listener::Listener;
use super::mounts::Mounts;
use super::receiver_id::ReceiverId;
use super::screens::Screens;
use super::sense::Sense;
use super::signal::Signal;
use super::surroundings::{AllSurroundings, Surroundings};
use crate::service::ideal::{SectorCounts, SectorPowers};
use crate::station::Motion;

/// So many signals are looked at one by one: that is faster than to look for those near a place.
const FEW: usize = 16;

/// The air of one band.
///
/// A signal takes no computing time until a station needs the power at its place: a station that senses the carrier,
/// or a radio that listens. Both look only at signals and listeners within reach, so the time for a frame grows with
/// the number of neighbours and not with the size of the network.
pub(crate) struct Medium {
    budget: Budget,
    carrier: Carrier,
    /// The signals on air and those that ended within the memory: all of them, the first ones first, ...
    recent: VecDeque<Signal>,
    /// ... and by place.
    signals: Cells<Signal>,
    /// The bursts of noise on air and those that ended within the memory: few.
    bursts: Vec<Signal>,
    /// The listeners that stand, by place.
    standing: Cells<Listener<Position>>,
    standing_count: usize,
    /// The listeners that may drive: few.
    mobile: Vec<Listener<Motion>>,
    /// What the sectors of senders reach, if antennas have sectors and all that stand is known.
    footprints: Option<Footprints>,
    /// Signals from farther away are neglected (m).
    reach_m: f64,
    /// How long a signal is kept after its end: the window of carrier sense.
    memory: Duration,
}

impl Medium {
    /// An empty medium for stations that stay near `places` and transmit with at most `power`, the gains of both
    /// antennas included; signals below `floor` may be neglected.
    pub(crate) fn new(
        budget: Budget,
        places: impl Iterator<Item = Position> + Clone,
        power: Dbm,
        floor: Dbm,
        memory: Duration,
    ) -> Self {
        let is_measured = budget.changes().is_some_and(Changes::has_trace);
        // Measured links follow no law of distance.
        let reach_m = if is_measured { f64::INFINITY } else { budget.channel().law().reach_m(power, floor) };
        Self {
            budget,
            carrier: Carrier::new(memory),
            recent: VecDeque::new(),
            bursts: Vec::new(),
            signals: Cells::covering(places.clone(), reach_m),
            standing: Cells::covering(places, reach_m),
            standing_count: 0,
            mobile: Vec::new(),
            footprints: None,
            reach_m,
            memory,
        }
    }

    /// The antennas, to mount more of them before the first signal, or to turn them.
    pub(crate) fn mounts_mut(&mut self) -> &mut Mounts {
        self.budget.mounts_mut()
    }

    /// The bodies that hide links, if any does.
    pub(crate) fn screens_mut(&mut self) -> Option<&mut Screens> {
        self.budget.screens_mut()
    }

    /// The powers of a signal at a listener with each sector of the two; `None` beyond the radius of communication.
    pub(crate) fn sector_powers(
        &mut self,
        signal: &Signal,
        listener: &Listener<Position>,
        counts: SectorCounts,
    ) -> Option<SectorPowers> {
        self.budget.sector_powers(signal, listener, counts)
    }

    /// These nodes move, in their order.
    pub(crate) fn let_move(&mut self, nodes: Vec<StationId>) {
        self.budget.let_move(nodes);
    }

    /// Adds radios that may sense the carrier.
    pub(crate) fn add_radios(&mut self, radios: usize) {
        self.carrier.add(radios);
    }

    /// Says which receivers stand for good, whether they listen or not: all but those that may drive. Called before the
    /// first of them listens.
    pub(crate) fn know_standing(&mut self, standing: impl Iterator<Item = Listener<Position>>) {
        if self.budget.is_lasting() {
            let mut cells = self.standing.clone();
            standing.for_each(|listener| cells.at(listener.place).push(listener));
            self.footprints = Some(Footprints::new(cells));
        }
    }

    /// Whether powers are the same for all packets of a link.
    pub(super) fn is_lasting(&self) -> bool {
        self.budget.is_lasting() && !self.budget.has_varying_powers()
    }

    /// The surroundings of all senders, if powers last and all of `all` stand for good; `None` otherwise. Called before the
    /// first of them listens.
    pub(super) fn all_surroundings(&self, all: impl Iterator<Item = Listener<Position>>) -> Option<AllSurroundings> {
        if !self.budget.is_lasting() || self.budget.has_antennas() || self.budget.has_varying_powers() {
            return None;
        }
        let mut cells = self.standing.clone();
        all.for_each(|listener| cells.at(listener.place).push(listener));
        Some(AllSurroundings::new(cells))
    }

    /// The surroundings of the sender of a signal among `all`; `rules` are those of a receiver.
    #[inline]
    pub(super) fn surroundings<'a, 'b>(
        &mut self,
        all: &'b mut AllSurroundings,
        signal: &Signal,
        rules: impl Fn(ReceiverId) -> &'a ReceptionRules,
    ) -> &'b Surroundings {
        all.of(signal, rules, &mut self.budget)
    }

    /// Whether it is known what signals reach among the receivers that stand.
    #[inline]
    pub(super) fn has_footprints(&self) -> bool {
        self.footprints.is_some()
    }

    /// Limits the number of links and powers that footprints remember.
    #[cfg(test)]
    pub(super) fn remember_at_most(&mut self, most: usize) {
        self.footprints.as_mut().expect("there are footprints").remember_at_most(most);
    }

    /// What a signal reaches among the receivers that stand: its links to all of them within the radius of communication,
    /// and those at which it is not negligible.
    ///
    /// # Panics
    /// Without footprints.
    pub(super) fn footprint(&mut self, signal: &Signal) -> (&[Link], &[Audible]) {
        let footprints = self.footprints.as_mut().expect("it was asked whether there are footprints");
        footprints.of(signal, self.reach_m, &mut self.budget)
    }

    /// Replaces `found` with the power of a signal at each receiver that may drive, listens, and is within the radius of
    /// communication; by receiver.
    pub(super) fn mobile_audible(&mut self, signal: &Signal, found: &mut Vec<Audible>) {
        found.clear();
        for listener in &self.mobile {
            if listener.receiver != signal.sender {
                let listener = self.budget.turned(listener, signal.start);
                let Listener { receiver, station, .. } = listener;
                let power = self.budget.power_at(signal, &listener);
                found.extend(power.map(|power| Audible { receiver, station, power }));
            }
        }
        found.sort_unstable_by_key(|audible| audible.receiver);
    }

    /// Starts a signal.
    pub(crate) fn begin(&mut self, signal: Signal) {
        let forgotten = signal.start.saturating_sub(self.memory);
        forget(&mut self.recent, forgotten);
        self.recent.push_back(signal);
        let cell = self.signals.at(signal.position);
        cell.retain(|old| old.end > forgotten);
        cell.push(signal);
    }

    /// Starts a burst of noise.
    pub(crate) fn begin_burst(&mut self, burst: Signal) {
        let forgotten = burst.start.saturating_sub(self.memory);
        self.bursts.retain(|old| old.end > forgotten);
        self.bursts.push(burst);
    }

    /// Power of a signal at a station; `None` beyond the radius of communication.
    #[inline]
    pub(crate) fn power_at(&mut self, signal: &Signal, listener: &Listener<Position>) -> Option<Milliwatts> {
        self.budget.power_at(signal, listener)
    }

    /// Share of the frames that begin at `start` and are received otherwise that arrive over a link.
    #[inline]
    pub(crate) fn success(&self, from: StationId, to: StationId, start: SimTime) -> f64 {
        self.budget.changes().map_or(1.0, |changes| changes.success(from, to, start))
    }

    /// The power of a signal at a station, item by item; `None` beyond the radius of communication.
    pub(crate) fn items(&mut self, signal: &Signal, listener: &Listener<Position>) -> Option<LinkItems> {
        self.budget.items(signal, listener)
    }

    /// Whether the mean power that a radio hears from others in a window is at or above a threshold.
    pub(crate) fn is_busy(&mut self, sense: &Sense) -> bool {
        forget(&mut self.recent, sense.to.saturating_sub(self.memory));
        if let Some(is_busy) = self.is_known_busy(sense) {
            return is_busy;
        }
        let window_s = (sense.to - sense.from).as_secs_f64();
        let (budget, reach_m) = (&mut self.budget, self.reach_m);
        let mut energy = 0.0;
        // No power is negative, so more signals make no channel idle that is busy already.
        let mut is_busy = |signal: &Signal| {
            energy += energy_in(signal, sense, reach_m, budget);
            Milliwatts(energy / window_s) >= sense.threshold
        };
        if self.bursts.iter().any(&mut is_busy) {
            return true;
        }
        if self.recent.len() <= FEW {
            return self.recent.iter().any(&mut is_busy);
        }
        let mut found = false;
        self.signals.near(sense.place, |cell| found = found || cell.iter().any(&mut is_busy));
        found
    }

    /// Mean power that a radio hears from others in a window.
    pub(super) fn mean_power(&mut self, sense: &Sense) -> Milliwatts {
        let (budget, reach_m) = (&mut self.budget, self.reach_m);
        let signals = self.bursts.iter().chain(&self.recent);
        let energy: f64 = signals.map(|signal| energy_in(signal, sense, reach_m, budget)).sum();
        Milliwatts(energy / (sense.to - sense.from).as_secs_f64())
    }

    /// Start and end of a signal that is on air, or ended within the memory.
    pub(super) fn span_of(&self, packet: u64) -> Option<Range<SimTime>> {
        self.recent.iter().find(|signal| signal.packet == packet).map(|signal| signal.start..signal.end)
    }

    /// What [`Medium::is_busy`] finds, if the table says so: that one signal is enough, or that the only one is not.
    #[inline]
    fn is_known_busy(&mut self, sense: &Sense) -> Option<bool> {
        if self.recent.len() > FEW || !self.bursts.is_empty() || !self.carrier.knows(sense) {
            return None;
        }
        let mut signals = 0;
        for signal in &self.recent {
            let overlap_ns = overlap_ns(signal, sense);
            if overlap_ns > 0 {
                match self.carrier.enough(signal, sense, self.reach_m, &mut self.budget) {
                    Enough::Overlap(least_ns) if overlap_ns >= least_ns.into() => return Some(true),
                    Enough::Overlap(_) => signals += 1,
                    Enough::Varies => return None,
                }
            }
        }
        (signals <= 1).then_some(false)
    }

    /// Whether one of the signals on air now is enough for [`Medium::is_busy`] in a window that ends later, whatever else
    /// is sent by then. If there are many signals, the answer is no.
    pub(crate) fn will_be_busy(&mut self, sense: &Sense) -> bool {
        if self.recent.len() > FEW {
            return false;
        }
        let Self { recent, carrier, budget, reach_m, .. } = self;
        let is_known = carrier.knows(sense);
        recent.iter().any(|signal| {
            let overlap_ns = overlap_ns(signal, sense);
            if overlap_ns == 0 {
                return false;
            }
            let enough = if is_known { carrier.enough(signal, sense, *reach_m, budget) } else { Enough::Varies };
            match enough {
                Enough::Overlap(least_ns) => overlap_ns >= least_ns.into(),
                Enough::Varies => {
                    let window_s = (sense.to - sense.from).as_secs_f64();
                    Milliwatts(energy_in(signal, sense, *reach_m, budget) / window_s) >= sense.threshold
                }
            }
        })
    }

    /// The last instant for which it is certain that a window as long as that of `sense`, which is not before it, finds the
    /// channel busy if it ends then: what [`Medium::will_be_busy`] says of all these windows. The start of time if there is
    /// none; `None` if the table does not know.
    pub(crate) fn busy_until(&mut self, sense: &Sense) -> Option<SimTime> {
        if self.recent.len() > FEW {
            return Some(SimTime::ZERO);
        }
        let Self { recent, carrier, budget, reach_m, .. } = self;
        if !carrier.knows(sense) {
            return None;
        }
        let mut until = SimTime::ZERO;
        for signal in recent.iter().filter(|signal| signal.end > sense.from && signal.sender != sense.radio.receiver)
        {
            match carrier.enough(signal, sense, *reach_m, budget) {
                // It is on air already, so the windows lose their overlap at its end.
                Enough::Overlap(least_ns) => {
                    let window_ns = sense.to.as_nanos() - sense.from.as_nanos();
                    if let Some(spare_ns) = window_ns.checked_sub(least_ns.into()) {
                        until = until.max(SimTime::from_nanos(signal.end.as_nanos() + spare_ns));
                    }
                }
                Enough::Varies => return None,
            }
        }
        Some(until)
    }

    /// The signals on air at `now` that may reach `place`, by packet.
    pub(crate) fn on_air(&mut self, now: SimTime, place: Position) -> Vec<Signal> {
        let mut signals = Vec::new();
        let is_on_air = |signal: &Signal| signal.start <= now && now < signal.end;
        if self.bursts.is_empty() && !self.recent.iter().any(is_on_air) {
            return signals;
        }
        self.signals.near(place, |cell| {
            signals.extend(cell.iter().filter(|&signal| is_on_air(signal)));
        });
        signals.extend(self.bursts.iter().filter(|&burst| is_on_air(burst)));
        signals.sort_by_key(|signal: &Signal| signal.packet);
        signals
    }

    /// Adds a receiver to those that listen; it stays at `place` until [`Medium::leave`].
    pub(crate) fn join(&mut self, receiver: ReceiverId, station: StationId, place: Position) {
        self.standing.at(place).push(Listener { receiver, station, place });
        self.standing_count += 1;
    }

    /// Removes a receiver from those that listen.
    pub(crate) fn leave(&mut self, receiver: ReceiverId, place: Position) {
        let listeners = self.standing.at(place);
        // Those that came last often leave first.
        if let Some(place) = listeners.iter().rposition(|listener| listener.receiver == receiver) {
            listeners.swap_remove(place);
        }
        self.standing_count -= 1;
    }

    /// Adds a receiver that may drive to those that listen, or changes how it moves.
    pub(crate) fn join_mobile(&mut self, receiver: ReceiverId, station: StationId, motion: Motion) {
        match self.mobile.iter_mut().find(|listener| listener.receiver == receiver) {
            Some(listener) => listener.place = motion,
            None => self.mobile.push(Listener { receiver, station, place: motion }),
        }
    }

    /// Removes a receiver that may drive.
    pub(crate) fn leave_mobile(&mut self, receiver: ReceiverId) {
        self.mobile.retain(|listener| listener.receiver != receiver);
    }

    /// The receivers that may drive, listen, and are farther than `radius_m` from the sender of a signal at its start.
    pub(crate) fn mobile_beyond(&self, signal: &Signal, radius_m: f64) -> impl Iterator<Item = ReceiverId> {
        let (start, position) = (signal.start, signal.position);
        let far = move |listener: &&Listener<Motion>| listener.place.at(start).distance_m(position) > radius_m;
        self.mobile.iter().filter(far).map(|listener| listener.receiver)
    }

    /// Fills `found` with the receivers that listen within reach of a signal, by number, and where they were at its
    /// start.
    pub(crate) fn listeners(&mut self, signal: &Signal, found: &mut Vec<Listener<Position>>) {
        found.clear();
        for listener in &self.mobile {
            if listener.receiver != signal.sender {
                found.push(self.budget.turned(listener, signal.start));
            }
        }
        let (has_antennas, reach_m) = (self.budget.has_antennas(), self.reach_m);
        if self.standing_count > 0 {
            self.standing.near(signal.position, |cell| {
                let is_other = |listener: &&Listener<Position>| listener.receiver != signal.sender;
                if has_antennas {
                    // Many frames of a sweep go to few stations: most of those in the cells are too far.
                    let is_near =
                        |listener: &&Listener<Position>| listener.place.distance_m(signal.position) <= reach_m;
                    found.extend(cell.iter().filter(is_other).filter(is_near));
                } else {
                    found.extend(cell.iter().filter(is_other));
                }
            });
        }
        if found.len() > 1 {
            found.sort_unstable_by_key(|listener| listener.receiver);
        }
    }
}

/// Removes the first signals as long as they ended before `forgotten`.
fn forget(recent: &mut VecDeque<Signal>, forgotten: SimTime) {
    while recent.front().is_some_and(|old| old.end <= forgotten) {
        recent.pop_front();
    }
}
