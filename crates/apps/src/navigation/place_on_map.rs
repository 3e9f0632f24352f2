//! Where a robot is on the map.

use std::collections::VecDeque;

use sextant_channel::Position;

use super::navigation_map::MapFrame;

/// Length of way after which a fix weighs 1/e (m), in the frame of the robots and in an unknown one.
const MEMORY_M: f64 = 15.0;
const LONG_MEMORY_M: f64 = 40.0;
/// Most fixes that are kept.
const MOST_FIXES: usize = 64;
/// Standard deviation of a fix along an axis (m): most nodes around a robot are farther away than that.
const FIX_SIGMA_M: f64 = 1.5;
/// How well a map in the frame of the robots agrees with their odometry, as standard deviations: of its scale and of its
/// orientation (rad), and of the offset (m).
const TURN_SIGMA: f64 = 0.05;
const OFFSET_SIGMA_M: f64 = 0.3;
/// In an unknown frame: the robot must have driven so far from a straight line before the handedness of the map can be
/// told, as a standard deviation (m).
const LEAST_SPREAD_M: f64 = 1.4;
/// Rounds in which outliers lose weight, and the squared error, as a multiple of the median, at which half of it is lost.
const ROBUST_ROUNDS: usize = 3;
const OUTLIER: f64 = 4.0;
/// And the squared errors of one handedness must be this many times those of the other.
const CLEAR: f64 = 1.5;

/// Where a robot is on the map, from its odometry and from fixes: places on the map where the powers of nodes say that it
/// is. The two frames differ by a similarity in the plane, which is fitted to the latest fixes by least squares. In the
/// frame of the robots it is close to none, which counts as prior knowledge. In an unknown frame, both the map and its
/// mirror image are tried.
#[derive(Clone, Debug)]
pub(crate) struct PlaceOnMap {
    frame: MapFrame,
    fixes: VecDeque<Fix>,
    driven_m: f64,
    last: Option<Position>,
    similarity: Option<Similarity>,
}

#[derive(Clone, Copy, Debug)]
struct Fix {
    odometry: Position,
    map: Position,
    driven_m: f64,
}

/// `map = turn · odometry + offset` with complex numbers `x + i y`; with `mirrored`, of the conjugate of `odometry`.
#[derive(Clone, Copy, Debug)]
struct Similarity {
    turn: [f64; 2],
    offset: [f64; 2],
    lift_m: f64,
    mirrored: Handedness,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handedness {
    Same,
    Mirrored,
}

impl Handedness {
    fn of(self, place: Position) -> [f64; 2] {
        match self {
            Self::Same => [place.x_m, place.y_m],
            Self::Mirrored => [place.x_m, -place.y_m],
        }
    }
}

fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

impl PlaceOnMap {
    /// Without any fix.
    #[must_use]
    pub(crate) fn new(frame: MapFrame) -> Self {
        let similarity = match frame {
            MapFrame::Robot => {
                Some(Similarity { turn: [1.0, 0.0], offset: [0.0; 2], lift_m: 0.0, mirrored: Handedness::Same })
            }
            MapFrame::Unknown => None,
        };
        Self { frame, fixes: VecDeque::new(), driven_m: 0.0, last: None, similarity }
    }

    /// The robot was at `odometry` (m) when the nodes around it said that it was at `map` (m).
    pub(crate) fn fix(&mut self, odometry: Position, map: Position) {
        self.driven_m += self.last.map_or(0.0, |last| last.distance_m(odometry));
        self.last = Some(odometry);
        if self.fixes.len() == MOST_FIXES {
            self.fixes.pop_front();
        }
        self.fixes.push_back(Fix { odometry, map, driven_m: self.driven_m });
        self.similarity = match self.frame {
            MapFrame::Robot => Some(self.fit(Handedness::Same).0),
            // What it knew before is better than what it would learn now.
            MapFrame::Unknown if self.spread_m() < LEAST_SPREAD_M => self.similarity,
            MapFrame::Unknown => {
                let (same, mirrored) = (self.fit(Handedness::Same), self.fit(Handedness::Mirrored));
                let (better, worse) = if mirrored.1 < same.1 { (mirrored, same) } else { (same, mirrored) };
                (self.similarity.is_some() || worse.1 >= CLEAR * better.1).then_some(better.0)
            }
        };
    }

    /// Where a place known by odometry is on the map (m); `None` if the frame of the map is not known yet.
    #[must_use]
    pub(crate) fn to_map(&self, odometry: Position) -> Option<Position> {
        let Similarity { turn, offset, lift_m, mirrored } = self.similarity?;
        let [x_m, y_m] = product(turn, mirrored.of(odometry));
        Some(Position::new(x_m + offset[0], y_m + offset[1], odometry.z_m + lift_m))
    }

    /// Where a place on the map is by odometry (m); `None` if the frame of the map is not known yet.
    #[must_use]
    pub(crate) fn to_odometry(&self, map: Position) -> Option<Position> {
        let Similarity { turn: [a, b], offset, lift_m, mirrored } = self.similarity?;
        let square = a * a + b * b;
        let [x_m, y_m] = product([a / square, -b / square], [map.x_m - offset[0], map.y_m - offset[1]]);
        let place = Position::new(x_m, y_m, map.z_m - lift_m);
        let [x_m, y_m] = mirrored.of(place);
        Some(Position::new(x_m, y_m, place.z_m))
    }

    /// Length on the map of one metre that the robot drives; `None` if the frame of the map is not known yet.
    #[must_use]
    pub(crate) fn scale(&self) -> Option<f64> {
        self.similarity.map(|Similarity { turn: [a, b], .. }| libm::hypot(a, b))
    }

    /// The weights of the fixes.
    fn weighted(&self) -> impl Iterator<Item = (f64, &Fix)> + Clone {
        let memory_m = match self.frame {
            MapFrame::Robot => MEMORY_M,
            MapFrame::Unknown => LONG_MEMORY_M,
        };
        self.fixes.iter().map(move |fix| (libm::exp((fix.driven_m - self.driven_m) / memory_m), fix))
    }

    /// How far the fixes lie from a straight line, by odometry (m, standard deviation).
    fn spread_m(&self) -> f64 {
        let total: f64 = self.weighted().map(|(weight, _)| weight).sum();
        let mean = |axis: fn(&Position) -> f64| {
            self.weighted().map(|(weight, fix)| weight * axis(&fix.odometry)).sum::<f64>() / total
        };
        let (x, y) = (mean(|place| place.x_m), mean(|place| place.y_m));
        let moment = |one: fn(f64, f64) -> f64| {
            let terms = self.weighted().map(|(weight, fix)| weight * one(fix.odometry.x_m - x, fix.odometry.y_m - y));
            terms.sum::<f64>() / total
        };
        let (xx, xy, yy) = (moment(|x, _| x * x), moment(|x, y| x * y), moment(|_, y| y * y));
        // The smaller eigenvalue of the covariance.
        let smaller = 0.5 * (xx + yy - libm::hypot(xx - yy, 2.0 * xy));
        smaller.max(0.0).sqrt()
    }

    /// The similarity of least squares without outliers, and the sum of its squared errors (m²) that are not outliers. Fixes
    /// weigh less the larger their errors are beside the median, as if they had the distribution of Cauchy.
    fn fit(&self, mirrored: Handedness) -> (Similarity, f64) {
        let mut trust = vec![1.0; self.fixes.len()];
        let mut found = self.fit_trusting(mirrored, &trust);
        for _ in 0..ROBUST_ROUNDS {
            let errors = self.square_errors(&found.0);
            let mut sorted = errors.clone();
            let middle = sorted.len() / 2;
            let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
            if median <= 0.0 {
                break;
            }
            trust = errors.into_iter().map(|error| 1.0 / (1.0 + error / (OUTLIER * median))).collect();
            found = self.fit_trusting(mirrored, &trust);
        }
        found
    }

    /// The squared error of each fix (m²).
    fn square_errors(&self, &Similarity { turn, offset, mirrored, .. }: &Similarity) -> Vec<f64> {
        let error = |fix: &Fix| {
            let [x, y] = product(turn, mirrored.of(fix.odometry));
            let (x, y) = (x + offset[0] - fix.map.x_m, y + offset[1] - fix.map.y_m);
            x * x + y * y
        };
        self.fixes.iter().map(error).collect()
    }

    /// The similarity of least squares with these factors of the weights, and the weighted sum of its squared errors (m²).
    fn fit_trusting(&self, mirrored: Handedness, trust: &[f64]) -> (Similarity, f64) {
        let fixes = self
            .weighted()
            .zip(trust)
            .map(|((weight, fix), trust)| (weight * trust, mirrored.of(fix.odometry), fix.map));
        let total: f64 = fixes.clone().map(|(weight, ..)| weight).sum();
        let (mut from, mut to) = ([0.0; 2], [0.0; 2]);
        let mut lift = 0.0;
        for ((weight, odometry, map), fix) in fixes.clone().zip(&self.fixes) {
            for axis in 0..2 {
                from[axis] += weight * odometry[axis] / total;
                to[axis] += weight * [map.x_m, map.y_m][axis] / total;
            }
            lift += weight * (map.z_m - fix.odometry.z_m) / total;
        }
        // Prior knowledge as a sum of squares, and how much of the mean offset remains beside it.
        let variance = FIX_SIGMA_M * FIX_SIGMA_M;
        let (turn_weight, keep) = match self.frame {
            MapFrame::Robot => {
                let offset_weight = variance / (OFFSET_SIGMA_M * OFFSET_SIGMA_M);
                (variance / (TURN_SIGMA * TURN_SIGMA), total / (total + offset_weight))
            }
            MapFrame::Unknown => (0.0, 1.0),
        };
        let (mut cross, mut square) = ([turn_weight, 0.0], turn_weight);
        for (weight, odometry, map) in fixes.clone() {
            let o = [odometry[0] - from[0], odometry[1] - from[1]];
            let m = [map.x_m - to[0], map.y_m - to[1]];
            let [re, im] = product([o[0], -o[1]], m);
            cross[0] += weight * re;
            cross[1] += weight * im;
            square += weight * (o[0] * o[0] + o[1] * o[1]);
        }
        let turn = [cross[0] / square, cross[1] / square];
        let turned = product(turn, from);
        // In the frame of the robots, the mean of the fixes would stay where it is without an offset.
        let at_mean = match self.frame {
            MapFrame::Robot => [keep * to[0] + (1.0 - keep) * from[0], keep * to[1] + (1.0 - keep) * from[1]],
            MapFrame::Unknown => to,
        };
        let offset = [at_mean[0] - turned[0], at_mean[1] - turned[1]];
        let similarity = Similarity { turn, offset, lift_m: keep * lift, mirrored };
        let errors = self.square_errors(&similarity);
        let sum = fixes.zip(errors).map(|((weight, ..), error)| weight * error).sum();
        (similarity, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Places on a way with a bend.
    fn way() -> impl Iterator<Item = Position> {
        (0..12).map(|i| {
            let s = f64::from(i);
            Position::new(2.0 * s.min(6.0), 2.0 * (s - 6.0).max(0.0), 0.0)
        })
    }

    proptest! {
        #[test]
        fn an_unknown_frame_is_found_from_exact_fixes(
            scale in 0.05..20.0_f64, angle in -3.1..3.1_f64, x in -50.0..50.0_f64, y in -50.0..50.0_f64, mirror in any::<bool>(),
        ) {
            let on_map = |place: Position| {
                let [px, py] = if mirror { [place.x_m, -place.y_m] } else { [place.x_m, place.y_m] };
                let [mx, my] = product([scale * angle.cos(), scale * angle.sin()], [px, py]);
                Position::new(mx + x, my + y, 0.0)
            };
            let mut place = PlaceOnMap::new(MapFrame::Unknown);
            for odometry in way() {
                place.fix(odometry, on_map(odometry));
            }
            let probe = Position::new(20.0, -7.0, 0.0);
            prop_assert!(place.to_map(probe).unwrap().distance_m(on_map(probe)) < 1e-6 * scale.max(1.0));
            prop_assert!(place.to_odometry(on_map(probe)).unwrap().distance_m(probe) < 1e-6);
            prop_assert!((place.scale().unwrap() / scale - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_straight_way_does_not_tell_the_handedness() {
        let mut place = PlaceOnMap::new(MapFrame::Unknown);
        for i in 0..20 {
            let at = Position::new(f64::from(i), 0.0, 0.0);
            place.fix(at, at);
        }
        assert_eq!(place.to_map(Position::ORIGIN), None);
    }

    #[test]
    fn in_the_frame_of_the_robots_wrong_fixes_move_little() {
        let mut place = PlaceOnMap::new(MapFrame::Robot);
        let probe = Position::new(3.0, 0.0, 0.0);
        assert!(place.to_map(probe).unwrap().distance_m(probe) < 1e-12);
        place.fix(probe, Position::new(6.0, 2.0, 0.0));
        assert!(place.to_map(probe).unwrap().distance_m(probe) < 0.2);
        // Many fixes that agree win over the prior.
        for odometry in (0..5).flat_map(|_| way()) {
            place.fix(odometry, odometry + Position::new(1.0, 0.0, 0.0));
        }
        assert!(place.to_map(probe).unwrap().distance_m(Position::new(4.0, 0.0, 0.0)) < 0.9);
    }
}
