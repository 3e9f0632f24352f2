//! What a node goes on with that sent nothing for a while, because nobody could have heard it.

use sextant_kernel::{NodeId, Seed, SimTime};

use crate::service::due_frames::DueFrames;

use super::{Next, Schedule, Traffic, period_start, poisson_arrival, poisson_period};

/// What a node goes on with after a rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AfterRest {
    /// Number of frames before it, if it is known: of Poisson arrivals it is not.
    pub(crate) count: Option<u64>,
    /// The frame that it goes on with.
    pub(crate) next: Next,
}

impl Traffic {
    /// Whether the frames of a node are known at any time without those before, so that it may rest.
    pub(crate) fn may_rest(&self) -> bool {
        !matches!(self.schedule, Schedule::Saturated { .. })
    }

    /// What `node` goes on with at `now`, if it had offered `count` frames before: its first frame that is due at `now` or
    /// later. `true_time` tells the true time of an instant of its schedule.
    pub(crate) fn after_rest(
        &self,
        seed: Seed,
        node: NodeId,
        count: u64,
        now: SimTime,
        true_time: impl Fn(SimTime) -> SimTime,
    ) -> AfterRest {
        match &self.schedule {
            Schedule::Silent | Schedule::Saturated { .. } => AfterRest { count: Some(count), next: Next::Never },
            &Schedule::Poisson { mean_interval_s } => {
                let mut arrival = period_start(poisson_period(mean_interval_s), now);
                while arrival < now {
                    arrival = poisson_arrival(seed, node, mean_interval_s, arrival);
                }
                AfterRest { count: None, next: Next::At(arrival, self.mpdu_octets) }
            }
            Schedule::Periodic { .. } | Schedule::Once { .. } | Schedule::Trace(_) => {
                let next = |number| self.next(seed, node, number, SimTime::ZERO);
                let is_past = |number| matches!(next(number), Next::At(due, _) if true_time(due) < now);
                let number = first_not(count, is_past);
                AfterRest { count: Some(number), next: next(number) }
            }
        }
    }

    /// The frames that `node` has before `time`. None if a node cannot rest.
    pub(crate) fn due_before(
        &self,
        seed: Seed,
        node: NodeId,
        time: SimTime,
        true_time: impl Fn(SimTime) -> SimTime,
    ) -> DueFrames {
        let count = || self.after_rest(seed, node, 0, time, true_time).count.unwrap_or(0);
        match &self.schedule {
            Schedule::Silent | Schedule::Saturated { .. } => DueFrames::default(),
            &Schedule::Poisson { mean_interval_s } => {
                let next = |&last: &SimTime| Some(poisson_arrival(seed, node, mean_interval_s, last));
                let arrivals = std::iter::successors(next(&SimTime::ZERO), next);
                DueFrames::alike(arrivals.take_while(|&arrival| arrival < time).count() as u64, self.mpdu_octets)
            }
            Schedule::Periodic { .. } | Schedule::Once { .. } => DueFrames::alike(count(), self.mpdu_octets),
            Schedule::Trace(trace) => {
                let frames = count();
                let octets = (0..frames).filter_map(|number| trace.frame(node, number)).map(|(_, octets)| octets);
                DueFrames { frames, octets: octets.map(u64::from).sum() }
            }
        }
    }
}

/// The first number from `low` on that does not satisfy `is_past`, of which all below another one do: found in a number of
/// steps that grows with the logarithm of the distance.
fn first_not(low: u64, is_past: impl Fn(u64) -> bool) -> u64 {
    let (mut low, mut step) = (low, 1);
    while is_past(low + step - 1) {
        low += step;
        step *= 2;
    }
    // All below `low` are past, and `low + step - 1` is not.
    let mut high = low + step - 1;
    while low < high {
        let middle = low + (high - low) / 2;
        if is_past(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_kernel::Files;

    use super::super::{OnceConfig, PeriodicConfig, PoissonConfig, TrafficConfig};
    use super::*;

    fn kinds() -> Vec<Traffic> {
        let periodic = PeriodicConfig::each(20, 0.7, 0.5);
        let poisson = PoissonConfig { mpdu_octets: 20, rate_per_s: 3.0, acknowledged: false, to: None };
        let once = OnceConfig { mpdu_octets: 20, at_s: 40.0, acknowledged: false, to: None };
        [TrafficConfig::Periodic(periodic), TrafficConfig::Poisson(poisson), TrafficConfig::Once(once)]
            .into_iter()
            .map(|config| config.traffic(&[], &Files::default(), "traffic").expect("good traffic"))
            .collect()
    }

    proptest! {
        #[test]
        fn a_node_goes_on_with_the_frame_that_it_would_have_had_without_a_rest(
            seed in 0..1000_u64, node in 0..1000_u32, since_s in 0.0..80.0_f64, rest_s in 0.0..300.0_f64,
        ) {
            let time = |s: f64| SimTime::ZERO + std::time::Duration::from_secs_f64(s);
            let (seed, node) = (Seed(seed), NodeId(node));
            let (since, now) = (time(since_s), time(since_s + rest_s));
            for traffic in kinds() {
                // All frames, one by one.
                let (mut count, mut last, mut before) = (0, SimTime::ZERO, 0);
                let expected = loop {
                    let next = traffic.next(seed, node, count, last);
                    let Next::At(due, _) = next else { break next };
                    before += u64::from(due < since);
                    if due >= now {
                        break next;
                    }
                    count += 1;
                    last = due;
                };
                let after = traffic.after_rest(seed, node, before, now, |due| due);
                prop_assert_eq!(after.next, expected);
                prop_assert_eq!(traffic.due_before(seed, node, now, |due| due), DueFrames::alike(count, 20));
                if !matches!(traffic.schedule, Schedule::Poisson { .. }) {
                    prop_assert_eq!(after.count, Some(count));
                }
            }
        }
    }
}
