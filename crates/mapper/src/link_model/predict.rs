//! What a law says of links that were not heard yet.

use nalgebra::{Cholesky, DMatrix, DVector};
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::maths::{cholesky, exp_each, solve_lower};

use super::hearing::Hearing;
use super::law::Law;
use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::site::Site;
use super::{LinkFit, posterior};
use crate::numerics::sums::dot;

/// A node for which links are predicted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) place: Position,
    /// Covariance of the place (m²).
    pub(crate) covariance: [[f64; 3]; 3],
}

/// The margin of a link as it is predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PredictedMargin {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

/// A place as seen from a node.
#[derive(Clone, Copy, Debug)]
struct SeenPlace {
    place: Position,
    /// Its distance, at least a share of the usual one (m).
    distance_m: f64,
    /// Cosine and sine of its direction, and of twice that.
    direction: [f64; 4],
    /// Logarithm of the distance over that of the law.
    farther: f64,
}

/// Distances below this share of the usual distance of a link are taken as it.
const NEAREST: f64 = 0.02;

/// Predicts the margins of links between a node and places where no robot has listened yet, from its links in a log.
#[derive(Debug)]
pub(crate) struct Predictor {
    links: PlaceLinks,
    law: Law,
    hearing: Hearing,
    outage: f64,
}

impl Predictor {
    /// A predictor from `log` under what was `fitted` to it; `None` if nothing was heard.
    pub(crate) fn new(log: &ReceptionLog, fitted: &LinkFit) -> Option<Self> {
        let links = PlaceLinks::of(log, fitted.receiver.is_some())?;
        let hearing = Hearing::new(&links, fitted.receiver, fitted.losses);
        Some(Self { links, law: fitted.law, hearing, outage: fitted.outage })
    }

    /// The margins of links from node number `node` of the log to `others`, if it is where `placed` says. `None` if it was not
    /// heard.
    pub(crate) fn margins(&self, node: usize, placed: &Placed, others: &[Position]) -> Option<Vec<PredictedMargin>> {
        let links = self.links.nodes.iter().find(|links| links.node().index() == node)?;
        let known = links.links.iter().map(|link| self.seen(placed.place, self.links.places[link.place]));
        let known: Vec<SeenPlace> = known.collect();
        let sites = self.sites(links, &known);
        let columns = known.iter().map(|place| DVector::from_vec(self.covariances(place, &known)));
        let mut covariance = DMatrix::from_columns(&columns.collect::<Vec<_>>());
        for (i, site) in sites.iter().enumerate() {
            covariance[(i, i)] += self.alone() + site.variance;
        }
        let errors = DVector::from_fn(known.len(), |i, _| sites[i].margin - self.mean(&known[i]));
        let size = covariance.nrows();
        if !cholesky(covariance.as_mut_slice(), size) {
            return None;
        }
        let factor = Cholesky::pack_dirty(covariance);
        let weights = factor.solve(&errors);
        let others: Vec<SeenPlace> = others.iter().map(|&other| self.seen(placed.place, other)).collect();
        let with: Vec<Vec<f64>> = others.iter().map(|other| self.covariances(other, &known)).collect();
        // The squares of half of the solutions.
        let mut halves = with.concat();
        solve_lower(factor.l_dirty().as_slice(), size, &mut halves);
        let each = others.iter().zip(&with).zip(halves.chunks_exact(size.max(1)));
        let predicted = each.map(|((other, with), half)| {
            let mean = self.mean(other) + dot(with, weights.as_slice());
            let own: f64 = self.covariances(other, std::slice::from_ref(other)).iter().sum();
            let told = dot(half, half);
            let variance = own + self.alone() - told + self.of_place(placed, other);
            PredictedMargin { mean, variance: variance.max(1e-6) }
        });
        Some(predicted.collect())
    }

    /// The links as normal distributions of margins, round what the place tells.
    fn sites(&self, links: &NodeLinks, known: &[SeenPlace]) -> Vec<Site> {
        let spread = self.law.spread().max(posterior::LEAST_SPREAD);
        let each = links.links.iter().zip(known);
        let link = |link: &HeardLink| HeardLink { outage: self.outage, ..*link };
        each.map(|(own, place)| Site::of(&link(own), &self.hearing, self.mean(place), spread)).collect()
    }

    /// What the margin of a link from `node` to a place depends on.
    fn seen(&self, node: Position, place: Position) -> SeenPlace {
        let distance_m = node.distance_m(place).max(NEAREST * self.law.distance_m);
        let way = place - node;
        let flat_m = (way.x_m * way.x_m + way.y_m * way.y_m).sqrt();
        let (cosine, sine) = if flat_m > 0.0 { (way.x_m / flat_m, way.y_m / flat_m) } else { (1.0, 0.0) };
        let direction = [cosine, sine, cosine * cosine - sine * sine, 2.0 * cosine * sine];
        let farther = libm::log(distance_m / self.law.distance_m);
        SeenPlace { place, distance_m, direction, farther }
    }

    fn mean(&self, seen: &SeenPlace) -> f64 {
        self.law.margin - self.law.slope * seen.farther
    }

    /// Variance of the shadowing that a link shares with no other.
    fn alone(&self) -> f64 {
        (1.0 - self.law.shared) * self.law.shadowing * self.law.shadowing
    }

    /// Covariances of the margin of a link to one place with those of links to `others`, without what each has alone.
    fn covariances(&self, first: &SeenPlace, others: &[SeenPlace]) -> Vec<f64> {
        let Law { shadowing, shared, correlation_m, offset, direction, .. } = self.law;
        let (together, slope) = (shared * shadowing * shadowing, self.law.slope_deviation());
        let exponent = |other: &SeenPlace| -first.place.distance_m(other.place) / correlation_m;
        let mut covariances: Vec<f64> = others.iter().map(exponent).collect();
        exp_each(&mut covariances);
        for (covariance, second) in covariances.iter_mut().zip(others) {
            let along: f64 = first.direction.iter().zip(&second.direction).map(|(a, b)| a * b).sum();
            let farther = slope * first.farther * slope * second.farther;
            *covariance = offset * offset + direction * direction * along + together * *covariance + farther;
        }
        covariances
    }

    /// Variance of a margin that comes from the error of the place.
    fn of_place(&self, placed: &Placed, other: &SeenPlace) -> f64 {
        let way: [f64; 3] = (other.place - placed.place).into();
        let distance_m = other.distance_m;
        let gradient = way.map(|along| self.law.slope * along / (distance_m * distance_m));
        let mut variance = 0.0;
        for (row, first) in gradient.iter().enumerate() {
            for (column, second) in gradient.iter().enumerate() {
                variance += first * second * placed.covariance[row][column];
            }
        }
        variance
    }
}

impl Predictor {
    /// The probability that `received` of `sent` packets arrive over a link with this margin.
    pub(crate) fn probability(&self, margin: &PredictedMargin, received: u32, sent: u32) -> f64 {
        let link = HeardLink { place: 0, received, sent, rssi_dbm: None, outage: self.outage };
        self.hearing.counts.losses().probability(&link, margin.mean, margin.variance.sqrt())
    }

    /// Density of the mean strength of the packets of a link with this margin that was received (1/dB); `None` if strengths are
    /// not used.
    pub(crate) fn strength_density(
        &self,
        margin: &PredictedMargin,
        [received, sent]: [u32; 2],
        rssi_dbm: f64,
    ) -> Option<f64> {
        let receiver = self.hearing.receiver.as_ref()?;
        let link = HeardLink { place: 0, received, sent, rssi_dbm: Some(rssi_dbm), outage: 0.0 };
        let (losses, deviation) = (self.hearing.counts.losses(), margin.variance.sqrt());
        Some(receiver.density(losses, &link, margin.mean, deviation))
    }
}
