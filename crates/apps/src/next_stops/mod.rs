//! Where a robot listens next, so that the errors of the nodes fall most for the time that it takes.
//!
//! Stops are taken one by one: the one that brings most for each second that it adds to the tour of those taken before. It is
//! inserted where it adds least. Afterwards the tour is shortened by turning parts of it round (Croes 1958).

mod ground;
mod tour;

use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch, Work};
use sextant_mapper::{Outlook, StopGain};

pub use ground::{Ground, GroundError, Terrain};
use tour::Tour;

/// A stop brings nothing if the errors of the nodes that it may hear fall by a smaller share: more than fifty stops as good as this
/// one were there before.
pub const LEAST_SHARE: f64 = 0.01;
/// Gains are computed so many at once.
const AT_ONCE: usize = 32;

/// How many stops are sought, and what they cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopBudget {
    /// The most stops.
    pub stops: usize,
    /// The longest way of all (m).
    pub way_m: f64,
    /// Speed between stops (m/s), above 0.
    pub speed_m_per_s: f64,
    /// Time of listening at a stop (s).
    pub listen_s: f64,
    /// A stop costs at least this time, however near it is to the way (s), above 0.
    pub least_s: f64,
}

/// Where to drive next, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct StopPlan {
    /// The stops.
    pub stops: Vec<PlannedStop>,
    /// The expected error of a node before them (m), by its root mean square, on average over the nodes.
    pub error_m: f64,
    /// Why there are no more.
    pub end: PlanEnd,
    /// Places that were looked at.
    pub places: usize,
}

/// Why a plan has no more stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanEnd {
    /// As many stops as were sought.
    Stops,
    /// The way is used up.
    Way,
    /// No other stop brings anything.
    NothingMore,
}

/// A stop to drive to.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedStop {
    /// Where it is (m).
    pub place: Position,
    /// The places to drive over, the last of which is the stop (m).
    pub way: Vec<Position>,
    /// Length of this way (m).
    pub way_m: f64,
    /// Time of driving and listening (s).
    pub time_s: f64,
    /// What it is expected to bring after those before it.
    pub gain: StopGain,
    /// The expected error of a node after it (m), on average over the nodes.
    pub error_m: f64,
}

/// The stops that bring most for their time. The result is bit-identical for any number of threads.
///
/// # Errors
/// If `watch` ends the work.
pub fn plan(
    outlook: &Outlook,
    ground: &Ground<'_>,
    budget: &StopBudget,
    watch: &dyn Watch,
) -> Result<StopPlan, Interrupted> {
    let places = ground.places();
    let nodes = outlook.node_count() as f64;
    let steps = (places.len() * 2) as u64;
    watch.begin(Work { name: "next stops", unit: "place", steps, operations: steps as f64 * nodes * 100.0 });
    let mut known = outlook.clone();
    let mut tour = Tour::new(ground);
    let mut gains = Gains::new(known.gains(places, watch)?);
    let mut end = PlanEnd::Stops;
    while tour.len() < budget.stops {
        let chosen = gains.best(&known, &tour, places, budget, watch)?;
        let Some(place) = chosen.place else {
            end = if chosen.is_beyond_way { PlanEnd::Way } else { PlanEnd::NothingMore };
            break;
        };
        tour.insert(place, ground);
        known.take(places[place]);
        gains.are_old();
        watch.check()?;
    }
    tour.shorten();
    let mut known = outlook.clone();
    let mut here = ground.start();
    let mut stops = Vec::with_capacity(tour.len());
    for &place in tour.places() {
        watch.check()?;
        let place = places[place];
        let way = ground.way(here, place);
        let way_m = length_m(here, &way);
        let gain = known.gain(place);
        known.take(place);
        let time_s = way_m / budget.speed_m_per_s + budget.listen_s;
        stops.push(PlannedStop { place, way, way_m, time_s, gain, error_m: known.mean_error_m() });
        here = place;
    }
    Ok(StopPlan { stops, error_m: outlook.mean_error_m(), end, places: places.len() })
}

/// Length of the way over `places` (m).
fn length_m(from: Position, places: &[Position]) -> f64 {
    let legs = std::iter::once(&from).chain(places).zip(places);
    legs.map(|(a, b)| a.distance_m(*b)).sum()
}

/// What a stop at each place brings, as far as it is known.
struct Gains {
    gains: Vec<StopGain>,
    /// Whether each is that after the stops that were taken. An older one was larger.
    is_new: Vec<bool>,
}

/// The place that was chosen.
struct Choice {
    place: Option<usize>,
    /// Whether a stop brings something to which the way is too long.
    is_beyond_way: bool,
}

impl Gains {
    fn new(gains: Vec<StopGain>) -> Self {
        Self { is_new: vec![true; gains.len()], gains }
    }

    fn are_old(&mut self) {
        self.is_new.fill(false);
    }

    /// The place that brings most for its time. What is old is computed again only where it could be the best (Minoux 1978): a stop
    /// brings less after others.
    fn best(
        &mut self,
        outlook: &Outlook,
        tour: &Tour,
        places: &[Position],
        budget: &StopBudget,
        watch: &dyn Watch,
    ) -> Result<Choice, Interrupted> {
        let brings = |gain: &StopGain| gain.fall_m > LEAST_SHARE * gain.in_reach_m;
        let left_m = budget.way_m - tour.length_m();
        let mut order = Vec::new();
        let mut is_beyond_way = false;
        let is_new = |place: usize| !tour.places().contains(&place);
        for (place, gain) in self.gains.iter().enumerate().filter(|(place, gain)| brings(gain) && is_new(*place)) {
            let way_m = tour.detour_m(place);
            if way_m > left_m {
                is_beyond_way = true;
                continue;
            }
            let time_s = (way_m / budget.speed_m_per_s + budget.listen_s).max(budget.least_s);
            order.push((gain.fall_m / time_s, time_s, place));
        }
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
        let mut best: Option<(f64, usize)> = None;
        for group in order.chunks(AT_ONCE) {
            if best.is_some_and(|(rate, _)| rate >= group[0].0) {
                break;
            }
            let old: Vec<usize> =
                group.iter().map(|&(_, _, place)| place).filter(|&place| !self.is_new[place]).collect();
            let old_places: Vec<Position> = old.iter().map(|&place| places[place]).collect();
            for (&place, gain) in old.iter().zip(outlook.gains(&old_places, watch)?) {
                self.gains[place] = gain;
                self.is_new[place] = true;
            }
            for &(_, time_s, place) in group {
                let gain = &self.gains[place];
                let rate = gain.fall_m / time_s;
                if brings(gain) && best.is_none_or(|(other, _)| rate > other) {
                    best = Some((rate, place));
                }
            }
        }
        Ok(Choice { place: best.map(|(_, place)| place), is_beyond_way })
    }
}

#[cfg(test)]
mod tests;
