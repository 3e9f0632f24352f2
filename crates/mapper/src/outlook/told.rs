//! What one stop tells of one node.

use nalgebra::Matrix3;
use sextant_channel::Position;

use super::law::StopLaw;

/// Strengths are told apart in so many steps.
const STRENGTHS: usize = 16;
/// The steps go so many standard deviations beyond the strengths that are expected.
const BEYOND: f64 = 2.0;
/// The most outcomes of a stop: silence, and numbers of packets or strengths.
const MOST: usize = STRENGTHS + 1;

/// What is expected of a node after a stop, whatever will be heard there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    /// Expected fall of the covariance of the node (m²): by the law of total variance, the covariance over all outcomes of the mean
    /// after each.
    pub(super) fall: Matrix3<f64>,
    /// Probability that nothing is heard.
    pub(super) silence: f64,
    /// The error that is left then (m), by its root mean square.
    pub(super) silent_m: f64,
    /// The error that is left if something is heard, times the probability that it is (m).
    pub(super) heard_m: f64,
}

/// Sums over the places of a node, of their weights times the probability of an outcome.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: f64,
    place: [f64; 3],
    square: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, [x, y, z]: [f64; 3]) {
        self.weight += weight;
        self.place[0] += weight * x;
        self.place[1] += weight * y;
        self.place[2] += weight * z;
        self.square += weight * (x * x + y * y + z * z);
    }

    /// Root mean square of the error after the outcome, times its probability.
    fn error(&self) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        let mean_square: f64 = self.place.iter().map(|sum| sum * sum).sum::<f64>() / self.weight;
        ((self.square - mean_square).max(0.0) * self.weight).sqrt()
    }
}

/// What a stop at `stop` would tell of a node that is at one of `places`, with these weights, whose sum is 1. `None` if it is out of
/// reach at all of them.
pub(super) fn told(law: &StopLaw, places: &[(Position, f64)], stop: Position) -> Option<Told> {
    let reach_m = law.reach_m();
    let distances: Vec<f64> = places.iter().map(|(place, _)| place.distance_m(stop)).collect();
    if distances.iter().all(|&distance_m| distance_m >= reach_m) {
        return None;
    }
    let (origin, _) = places[0];
    let mut sums = [Sums::default(); MOST];
    let steps =
        law.strengths.map(|strengths| Steps::of(&distances, |d| strengths.strength_db(d) / strengths.noise_db));
    for (&(place, weight), &distance_m) in places.iter().zip(&distances) {
        let place: [f64; 3] = (place - origin).into();
        let arrives = law.probability(distance_m);
        match &steps {
            None => {
                let shares = numbers_of_packets(arrives, law.packets);
                shares.iter().zip(&mut sums).for_each(|(share, sums)| sums.add(weight * share, place));
            }
            Some(steps) => {
                let silence = (1.0 - arrives).powi(law.packets.cast_signed());
                sums[0].add(weight * silence, place);
                let strength = law.strengths.map_or(0.0, |of| of.strength_db(distance_m) / of.noise_db);
                let shares = steps.shares(strength);
                let heard = weight * (1.0 - silence);
                shares.iter().zip(&mut sums[1..]).for_each(|(share, sums)| sums.add(heard * share, place));
            }
        }
    }
    let mut mean = [0.0; 3];
    let mut fall = Matrix3::zeros();
    for sums in sums.iter().filter(|sums| sums.weight > 0.0) {
        for (row, sum) in sums.place.iter().enumerate() {
            mean[row] += sum;
            for (column, other) in sums.place.iter().enumerate() {
                fall[(row, column)] += sum * other / sums.weight;
            }
        }
    }
    fall -= Matrix3::from_fn(|row, column| mean[row] * mean[column]);
    let silence = sums[0].weight;
    let silent_m = if silence > 0.0 { sums[0].error() / silence } else { 0.0 };
    Some(Told { fall, silence, silent_m, heard_m: sums[1..].iter().map(Sums::error).sum() })
}

/// The probability of each number of packets out of `packets`, none first.
fn numbers_of_packets(arrives: f64, packets: u32) -> [f64; MOST] {
    let mut shares = [0.0; MOST];
    shares[0] = 1.0;
    for sent in 1..=packets as usize {
        for number in (1..=sent).rev() {
            shares[number] = shares[number] * (1.0 - arrives) + shares[number - 1] * arrives;
        }
        shares[0] *= 1.0 - arrives;
    }
    shares
}

/// The steps in which strengths are told apart, in standard deviations of their noise.
struct Steps {
    first: f64,
    step: f64,
}

impl Steps {
    /// Those that hold the strengths over `distances`.
    fn of(distances: &[f64], strength: impl Fn(f64) -> f64) -> Self {
        let fold = |from: f64, pick: fn(f64, f64) -> f64| distances.iter().copied().fold(from, pick);
        let strongest = strength(fold(f64::INFINITY, f64::min)) + BEYOND;
        let weakest = strength(fold(0.0, f64::max)) - BEYOND;
        Self { first: weakest, step: (strongest - weakest) / (STRENGTHS - 1) as f64 }
    }

    /// The probability that a strength is measured as that of each step.
    fn shares(&self, strength: f64) -> [f64; STRENGTHS] {
        let mut shares = [0.0; STRENGTHS];
        for (number, share) in shares.iter_mut().enumerate() {
            let off = self.first + self.step * number as f64 - strength;
            *share = libm::exp(-0.5 * off * off);
        }
        let total: f64 = shares.iter().sum();
        shares.map(|share| share / total)
    }
}
