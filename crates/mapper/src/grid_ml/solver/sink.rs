//! Receivers of likelihoods: a peak, moments, or a list.

use sextant_channel::Position;

use crate::lattice::Lattice;

/// Receives the log-likelihood of each vertex once, in any order.
pub(crate) trait Sink {
    /// Whether most vertices make no difference, so that it pays to bound their likelihoods first.
    const WANTS_FEW: bool;

    /// Whether only the vertices of highest likelihood matter, so that nothing depends on which of the others it gets.
    const WANTS_PEAK: bool = false;

    /// The vertex `index` at `place` has the finite log-likelihood `value`.
    fn take(&mut self, index: u64, place: Position, value: f64);

    /// The log-likelihood below which a vertex makes no difference any more.
    fn least(&self) -> f64;
}

/// The vertices of highest likelihood.
#[derive(Debug)]
pub(crate) struct Peak {
    highest: f64,
    vertices: Vec<(u64, f64)>,
}

impl Default for Peak {
    fn default() -> Self {
        Self { highest: f64::NEG_INFINITY, vertices: Vec::new() }
    }
}

impl Peak {
    /// How far below the highest log-likelihood a vertex counts as equal to it.
    pub(crate) const TOLERANCE: f64 = 1e-9;

    /// The highest log-likelihood, minus infinity if there is none.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// The vertices that share it, in the order of their indices.
    pub(crate) fn vertices(&self) -> &[(u64, f64)] {
        &self.vertices
    }
}

impl Sink for Peak {
    const WANTS_FEW: bool = true;
    const WANTS_PEAK: bool = true;

    fn take(&mut self, index: u64, _: Position, value: f64) {
        if value < self.highest - Self::TOLERANCE {
            return;
        }
        if value > self.highest {
            self.highest = value;
            self.vertices.retain(|&(_, other)| other >= value - Self::TOLERANCE);
        }
        let place = self.vertices.partition_point(|&(other, _)| other < index);
        self.vertices.insert(place, (index, value));
    }

    fn least(&self) -> f64 {
        self.highest - Self::TOLERANCE
    }
}

/// Mean and covariance of the vertices weighted by their likelihoods, under a uniform prior on the search set.
#[derive(Debug)]
pub(crate) struct Moments {
    /// The place from which offsets are measured, which keeps the sums small.
    reference: Option<Position>,
    fallback: Position,
    highest: f64,
    weight: f64,
    sum: [f64; 3],
    /// xx, yy, zz, xy, xz, yz.
    products: [f64; 6],
}

impl Moments {
    /// A vertex this far below the highest log-likelihood is left out: even 10⁹ such vertices have a weight of 10⁻¹⁷.
    pub(crate) const NEGLIGIBLE: f64 = 60.0;

    pub(crate) fn new(lattice: &Lattice) -> Self {
        Self {
            reference: None,
            fallback: lattice.origin(),
            highest: f64::NEG_INFINITY,
            weight: 0.0,
            sum: [0.0; 3],
            products: [0.0; 6],
        }
    }

    /// The logarithm of the sum of all likelihoods.
    pub(crate) fn ln_sum(&self) -> f64 {
        self.highest + libm::log(self.weight)
    }

    pub(crate) fn mean(&self) -> Position {
        let [x, y, z] = self.sum.map(|sum| sum / self.weight);
        self.reference.unwrap_or(self.fallback) + Position::new(x, y, z)
    }

    pub(crate) fn covariance(&self) -> [[f64; 3]; 3] {
        let [x, y, z] = self.sum.map(|sum| sum / self.weight);
        let [xx, yy, zz, xy, xz, yz] = self.products.map(|sum| sum / self.weight);
        let (xy, xz, yz) = (xy - x * y, xz - x * z, yz - y * z);
        [[(xx - x * x).max(0.0), xy, xz], [xy, (yy - y * y).max(0.0), yz], [xz, yz, (zz - z * z).max(0.0)]]
    }
}

impl Sink for Moments {
    const WANTS_FEW: bool = false;

    fn take(&mut self, _: u64, place: Position, value: f64) {
        let reference = *self.reference.get_or_insert(place);
        if value > self.highest {
            // Weights are relative to the highest likelihood so far.
            let fade = libm::exp(self.highest - value);
            self.weight *= fade;
            self.sum = self.sum.map(|sum| sum * fade);
            self.products = self.products.map(|sum| sum * fade);
            self.highest = value;
        }
        let weight = libm::exp(value - self.highest);
        let [x, y, z]: [f64; 3] = (place - reference).into();
        self.weight += weight;
        for (sum, term) in self.sum.iter_mut().zip([x, y, z]) {
            *sum += weight * term;
        }
        for (sum, term) in self.products.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
            *sum += weight * term;
        }
    }

    fn least(&self) -> f64 {
        self.highest - Self::NEGLIGIBLE
    }
}

/// The vertices within a margin below the highest likelihood.
#[derive(Debug)]
pub(crate) struct Contenders {
    margin: f64,
    highest: f64,
    vertices: Vec<(u64, f64)>,
    /// Number of vertices at which those that fell behind are dropped.
    full: usize,
}

impl Contenders {
    pub(crate) fn within(margin: f64) -> Self {
        Self { margin, highest: f64::NEG_INFINITY, vertices: Vec::new(), full: 4096 }
    }

    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// The vertices with their log-likelihoods, in the order of their indices.
    pub(crate) fn into_vertices(mut self) -> Vec<(u64, f64)> {
        self.drop_behind();
        self.vertices.sort_unstable_by_key(|&(index, _)| index);
        self.vertices
    }

    fn drop_behind(&mut self) {
        let least = self.least();
        self.vertices.retain(|&(_, value)| value >= least);
    }
}

impl Sink for Contenders {
    const WANTS_FEW: bool = false;

    fn take(&mut self, index: u64, _: Position, value: f64) {
        self.highest = self.highest.max(value);
        if value >= self.least() {
            self.vertices.push((index, value));
            if self.vertices.len() >= self.full {
                self.drop_behind();
                self.full = (2 * self.vertices.len()).max(self.full);
            }
        }
    }

    fn least(&self) -> f64 {
        self.highest - self.margin
    }
}

impl<A: Sink, B: Sink> Sink for (A, B) {
    const WANTS_FEW: bool = A::WANTS_FEW && B::WANTS_FEW;

    fn take(&mut self, index: u64, place: Position, value: f64) {
        self.0.take(index, place, value);
        self.1.take(index, place, value);
    }

    fn least(&self) -> f64 {
        self.0.least().min(self.1.least())
    }
}

impl Sink for Vec<(u64, f64)> {
    const WANTS_FEW: bool = false;

    fn take(&mut self, index: u64, _: Position, value: f64) {
        self.push((index, value));
    }

    fn least(&self) -> f64 {
        f64::NEG_INFINITY
    }
}
