//! What a law says of links that were not heard yet.

use nalgebra::{DMatrix, DVector};
use sextant_channel::{Position, ReceptionLog};

use super::hearing::Hearing;
use super::law::Law;
use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::site::Site;
use super::{LinkFit, posterior};

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
        let known: Vec<Position> = links.links.iter().map(|link| self.links.places[link.place]).collect();
        let sites = self.sites(links, placed.place, &known);
        let covariance = DMatrix::from_fn(known.len(), known.len(), |i, j| {
            self.covariance(placed.place, known[i], known[j])
                + if i == j { self.alone() + sites[i].variance } else { 0.0 }
        });
        let errors = DVector::from_fn(known.len(), |i, _| sites[i].margin - self.mean(placed.place, known[i]));
        let factor = covariance.cholesky()?;
        let weights = factor.solve(&errors);
        let predicted = others.iter().map(|&other| {
            let with = DVector::from_fn(known.len(), |i, _| self.covariance(placed.place, known[i], other));
            let mean = self.mean(placed.place, other) + with.dot(&weights);
            let own = self.covariance(placed.place, other, other) + self.alone();
            let variance = own - with.dot(&factor.solve(&with)) + self.of_place(placed, other);
            PredictedMargin { mean, variance: variance.max(1e-6) }
        });
        Some(predicted.collect())
    }

    /// The links as normal distributions of margins, round what the place tells.
    fn sites(&self, links: &NodeLinks, place: Position, known: &[Position]) -> Vec<Site> {
        let spread = self.law.spread().max(posterior::LEAST_SPREAD);
        let each = links.links.iter().zip(known);
        let link = |link: &HeardLink| HeardLink { outage: self.outage, ..*link };
        each.map(|(own, &other)| Site::of(&link(own), &self.hearing, self.mean(place, other), spread)).collect()
    }

    fn mean(&self, place: Position, other: Position) -> f64 {
        self.law.at_one_metre() - self.law.slope * libm::log(self.distance_m(place, other))
    }

    fn distance_m(&self, place: Position, other: Position) -> f64 {
        place.distance_m(other).max(NEAREST * self.law.distance_m)
    }

    /// Variance of the shadowing that a link shares with no other.
    fn alone(&self) -> f64 {
        (1.0 - self.law.shared) * self.law.shadowing * self.law.shadowing
    }

    /// Covariance of the margins of links from `place` to two others, without what each has alone.
    fn covariance(&self, place: Position, first: Position, second: Position) -> f64 {
        let Law { shadowing, shared, correlation_m, offset, direction, distance_m, .. } = self.law;
        let [a, b] = [first, second].map(|other| libm::atan2(other.y_m - place.y_m, other.x_m - place.x_m));
        let along = libm::cos(a - b) + libm::cos(2.0 * (a - b));
        let together = shared * shadowing * shadowing * libm::exp(-first.distance_m(second) / correlation_m);
        let farther = |other| self.law.slope_deviation() * libm::log(self.distance_m(place, other) / distance_m);
        offset * offset + direction * direction * along + together + farther(first) * farther(second)
    }

    /// Variance of a margin that comes from the error of the place.
    fn of_place(&self, placed: &Placed, other: Position) -> f64 {
        let way: [f64; 3] = (other - placed.place).into();
        let distance_m = self.distance_m(placed.place, other);
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
