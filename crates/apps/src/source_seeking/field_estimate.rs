//! The value of the field at the robot, from the readings of the nodes around it.

use std::collections::BTreeMap;

use sextant_channel::{Db, Position};
use sextant_kernel::{SimTime, StationId};

use super::estimate::Weights;
use super::local_fit::{Axes, Degree, Fitting, LocalFit, Sample};
use crate::navigation::HeardNode;

/// Factor from one bandwidth to the next.
const GROWTH: f64 = 1.5;
/// Largest bandwidth, as a share of the distance from which nodes answer.
const WIDEST: f64 = 1.0;
/// Readings that weigh less than this are left out.
const LEAST_WEIGHT: f64 = 0.01;
/// Ridge of local fits: a term that few readings tell is held down.
const RIDGE: f64 = 1e-3;

/// The readings that a robot has heard.
#[derive(Clone, Debug, Default)]
pub(super) struct Readings {
    by_node: BTreeMap<StationId, (HeardNode, f64)>,
}

/// The nodes around a place (m on the map).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) center: Position,
    pub(super) radius_m: f64,
}

/// The field at the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FieldEstimate {
    /// Its value, as exactly as the readings tell it: by this a robot has arrived.
    pub(super) value: f64,
    /// Its value by a stiffer fit, which flattens peaks but varies less on the way: by this it steers.
    pub(super) smooth: f64,
    /// Its gradient (1/m on the map); `None` if the rule does not tell.
    pub(super) gradient: Option<Position>,
}

impl Readings {
    /// A reading was heard: the one before it of the same node does not count any more.
    pub(super) fn hear(&mut self, station: StationId, heard: HeardNode, value: f64) {
        self.by_node.insert(station, (heard, value));
    }

    /// Their number.
    pub(super) fn len(&self) -> usize {
        self.by_node.len()
    }

    /// Forgets readings that were heard before `time`.
    pub(super) fn forget_before(&mut self, time: SimTime) {
        self.by_node.retain(|_, (heard, _)| heard.time >= time);
    }

    /// The weighted mean (thesis, chapter 7, equation of d(t)) of those heard since `since` that are within the distance of
    /// the place in `within` (m on the map); if none is so near, the nearest one counts.
    pub(super) fn mean(&self, since: SimTime, weights: Weights, within: Option<(Disc, Axes)>) -> Option<f64> {
        let latest = || self.by_node.values().filter(|(heard, _)| heard.time >= since);
        let apart_m =
            |heard: &HeardNode| within.map_or(0.0, |(disc, axes)| axes.of(heard.place - disc.center).length_m());
        let nearest_m = latest().map(|(heard, _)| apart_m(heard)).min_by(f64::total_cmp)?;
        let reach_m = within.map_or(0.0, |(disc, _)| disc.radius_m).max(nearest_m);
        let counting = || latest().filter(|(heard, _)| apart_m(heard) <= reach_m);
        // Relative to the strongest one, so that no weight underflows.
        let strongest = counting().map(|(heard, _)| heard.gain.0).max_by(f64::total_cmp)?;
        let weigh = |heard: &HeardNode| match weights {
            Weights::Equal => 1.0,
            Weights::DbmRatio => heard.rssi.0 / (heard.rssi - heard.gain).0,
            Weights::Power => Db(heard.gain.0 - strongest).to_factor(),
        };
        let (mut total, mut sum) = (0.0, 0.0);
        for (heard, value) in counting() {
            let weight = weigh(heard);
            total += weight;
            sum += weight * value;
        }
        let mean = sum / total;
        mean.is_finite().then_some(mean)
    }

    /// The field at `place` by local fits whose bandwidth is at least `bandwidth` (m on the map), and at most half of
    /// `reach`, the distance from which nodes answer.
    pub(super) fn fitted(
        &self,
        place: Position,
        axes: Axes,
        [bandwidth, reach]: [f64; 2],
        significance: f64,
    ) -> Option<FieldEstimate> {
        let mut bandwidth = bandwidth;
        let mut value = None;
        let mut samples = Vec::with_capacity(self.by_node.len());
        loop {
            samples.clear();
            samples.extend(self.samples(place, axes, |distance| {
                let weight = libm::exp(-0.5 * (distance / bandwidth) * (distance / bandwidth));
                if weight < LEAST_WEIGHT { 0.0 } else { weight }
            }));
            let fitting = |degree| Fitting { axes, degree, scale_m: bandwidth, ridge: RIDGE };
            let linear = fitting(Degree::Linear).best(&samples);
            let wider = GROWTH * bandwidth;
            // A wide paraboloid flattens a peak too.
            if value.is_none() || bandwidth <= 0.5 * reach {
                value = fitting(Degree::Quadratic).best(&samples).map(|fit| fit.value).or(value);
            }
            let stands_out = |fit: &LocalFit| {
                fit.degree == Degree::Linear && fit.gradient.length_m() >= significance * fit.gradient_sigma
            };
            match linear {
                Some(fit) if wider > WIDEST * reach || stands_out(&fit) => {
                    return Some(FieldEstimate {
                        value: value.unwrap_or(fit.value),
                        smooth: fit.value,
                        gradient: Some(fit.gradient),
                    });
                }
                None if wider > WIDEST * reach && samples.len() == self.by_node.len() => return None,
                _ => bandwidth = wider,
            }
        }
    }

    /// The readings as samples around `place`, with weights by distance; without those that weigh nothing.
    pub(super) fn samples(
        &self,
        place: Position,
        axes: Axes,
        weigh: impl Fn(f64) -> f64,
    ) -> impl Iterator<Item = Sample> {
        self.by_node.values().filter_map(move |(heard, value)| {
            let offset = axes.of(heard.place - place);
            let weight = weigh(offset.length_m());
            (weight > 0.0).then_some(Sample { offset, value: *value, weight })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn heard(x_m: f64, y_m: f64, gain_db: f64, seconds: u64) -> HeardNode {
        let time = SimTime::ZERO + Duration::from_secs(seconds);
        HeardNode {
            place: Position::new(x_m, y_m, 0.0),
            gain: Db(gain_db),
            rssi: sextant_channel::Dbm(gain_db - 50.0),
            time,
        }
    }

    /// Readings of a field on a lattice of 1 m around the origin.
    fn lattice(field: impl Fn(f64, f64) -> f64) -> Readings {
        let mut readings = Readings::default();
        for i in 0..169_u32 {
            let (x, y) = (f64::from(i % 13) - 6.0, f64::from(i / 13) - 6.0);
            readings.hear(StationId(i), heard(x, y, -50.0, 0), field(x, y));
        }
        readings
    }

    fn fitted(readings: &Readings, x_m: f64, y_m: f64) -> FieldEstimate {
        // The height of the place does not matter in the plane.
        let place = Position::new(x_m, y_m, 3.0);
        readings.fitted(place, Axes::Plane, [1.25, 5.5], 3.0).expect("readings")
    }

    #[test]
    fn the_value_on_a_paraboloid_is_exact_and_a_plane_flattens_it() {
        let readings = lattice(|x, y| 10.0 - 0.1 * (x * x + y * y));
        let peak = fitted(&readings, 0.0, 0.0);
        assert!((peak.value - 10.0).abs() < 0.02, "{peak:?}");
        assert!(peak.smooth < 9.8, "{peak:?}");
        let slope = fitted(&readings, 2.0, 0.5);
        assert!((slope.value - (10.0 - 0.425)).abs() < 0.02, "{slope:?}");
        let gradient = slope.gradient.expect("a fit");
        assert!(gradient.distance_m(Position::new(-0.4, -0.1, 0.0)) < 0.02, "{gradient}");
    }

    #[test]
    fn a_mean_has_its_weights_and_takes_the_latest_answers() {
        let mut readings = Readings::default();
        // All send with -50 dBm.
        readings.hear(StationId(0), heard(0.0, 0.0, -40.0, 5), 0.0);
        readings.hear(StationId(1), heard(1.0, 0.0, -30.0, 5), 11.0);
        readings.hear(StationId(2), heard(2.0, 0.0, -20.0, 1), 99.0);
        let since = SimTime::ZERO + Duration::from_secs(2);
        for (weights, expected) in [
            (Weights::Equal, 5.5),
            // -90 / -50 = 1.8 and -80 / -50 = 1.6: the weaker one counts more.
            (Weights::DbmRatio, 1.6 * 11.0 / 3.4),
            // A tenth and one.
            (Weights::Power, 10.0),
        ] {
            let mean = readings.mean(since, weights, None).expect("readings");
            assert!((mean - expected).abs() < 1e-9, "{weights:?}: {mean}");
        }
        readings.forget_before(since);
        assert_eq!(readings.len(), 2);
        assert_eq!(readings.mean(SimTime::ZERO + Duration::from_secs(6), Weights::Power, None), None);
    }

    #[test]
    fn linear_weights_of_weak_signals_do_not_vanish() {
        let mut readings = Readings::default();
        readings.hear(StationId(0), heard(0.0, 0.0, -4000.0, 0), 0.0);
        readings.hear(StationId(1), heard(1.0, 0.0, -3990.0, 0), 11.0);
        let mean = readings.mean(SimTime::ZERO, Weights::Power, None).expect("readings");
        assert!((mean - 10.0).abs() < 1e-9, "{mean}");
    }

    #[test]
    fn a_mean_takes_the_nodes_in_reach_or_else_the_nearest_one() {
        let mut readings = Readings::default();
        for (i, x_m) in [(0, 0.0), (1, 3.0), (2, 5.0)] {
            readings.hear(StationId(i), heard(x_m, 0.0, -40.0, 0), f64::from(i));
        }
        let mean = |x_m: f64, radius_m: f64| {
            let disc = Disc { center: Position::new(x_m, 0.0, 7.0), radius_m };
            readings.mean(SimTime::ZERO, Weights::Equal, Some((disc, Axes::Plane))).expect("readings")
        };
        assert!((mean(1.0, 2.0) - 0.5).abs() < 1e-12, "the first two: the height does not matter in the plane");
        assert!((mean(4.0, 1.0) - 1.5).abs() < 1e-12, "the last two");
        assert!((mean(9.0, 1.0) - 2.0).abs() < 1e-12, "none is so near");
    }

    #[test]
    fn without_readings_there_is_no_estimate_and_a_single_one_is_taken_as_it_is() {
        let mut readings = Readings::default();
        assert_eq!(readings.fitted(Position::ORIGIN, Axes::Plane, [1.0, 5.0], 3.0), None);
        readings.hear(StationId(0), heard(40.0, 0.0, -50.0, 0), 7.0);
        let far = readings.fitted(Position::ORIGIN, Axes::Plane, [1.0, 5.0], 3.0).expect("a reading");
        assert!((far.value - 7.0).abs() < 1e-9 && (far.smooth - 7.0).abs() < 1e-9);
    }
}
