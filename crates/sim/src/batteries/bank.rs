//! What is left in the batteries of a simulation.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::battery::Charge;

use super::{Batteries, BatteryRecord, BatterySupply};

/// Shortest time between two looks at a battery: it is found empty at most so late. The longest frame takes longer.
const SHORTEST: Duration = Duration::from_millis(1);

/// Longest time between two looks (s).
const LONGEST_S: f64 = 1e6;

/// What is left in the batteries of a simulation, by node.
#[derive(Clone, Debug)]
pub(crate) struct Bank(Vec<Store>);

/// One battery.
#[derive(Clone, Debug)]
struct Store {
    supply: BatterySupply,
    /// The most that all radios together draw (W).
    most_radio_w: f64,
    charge: Charge,
    /// When it was last looked at, ...
    looked: SimTime,
    /// ... and what the meters of the radios had counted by then (J).
    metered_j: f64,
    /// What was drawn since the start, or the end of the warm-up (J).
    used_j: f64,
    /// When that began.
    used_from: SimTime,
    /// When the node died.
    died: Option<SimTime>,
    /// When it was empty.
    depleted: Option<SimTime>,
}

/// What a look at a battery finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outlook {
    /// It is empty.
    Empty,
    /// It is not empty before so long.
    Lasts(Duration),
}

impl Bank {
    /// Full batteries, of nodes whose radios draw at most so much (W).
    pub(crate) fn new(batteries: Batteries, most_radio_w: impl Fn(StationId) -> f64) -> Self {
        let store = |(i, supply): (usize, BatterySupply)| Store {
            most_radio_w: most_radio_w(StationId::from_index(i)),
            charge: supply.battery.full(),
            supply,
            looked: SimTime::ZERO,
            metered_j: 0.0,
            used_j: 0.0,
            used_from: SimTime::ZERO,
            died: None,
            depleted: None,
        };
        Self(batteries.0.into_iter().enumerate().map(store).collect())
    }

    /// The nodes with a battery.
    pub(crate) fn stations(&self) -> impl Iterator<Item = StationId> + use<> {
        (0..self.0.len()).map(StationId::from_index)
    }

    /// Whether a station has a battery that is not empty, and lives.
    pub(crate) fn feeds(&self, station: StationId) -> bool {
        self.0.get(station.index()).is_some_and(|store| store.died.is_none())
    }

    /// Takes what was drawn until `now`, when the meters of the radios have counted `metered_j`.
    pub(crate) fn settle(&mut self, station: StationId, metered_j: f64, now: SimTime) {
        let store = &mut self.0[station.index()];
        let span = now.saturating_since(store.looked);
        let drawn_j = metered_j - store.metered_j + store.supply.load_w * span.as_secs_f64();
        store.supply.battery.draw(&mut store.charge, drawn_j, span);
        store.used_j += drawn_j;
        (store.metered_j, store.looked) = (metered_j, now);
    }

    /// What is to be expected of a battery that was just settled.
    pub(crate) fn outlook(&self, station: StationId) -> Outlook {
        let store = &self.0[station.index()];
        if store.charge.is_empty() {
            return Outlook::Empty;
        }
        let battery = &store.supply.battery;
        let least_s = battery.lasts_at_least_s(&store.charge, store.most_radio_w + store.supply.load_w);
        let span_s = least_s.min(battery.averaged_s()).min(LONGEST_S);
        Outlook::Lasts(Duration::from_secs_f64(span_s).max(SHORTEST))
    }

    /// What is left (J).
    pub(crate) fn left_j(&self, station: StationId) -> f64 {
        let store = &self.0[station.index()];
        store.supply.battery.left_j(&store.charge)
    }

    /// The meters of the radios begin anew: batteries were settled. Those of nodes that have died keep what they gave.
    pub(crate) fn restart(&mut self, now: SimTime) {
        for store in self.0.iter_mut().filter(|store| store.died.is_none()) {
            (store.metered_j, store.used_j, store.used_from) = (0.0, 0.0, now);
        }
    }

    /// A node dies, because its battery is empty or not. Its battery was settled.
    pub(crate) fn die(&mut self, station: StationId, now: SimTime) {
        let Some(store) = self.0.get_mut(station.index()) else { return };
        store.died = Some(now);
        store.depleted = store.charge.is_empty().then_some(now);
    }

    /// What is left of them at the end; those of nodes that live were settled.
    pub(crate) fn close(self) -> Vec<BatteryRecord> {
        let record = |store: Store| {
            let Store { supply: BatterySupply { battery, .. }, charge, looked, used_j, used_from, depleted, .. } =
                store;
            let mut record = BatteryRecord {
                capacity_j: battery.capacity_j(),
                left_j: battery.left_j(&charge),
                used_j,
                used_for: looked.saturating_since(used_from),
                depleted,
                lifetime_s: f64::INFINITY,
            };
            record.lifetime_s = match depleted {
                Some(time) => time.as_secs_f64(),
                None => battery.lifetime_s(record.mean_power_w()),
            };
            record
        };
        self.0.into_iter().map(record).collect()
    }
}
