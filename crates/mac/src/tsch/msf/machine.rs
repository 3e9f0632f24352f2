//! The machine of MSF in a station.

use sextant_kernel::StationId;

use super::super::{Asn, Cell, CellPlace, SixP, SixPBody, SixPCommand};
use super::counters::CellCounters;
use super::negotiated::{Finding, HANDLE, HeardCell, SendCell, look_at};
use super::peer::{CLEAR_TRIES, Change, Ended, Peer, Transaction};
use super::rules::{MsfRules, MsfUse};

/// How many cells are proposed (RFC 9033, section 8).
const CANDIDATES: usize = 5;

/// Random numbers, uniform from 0 to 1.
pub(super) type Draw<'a> = &'a mut dyn FnMut() -> f64;

/// MSF in a station. `now` is the first slot that has not begun.
#[derive(Clone, Debug)]
pub struct Msf {
    pub(super) rules: MsfRules,
    /// The slot in which it listens for frames of any other.
    pub(super) own_slot: u16,
    pub(super) parent: Option<StationId>,
    /// So many cells to the parent it should have.
    pub(super) wanted: usize,
    pub(super) sending: Vec<SendCell>,
    pub(super) heard: Vec<HeardCell>,
    pub(super) peers: Vec<Peer>,
    pub(super) counters: CellCounters,
    /// The next look at how the cells deliver.
    pub(super) next_look: Asn,
    pub(super) misplaced: Option<CellPlace>,
    pub(super) has_changed: bool,
    pub(super) counts: MsfUse,
    /// Cells in which it sends, summed over the slots from `weighed_from` ...
    pub(super) cell_slots: u64,
    pub(super) weighed_from: Asn,
    /// ... to this one.
    pub(super) weighed: Asn,
}

impl Msf {
    /// A station without negotiated cells, whose autonomous cell is in `own_slot`.
    #[must_use]
    pub fn new(rules: MsfRules, own_slot: u16) -> Self {
        Self {
            rules,
            own_slot,
            parent: None,
            wanted: 1,
            sending: Vec::new(),
            heard: Vec::new(),
            peers: Vec::new(),
            counters: CellCounters::new(Asn(0)),
            next_look: Asn(rules.housekeeping),
            misplaced: None,
            has_changed: false,
            counts: MsfUse::default(),
            cell_slots: 0,
            weighed_from: Asn(0),
            weighed: Asn(0),
        }
    }

    /// The negotiated cells.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let length = self.rules.length;
        let sending = self.sending.iter().map(move |cell| cell.cell(length));
        sending.chain(self.heard.iter().map(move |cell| cell.cell(length)))
    }

    /// Whether the cells have changed since this was last asked.
    pub fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// What was done until `now`.
    #[must_use]
    pub fn used(&mut self, now: Asn) -> MsfUse {
        self.weigh(now);
        let slots = self.weighed.0.saturating_sub(self.weighed_from.0);
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53 slots")]
        let mean_cells = if slots > 0 { self.cell_slots as f64 / slots as f64 } else { 0.0 };
        let cells = u32::try_from(self.sending.len()).expect("fewer cells than slots");
        MsfUse { mean_cells, cells, ..self.counts }
    }

    /// What was done before `now` does not count.
    pub fn count_from(&mut self, now: Asn) {
        self.weigh(now);
        (self.cell_slots, self.weighed_from, self.counts) = (0, self.weighed, MsfUse::default());
    }

    pub(super) fn weigh(&mut self, now: Asn) {
        self.cell_slots += self.sending.len() as u64 * now.0.saturating_sub(self.weighed.0);
        self.weighed = self.weighed.max(now);
    }

    /// Waits before the first request for a random time up to the longest wait, so that neighbours do not begin together.
    pub fn begin(&mut self, parent: Option<StationId>, now: Asn, draw: Draw<'_>) {
        self.follow(parent, now);
        let [_, longest] = self.rules.waits;
        let held_until = Asn(now.0 + share_of(longest, draw()));
        if let Some(parent) = parent {
            self.peer(parent).held_until = held_until;
        }
        self.next_look = Asn(held_until.0 + self.rules.housekeeping);
    }

    /// The station has this parent from now on: as many cells to it are wanted as there were to the one before, and then those are
    /// given up (RFC 9033, section 5.2).
    pub fn follow(&mut self, parent: Option<StationId>, now: Asn) {
        if self.parent == parent {
            return;
        }
        self.wanted = self.cells_to_parent().count().max(self.wanted);
        self.parent = parent;
        self.misplaced = None;
        self.counters = CellCounters::new(now);
        self.sending.iter_mut().for_each(SendCell::forget);
        if let Some(parent) = parent {
            self.peer(parent);
        }
    }

    /// The station has lost the network: it forgets all that was agreed.
    pub fn forget(&mut self, now: Asn) {
        self.weigh(now);
        self.sending.clear();
        self.heard.clear();
        self.peers.clear();
        (self.wanted, self.parent, self.misplaced) = (1, None, None);
    }

    pub(super) fn cells_to(&self, peer: StationId) -> impl Iterator<Item = &SendCell> + Clone {
        self.sending.iter().filter(move |cell| cell.peer == peer)
    }

    fn cells_to_parent(&self) -> impl Iterator<Item = &SendCell> + Clone {
        self.sending.iter().filter(|cell| Some(cell.peer) == self.parent)
    }

    pub(super) fn peer(&mut self, station: StationId) -> &mut Peer {
        let known = self.peers.iter().position(|peer| peer.station == station);
        let place = known.unwrap_or_else(|| {
            self.peers.push(Peer::new(station));
            self.peers.len() - 1
        });
        &mut self.peers[place]
    }

    /// A frame was sent in a cell, and acknowledged or not.
    pub fn sent(&mut self, cell: &Cell, ended: Ended) {
        if cell.slotframe.handle != HANDLE {
            return;
        }
        let Some(used) = self.sending.iter_mut().find(|used| used.place.timeslot == cell.timeslot) else { return };
        used.count(match ended {
            Ended::Acknowledged => 1,
            Ended::GivenUp => 0,
        });
        let to = used.peer;
        self.counters.used += u64::from(Some(to) == self.parent);
        let peer = self.peer(to);
        peer.unanswered = match ended {
            Ended::Acknowledged => 0,
            Ended::GivenUp => peer.unanswered.saturating_add(1),
        };
    }

    /// The next slot at whose start something is to be done.
    #[must_use]
    pub fn due(&self) -> Option<Asn> {
        let timeslots = self.cells_to_parent().map(|cell| cell.place.timeslot);
        let full = self.counters.full_at(timeslots, self.rules.length, self.rules.max_num_cells.into());
        let look = self.parent.map(|_| self.next_look);
        let peers = self.peers.iter().filter_map(|peer| match &peer.open {
            Some(open) => Some(open.deadline),
            None => (peer.is_free() && self.wants_of(peer)).then_some(peer.held_until),
        });
        full.into_iter().chain(look).chain(peers).min()
    }

    /// Whether something is to be asked of a neighbour.
    fn wants_of(&self, peer: &Peer) -> bool {
        if peer.clears > 0 {
            return true;
        }
        let cells = self.cells_to(peer.station).count();
        if Some(peer.station) == self.parent {
            cells != self.wanted || self.misplaced.is_some()
        } else {
            cells > 0 && self.has_enough()
        }
    }

    /// Whether the parent has as many cells as it should.
    fn has_enough(&self) -> bool {
        self.parent.is_some() && self.cells_to_parent().count() >= self.wanted
    }

    /// Does what is due. Returns a request to a neighbour; called again until there is none.
    pub fn act(&mut self, now: Asn, draw: Draw<'_>) -> Option<(StationId, SixP)> {
        self.expire(now, draw);
        self.adapt(now);
        self.keep_house(now);
        let (station, command) = loop {
            let may_ask = |peer: &&Peer| peer.is_free() && peer.held_until <= now && self.wants_of(peer);
            let station = self.peers.iter().find(may_ask)?.station;
            match self.command_to(station, draw) {
                Some(command) => break (station, command),
                // No slot is free.
                None => self.hold(station, now, draw),
            }
        };
        if command == SixPCommand::Clear {
            self.drop_cells(station, now);
        }
        self.counts.transactions += 1;
        let deadline = Asn(now.0 + self.rules.timeout);
        let peer = self.peer(station);
        let sequence = peer.sequence;
        peer.open = Some(Transaction { command: command.clone(), sequence, deadline });
        Some((station, SixP { sequence, body: SixPBody::Request(command) }))
    }

    /// What is asked of a neighbour next; `None` if no slot is free for it.
    fn command_to(&mut self, station: StationId, draw: Draw<'_>) -> Option<SixPCommand> {
        let cells = self.cells_to(station).count();
        if self.peer(station).clears > 0 || Some(station) != self.parent {
            let peer = self.peer(station);
            peer.clears = if peer.clears == 0 { CLEAR_TRIES } else { peer.clears };
            return Some(SixPCommand::Clear);
        }
        if cells < self.wanted {
            let candidates = self.candidates(draw);
            return (!candidates.is_empty()).then_some(SixPCommand::Add { candidates });
        }
        if cells > self.wanted {
            let cell = self.cells_to(station).last()?.place;
            return Some(SixPCommand::Delete { cell });
        }
        let cell = self.misplaced.take()?;
        let candidates = self.candidates(draw);
        (!candidates.is_empty()).then_some(SixPCommand::Relocate { cell, candidates })
    }

    /// Transactions without a response end.
    fn expire(&mut self, now: Asn, draw: Draw<'_>) {
        while let Some(peer) =
            self.peers.iter_mut().find(|peer| peer.open.as_ref().is_some_and(|open| open.deadline <= now))
        {
            let (station, open) = (peer.station, peer.open.take());
            self.counts.failures += 1;
            if open.is_some_and(|open| open.command == SixPCommand::Clear) {
                self.clear_failed(station);
            }
            self.hold(station, now, draw);
        }
    }

    /// So many cells have gone by: one is added if most were used, and deleted if few were (RFC 9033, section 5.1).
    fn adapt(&mut self, now: Asn) {
        let rules = self.rules;
        let timeslots: Vec<u16> = self.cells_to_parent().map(|cell| cell.place.timeslot).collect();
        let elapsed = self.counters.elapse(timeslots.iter().copied(), rules.length, now);
        if elapsed < rules.max_num_cells.into() {
            return;
        }
        let (cells, used) = (timeslots.len(), self.counters.used);
        if used > rules.used_high.into() {
            self.wanted = cells + 1;
        } else if used < rules.used_low.into() && cells > 1 {
            self.wanted = cells - 1;
        }
        self.counters = CellCounters::new(now);
    }

    fn keep_house(&mut self, now: Asn) {
        if now < self.next_look {
            return;
        }
        self.next_look = Asn(now.0 + self.rules.housekeeping);
        match look_at(self.cells_to_parent()) {
            Finding::Nothing => {}
            Finding::Misplaced(cell) => self.misplaced = Some(cell),
            Finding::AllDead => {
                if let Some(parent) = self.parent {
                    self.start_again(parent, now);
                }
            }
        }
    }

    /// A random time passes before a neighbour is asked again.
    pub(super) fn hold(&mut self, station: StationId, now: Asn, draw: Draw<'_>) {
        let [least, longest] = self.rules.waits;
        self.peer(station).held_until = Asn(now.0 + least + share_of(longest - least, draw()));
    }

    /// The schedules of two stations differ: all cells between them are given up (RFC 9033, section 12).
    pub(super) fn start_again(&mut self, station: StationId, now: Asn) {
        self.drop_cells(station, now);
        let peer = self.peer(station);
        (peer.clears, peer.unanswered) = (CLEAR_TRIES, 0);
    }

    pub(super) fn drop_cells(&mut self, station: StationId, now: Asn) {
        self.weigh(now);
        self.settle(now);
        self.sending.retain(|cell| cell.peer != station);
        self.heard.retain(|cell| cell.peer != station);
        if Some(station) == self.parent {
            self.misplaced = None;
        }
        self.has_changed = true;
    }

    /// Cells to the parent are counted before they change.
    pub(super) fn settle(&mut self, now: Asn) {
        let timeslots: Vec<u16> = self.cells_to_parent().map(|cell| cell.place.timeslot).collect();
        self.counters.elapse(timeslots.into_iter(), self.rules.length, now);
    }

    pub(super) fn clear_failed(&mut self, station: StationId) {
        let peer = self.peer(station);
        peer.clears -= 1;
        if peer.clears == 0 {
            peer.sequence = 0;
        }
    }

    /// Whether a slot is free for a negotiated cell, and not promised to any neighbour.
    pub(super) fn is_free(&self, timeslot: u16) -> bool {
        let is_promised = |peer: &Peer| match (&peer.answer, &peer.open) {
            (Some((_, Change::Added(place) | Change::Relocated { to: place, .. })), _) => place.timeslot == timeslot,
            (_, Some(open)) => match &open.command {
                SixPCommand::Add { candidates } | SixPCommand::Relocate { candidates, .. } => {
                    candidates.iter().any(|place| place.timeslot == timeslot)
                }
                SixPCommand::Delete { .. } | SixPCommand::Clear => false,
            },
            _ => false,
        };
        timeslot != 0
            && timeslot != self.own_slot
            && timeslot < self.rules.length
            && self.sending.iter().all(|cell| cell.place.timeslot != timeslot)
            && self.heard.iter().all(|cell| cell.place.timeslot != timeslot)
            && !self.peers.iter().any(is_promised)
    }

    /// Cells to propose: random ones in free slots.
    fn candidates(&self, draw: Draw<'_>) -> Vec<CellPlace> {
        let mut slots: Vec<u16> = (1..self.rules.length).filter(|&timeslot| self.is_free(timeslot)).collect();
        let mut candidates = Vec::with_capacity(CANDIDATES);
        while candidates.len() < CANDIDATES && !slots.is_empty() {
            let timeslot = slots.swap_remove(index_below(slots.len(), draw()));
            let offset = index_below(self.rules.channels.into(), draw());
            let channel_offset = u16::try_from(offset).expect("below a number of 16 bits");
            candidates.push(CellPlace { timeslot, channel_offset });
        }
        candidates
    }
}

/// A share of a number of slots.
fn share_of(slots: u64, share: f64) -> u64 {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most so many slots, which are few"
    )]
    let part = (slots as f64 * share) as u64;
    part
}

/// An index below `count`, each with the same probability.
fn index_below(count: usize, share: f64) -> usize {
    let index = share_of(count as u64, share);
    usize::try_from(index).expect("it fits").min(count.saturating_sub(1))
}
