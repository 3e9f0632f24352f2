//! The places that the ranges of a node may mean, such as mirror images of each other, and how probable each is.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use super::fit::{Fitted, fitted};
use super::groups::RangeGroup;
use super::problem::{BIAS, HeightPrior, NodeMode, Point, Problem, SCALE, Shared};
use crate::posterior::{Concern, Estimate};

/// The law of the few ranges of so many nodes or more does not depend on where one of them is.
const MANY_NODES: usize = 12;
/// A second place is told if its share of the probability is at least that.
const LEAST_SHARE: f64 = 0.05;

/// A place of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) place: Vector3<f64>,
    pub(super) covariance: Matrix3<f64>,
    /// Its share of the probability.
    pub(super) share: f64,
}

impl Place {
    /// A place with the logarithm of its probability in the place of the share.
    pub(super) fn of(mode: &NodeMode) -> Self {
        Self {
            place: mode.state.fixed_rows::<3>(0).into_owned(),
            covariance: mode.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
            share: mode.log_evidence,
        }
    }

    pub(super) fn of_fit(fitted: &Fitted, number: usize) -> Self {
        Self {
            place: fitted.point.nodes[number].fixed_rows::<3>(0).into_owned(),
            covariance: fitted.curvature.of_node(number).fixed_view::<3, 3>(0, 0).into_owned(),
            share: fitted.log_evidence,
        }
    }

    /// How far another place is from this one (m).
    pub(super) fn apart_m(&self, other: &Self) -> f64 {
        (other.place - self.place).norm()
    }

    /// Whether this is another place, and not another hill of the same region.
    pub(super) fn is_apart(&self, other: &Self) -> bool {
        let apart = other.place - self.place;
        let variance = 0.5 * apart.dot(&((self.covariance + other.covariance) * apart));
        apart.norm_squared() > 3.0 * variance.max(0.0).sqrt()
    }
}

/// What the ranges of a node may mean.
pub(super) struct Places {
    /// The place of the fit first.
    pub(super) places: Vec<Place>,
    /// A better fit than the one that was given, with the node elsewhere.
    pub(super) better: Option<Point>,
}

/// The places of the node with this number, of which the one of `best` comes first. Of few ranges, the law is fitted again with the node
/// in each of them: it is not known so well that the best place does not make the others look impossible.
pub(super) fn places(
    problem: &Problem<'_>,
    best: &Fitted,
    number: usize,
    modes: &[NodeMode],
    watch: &dyn Watch,
) -> Result<Places, Interrupted> {
    let mut found = Places { places: vec![Place::of_fit(best, number)], better: None };
    let is_of_few = problem.groups.are_few() && problem.groups.nodes.len() < MANY_NODES;
    let here = |mode: &&NodeMode| !Place::of(mode).is_apart(&found.places[0]);
    let log_evidence = modes.iter().find(here).map_or(best.log_evidence, |mode| mode.log_evidence);
    let mut most = best.log_evidence;
    for mode in modes {
        let mut place = Place::of(mode);
        place.share += best.log_evidence - log_evidence;
        let is_new = |place: &Place, found: &Places| found.places.iter().all(|other| place.is_apart(other));
        if !is_new(&place, &found) {
            continue;
        }
        if is_of_few {
            let mut start = best.point.clone();
            start.nodes[number] = mode.state;
            let Some(again) = fitted(problem, start, watch)? else { continue };
            place = Place::of_fit(&again, number);
            if again.log_evidence > most + 0.1 {
                most = again.log_evidence;
                found.better = Some(again.point);
            }
        }
        if is_new(&place, &found) {
            found.places.push(place);
        }
    }
    shared_out(&mut found.places);
    Ok(found)
}

/// A covariance (m²) that is no wider along any direction than a deviation of `longest_m`. A node and its place are both within the
/// longest range of each stop, so they are at most twice as far apart, and a 95 % region reaches farther.
pub(super) fn within(covariance: Matrix3<f64>, longest_m: f64) -> Matrix3<f64> {
    let most = longest_m * longest_m;
    let axes = covariance.symmetric_eigen();
    if axes.eigenvalues.max() <= most {
        return covariance;
    }
    // Beside a huge eigenvalue, the products have the small ones more exactly.
    let variance = |axis: Vector3<f64>| axis.dot(&(covariance * axis)).clamp(0.0, most);
    let axes = axes.eigenvectors.column_iter().map(|axis| axis.into_owned());
    axes.map(|axis| axis * axis.transpose() * variance(axis)).sum()
}

/// How far a node may be from a stop (m), by the longest of its ranges and by how well bias and scale of all ranges are known.
pub(super) fn longest_m(groups: &[RangeGroup], shared: &Shared, bias_deviation_m: f64) -> f64 {
    let range_m = groups.iter().map(|group| group.range_m).fold(0.0, f64::max);
    ((range_m - shared[BIAS]) / (1.0 + shared[SCALE])).max(0.0) + 2.0 * bias_deviation_m
}

/// Makes shares of the logarithms of probabilities.
pub(super) fn shared_out(places: &mut [Place]) {
    let most = places.iter().map(|place| place.share).fold(f64::NEG_INFINITY, f64::max);
    places.iter_mut().for_each(|place| place.share = libm::exp(place.share - most));
    let sum: f64 = places.iter().map(|place| place.share).sum();
    places.iter_mut().for_each(|place| place.share /= sum);
}

/// Whether there is a second place that is probable enough to be told.
pub(super) fn are_two(places: &[Place]) -> bool {
    places[1..].iter().map(|place| place.share).sum::<f64>() >= LEAST_SHARE
}

/// The estimate of a node at `mean`, with what is known of it there (m²) and with its `other` places in the region, as far as they are
/// probable.
pub(super) fn estimate(
    mean: Vector3<f64>,
    mut covariance: Matrix3<f64>,
    others: &[Place],
    heights: HeightPrior,
    concern: impl FnOnce(&Matrix3<f64>) -> Option<Concern>,
) -> Estimate {
    for other in others {
        let apart = other.place - mean;
        covariance += apart * apart.transpose() * other.share;
    }
    if heights.is_given() {
        covariance.fill_row(2, 0.0);
        covariance.fill_column(2, 0.0);
    }
    let entry = |row: usize| [covariance[(row, 0)], covariance[(row, 1)], covariance[(row, 2)]];
    Estimate {
        covariance: Some([entry(0), entry(1), entry(2)]),
        concern: concern(&covariance),
        ..Estimate::of_place(Position::new(mean[0], mean[1], mean[2]))
    }
}
