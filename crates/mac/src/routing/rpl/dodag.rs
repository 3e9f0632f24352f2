//! The place of a station in a tree of RPL.

use sextant_kernel::{SimTime, StationId};

use super::link::{LinkOutcome, LinkStatistics};
use super::message::Dio;
use super::neighbours::{Neighbour, Neighbours};
use super::rank::Rank;
use super::settings::{DodagSettings, Downward, Probing};

/// A change of the rank by more than so many least increases is told soon (Contiki-NG).
const SIGNIFICANT_INCREASES: u16 = 4;

/// How far a station is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It knows no tree.
    Detached,
    /// It knows a tree and has no parent.
    Searching,
    /// It has a parent.
    Joined,
    /// Those above know a way down to it, if anybody knows ways down.
    Reachable,
}

/// What a station has to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Note that it has another parent, or none, than before: this one before.
    NoteParent(Option<StationId>),
    /// Send the next DIO soon.
    HastenDio,
    /// Register with those above.
    Register,
    /// Ask for DIOs until there is a parent.
    Solicit,
    /// Leave the tree after a while, ...
    LeaveLater,
    /// ... or do not, because there is a parent.
    Stay,
    /// Try links from now on.
    BeginProbing,
    /// Try the most urgent link at once.
    ProbeSoon,
}

/// The place of a station in a tree whose root is a sink (a DODAG: RFC 6550, 3.1).
#[derive(Clone, Debug)]
pub struct Dodag {
    own: StationId,
    settings: DodagSettings,
    is_root: bool,
    /// The root of the tree to which it belongs.
    root: Option<StationId>,
    stage: Stage,
    rank: Rank,
    /// The least rank that it had since it had no parent.
    lowest: Rank,
    /// The rank in its last DIO to all.
    told: Rank,
    parent: Option<StationId>,
    neighbours: Neighbours,
    /// The link that must be tried first.
    urgent: Option<StationId>,
    dtsn: u8,
}

impl Dodag {
    /// The root of a tree.
    #[must_use]
    pub fn of_root(own: StationId, settings: DodagSettings) -> Self {
        let rank = Rank(settings.min_hop_rank_increase);
        let node = Self::of_node(own, settings);
        Self { is_root: true, root: Some(own), stage: Stage::Reachable, rank, ..node }
    }

    /// A station that looks for a tree.
    #[must_use]
    pub fn of_node(own: StationId, settings: DodagSettings) -> Self {
        Self {
            own,
            settings,
            is_root: false,
            root: None,
            stage: Stage::Detached,
            rank: Rank::INFINITE,
            lowest: Rank::INFINITE,
            told: Rank::INFINITE,
            parent: None,
            neighbours: Neighbours::default(),
            urgent: None,
            dtsn: 0,
        }
    }

    /// Whether it is a root.
    #[must_use]
    pub fn is_root(&self) -> bool {
        self.is_root
    }

    /// The root of its tree.
    #[must_use]
    pub fn root(&self) -> Option<StationId> {
        self.root
    }

    /// How far it is.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Its rank.
    #[must_use]
    pub fn rank(&self) -> Rank {
        self.rank
    }

    /// To whom it sends packets to the root.
    #[must_use]
    pub fn parent(&self) -> Option<StationId> {
        self.parent
    }

    /// Expected transmissions of a packet to the parent.
    #[must_use]
    pub fn parent_etx(&self) -> Option<f64> {
        let link = &self.neighbours.get(self.parent?)?.link;
        Some(f64::from(link.etx()) / f64::from(super::link::ETX_UNIT))
    }

    /// Whether it may tell its rank: if it is reachable, or has to take back what it told.
    #[must_use]
    pub fn may_tell(&self) -> bool {
        self.is_root || self.stage == Stage::Reachable || (!self.rank.is_finite() && self.told.is_finite())
    }

    /// What to tell all neighbours now.
    pub fn tell(&mut self) -> Option<Dio> {
        let dio = self.dio()?;
        self.told = dio.rank;
        Some(dio)
    }

    /// What to tell one neighbour; `None` without a tree.
    #[must_use]
    pub fn dio(&self) -> Option<Dio> {
        Some(Dio { root: self.root?, rank: self.rank, dtsn: self.dtsn })
    }

    /// A neighbour told its rank.
    pub fn heard(&mut self, from: StationId, dio: &Dio, now: SimTime) -> Vec<Action> {
        let mut actions = Vec::new();
        if self.is_root {
            return actions;
        }
        if self.root.is_none() && dio.rank.is_finite() {
            (self.root, self.stage) = (Some(dio.root), Stage::Searching);
            actions.extend([Action::LeaveLater, Action::BeginProbing]);
        }
        if self.root != Some(dio.root) {
            return actions;
        }
        let (parent, urgent, settings) = (self.parent, self.urgent, self.settings);
        let via = |rank, link: &LinkStatistics| {
            settings.objective.rank_via(rank, link.etx(), settings.min_hop_rank_increase)
        };
        let kept = |station| parent == Some(station) || urgent == Some(station);
        let Some(neighbour) = self.neighbours.entry(from, dio.rank, via, kept) else { return actions };
        neighbour.rank = dio.rank;
        let before = std::mem::replace(&mut neighbour.dtsn, dio.dtsn);
        if parent == Some(from) && is_later(dio.dtsn, before) {
            // Those above want to be told again, so those below have to tell too (RFC 6550, 9.6).
            self.dtsn = self.dtsn.wrapping_add(1);
            actions.push(Action::Register);
        }
        self.update(now, &mut actions);
        actions
    }

    /// A frame to a neighbour was sent so many times.
    pub fn sent(&mut self, to: StationId, transmissions: u32, outcome: LinkOutcome, now: SimTime) -> Vec<Action> {
        let mut actions = Vec::new();
        if let Some(neighbour) = self.neighbours.get_mut(to) {
            neighbour.link.sent(transmissions, outcome, now);
        }
        self.urgent = self.urgent.filter(|&urgent| urgent != to);
        self.update(now, &mut actions);
        actions
    }

    /// A packet says that the rank of the neighbour from which it came is this one, and that it met a rank that does not fit.
    pub fn corrected(&mut self, from: StationId, rank: Rank, now: SimTime) -> Vec<Action> {
        let mut actions = Vec::new();
        if let Some(neighbour) = self.neighbours.get_mut(from) {
            neighbour.rank = rank;
        }
        self.update(now, &mut actions);
        actions
    }

    /// Those above know a way down, or need none.
    pub fn registered(&mut self) -> Vec<Action> {
        if self.stage != Stage::Joined {
            return Vec::new();
        }
        self.stage = Stage::Reachable;
        vec![Action::HastenDio]
    }

    /// Some time has passed.
    pub fn reconsider(&mut self, now: SimTime) -> Vec<Action> {
        let mut actions = Vec::new();
        self.update(now, &mut actions);
        actions
    }

    /// What is known of links ages: each 15 minutes.
    pub fn age(&mut self) {
        self.neighbours.iter_mut().for_each(|neighbour| neighbour.link.age());
    }

    /// Local repair (RFC 6550, 3.7.1): it forgets the ranks of its neighbours and begins anew.
    pub fn repair(&mut self, now: SimTime) -> Vec<Action> {
        let mut actions = Vec::new();
        if !self.is_root && self.root.is_some() {
            self.neighbours.iter_mut().for_each(|neighbour| neighbour.rank = Rank::INFINITE);
            self.update(now, &mut actions);
        }
        actions
    }

    /// It leaves its tree, and forgets all.
    pub fn leave(&mut self) {
        if !self.is_root {
            *self = Self { dtsn: self.dtsn, ..Self::of_node(self.own, self.settings) };
        }
    }

    /// The neighbour whose link is to be tried now, by two numbers uniform in (0, 1): the most urgent one, or the parent, or
    /// another one that is not known well. Among those it is the best one two times of three, or the one that was not tried
    /// for the longest time.
    #[must_use]
    pub fn probed(&self, now: SimTime, uniform: f64) -> Option<StationId> {
        if self.urgent.is_some() {
            return self.urgent;
        }
        let is_stale = |station: StationId| self.neighbours.get(station).is_some_and(|it| !it.link.is_fresh(now));
        if let Some(parent) = self.parent.filter(|&parent| is_stale(parent)) {
            return Some(parent);
        }
        let stale = self.neighbours.iter().filter(|neighbour| !neighbour.link.is_fresh(now));
        let found = if uniform < 2.0 / 3.0 {
            stale.min_by_key(|neighbour| (self.rank_via(neighbour), neighbour.station))
        } else {
            stale.min_by_key(|neighbour| (neighbour.link.last(), neighbour.station))
        };
        found.map(|neighbour| neighbour.station)
    }

    fn rank_via(&self, neighbour: &Neighbour) -> Rank {
        let DodagSettings { objective, min_hop_rank_increase, .. } = self.settings;
        objective.rank_via(neighbour.rank, neighbour.link.etx(), min_hop_rank_increase)
    }

    fn path_cost(&self, neighbour: &Neighbour) -> u16 {
        let DodagSettings { objective, min_hop_rank_increase, .. } = self.settings;
        objective.path_cost(neighbour.rank, neighbour.link.etx(), min_hop_rank_increase)
    }

    /// Whether the rank of a neighbour is not too great (RFC 6550, 8.2.2.4), and its link good enough.
    fn accepts(&self, neighbour: &Neighbour) -> bool {
        let most = match self.settings.max_rank_increase {
            0 => Rank::INFINITE,
            most => self.lowest.plus(most.into()),
        };
        neighbour.rank <= most && self.settings.objective.accepts(neighbour.rank, neighbour.link.etx())
    }

    /// The best parent among some of the neighbours: the one that there is, unless another one is worth the change.
    fn best(&self, now: SimTime, counts: impl Fn(&Neighbour) -> bool) -> Option<StationId> {
        let accepted = || self.neighbours.iter().filter(|it| self.accepts(it) && counts(it));
        let current = accepted().find(|neighbour| Some(neighbour.station) == self.parent);
        let is_worth = |neighbour: &&Neighbour| match current {
            None => true,
            Some(current) => {
                let better_for = neighbour.better_since.map(|since| now.saturating_since(since));
                let (parent, other) = (self.path_cost(current), self.path_cost(neighbour));
                self.settings.objective.is_worth_a_change(parent, other, better_for)
            }
        };
        let cheapest = accepted()
            .filter(is_worth)
            .min_by_key(|neighbour| (self.path_cost(neighbour), neighbour.link.etx(), neighbour.station));
        cheapest.or(current).map(|neighbour| neighbour.station)
    }

    /// The parent to have, as Contiki-NG selects it. A first parent must have a link that is known well. Later a better one
    /// whose link is not known well is tried first.
    fn select(&mut self, now: SimTime, actions: &mut Vec<Action>) -> Option<StationId> {
        let best = self.best(now, |_| true)?;
        let is_fresh = |neighbour: &Neighbour| neighbour.link.is_fresh(now);
        if self.settings.probing == Probing::Off || self.neighbours.get(best).is_some_and(is_fresh) {
            self.urgent = None;
            return Some(best);
        }
        if self.urgent.is_none() {
            self.urgent = Some(best);
            actions.push(Action::ProbeSoon);
        }
        if self.parent == Some(best) {
            return Some(best);
        }
        match self.best(now, is_fresh) {
            Some(fresh) => Some(fresh),
            None => self.parent.and(Some(best)),
        }
    }

    /// Chooses the parent, and works out the rank.
    fn update(&mut self, now: SimTime, actions: &mut Vec<Action>) {
        if self.is_root || self.root.is_none() {
            return;
        }
        let before = self.parent;
        self.parent = self.select(now, actions);
        let rank = self.parent.and_then(|parent| self.neighbours.get(parent)).map(|parent| self.rank_via(parent));
        self.rank = rank.unwrap_or(Rank::INFINITE);
        let (own, settings) = (self.rank, self.settings);
        for neighbour in self.neighbours.iter_mut() {
            let (etx, least) = (neighbour.link.etx(), settings.min_hop_rank_increase);
            let is_better = settings.objective.rank_via(neighbour.rank, etx, least) < own;
            neighbour.better_since = is_better.then(|| neighbour.better_since.unwrap_or(now));
        }
        if before.is_none() || self.rank < self.lowest {
            self.lowest = self.rank;
        }
        let change = self.rank.0.abs_diff(self.told.0);
        let is_told = self.told.is_finite() && self.rank.is_finite();
        if is_told && change > SIGNIFICANT_INCREASES.saturating_mul(settings.min_hop_rank_increase) {
            self.told = self.rank;
            actions.push(Action::HastenDio);
        }
        if self.parent != before {
            self.change_parent(before, actions);
        }
    }

    /// Says what follows from another parent.
    fn change_parent(&mut self, before: Option<StationId>, actions: &mut Vec<Action>) {
        actions.push(Action::NoteParent(before));
        if self.parent.is_none() {
            (self.stage, self.lowest) = (Stage::Searching, Rank::INFINITE);
            self.neighbours.iter_mut().for_each(|neighbour| neighbour.rank = Rank::INFINITE);
            actions.extend([Action::HastenDio, Action::Solicit, Action::LeaveLater]);
            return;
        }
        if before.is_none() {
            self.stage = Stage::Joined;
            actions.push(Action::Stay);
        }
        if self.settings.downward == Downward::ByStations {
            // Those below have to register along the new way.
            self.dtsn = self.dtsn.wrapping_add(1);
            actions.push(Action::HastenDio);
        }
        match self.settings.downward {
            Downward::Unknown => actions.extend(self.registered()),
            Downward::ByRoot | Downward::ByStations => actions.push(Action::Register),
        }
    }
}

/// Whether one number of a sequence that goes round is later than another.
fn is_later(number: u8, other: u8) -> bool {
    (1..128).contains(&number.wrapping_sub(other))
}

#[cfg(test)]
mod tests;
