//! Products of probabilities at a few vertices side by side.

use sextant_channel::Position;

use super::admission::Admission;
use super::curve::ReceptionCurve;
use super::evidence::{Count, PacketEvidence};
use super::receiver::ReceivingStop;
use super::soft::SoftSectors;
use super::wedges::{Coverage, Wedges};

/// Vertices scored side by side, so that the compiler fills the vector registers.
pub(super) const LANES: usize = 4;

/// Running products at a few vertices: `mantissa · 2^exponent · exp(logarithm)`, so that no product underflows.
/// A factor of zero is kept as a mantissa of zero.
pub(super) struct Lanes<'v> {
    x: &'v [f64; LANES],
    y: &'v [f64; LANES],
    z: &'v [f64; LANES],
    mantissa: [f64; LANES],
    exponent: [i64; LANES],
    logarithm: [f64; LANES],
}

impl<'v> Lanes<'v> {
    pub(super) fn new(x: &'v [f64; LANES], y: &'v [f64; LANES], z: &'v [f64; LANES]) -> Self {
        Self { x, y, z, mantissa: [1.0; LANES], exponent: [0; LANES], logarithm: [0.0; LANES] }
    }

    /// The vertex of a lane as seen from a place (m).
    fn apart(&self, place: Position, lane: usize) -> [f64; 3] {
        [self.x[lane] - place.x_m, self.y[lane] - place.y_m, self.z[lane] - place.z_m]
    }

    #[inline(always)]
    fn distance_squared(&self, place: Position, lane: usize) -> f64 {
        let (dx, dy, dz) = (self.x[lane] - place.x_m, self.y[lane] - place.y_m, self.z[lane] - place.z_m);
        dx * dx + dy * dy + dz * dz
    }

    /// Multiplies by the factors of the entries of the log.
    pub(super) fn multiply_entries(
        &mut self,
        curve: &ReceptionCurve,
        evidence: &PacketEvidence,
        coverage: Option<Coverage<'_>>,
        admission: Admission,
    ) {
        if admission == Admission::WithinAny {
            self.keep_near(evidence.receptions().iter().map(|receiver| receiver.place), curve.range_squared);
        }
        self.multiply(curve, &evidence.heard, |square| curve.at(square));
        for count in &evidence.counts {
            self.multiply_count(curve, count, coverage);
        }
    }

    /// Multiplies by the probabilities of the sectors that the node named. A sector that contradicts a vertex counts as a
    /// reception from beyond R already.
    pub(super) fn multiply_names(&mut self, evidence: &PacketEvidence, wedges: &Wedges, soft: &SoftSectors) {
        for &ReceivingStop { place, sector, .. } in evidence.receptions() {
            let Some(sector) = sector else { continue };
            for lane in 0..LANES {
                let apart = self.apart(place, lane);
                if wedges.admits(sector, apart) {
                    self.logarithm[lane] += soft.ln_probability(sector, apart);
                }
            }
        }
    }

    /// What a stop that heard nothing says of the vertex of a lane: the probability of a reception, that of a vertex
    /// beyond R where no sector points.
    fn heard_in_a_sector(&self, curve: &ReceptionCurve, coverage: Coverage<'_>, place: Position, lane: usize) -> f64 {
        let is_covered = coverage.covers(self.apart(place, lane));
        if is_covered { curve.at(self.distance_squared(place, lane)) } else { curve.floor }
    }

    /// Multiplies by the factors of stops that heard nothing, where sectors do not cover every direction.
    pub(super) fn multiply_silence(&mut self, curve: &ReceptionCurve, places: &[Position], coverage: Coverage<'_>) {
        for chunk in places.chunks(curve.chunk) {
            for &place in chunk {
                for lane in 0..LANES {
                    self.mantissa[lane] *= 1.0 - self.heard_in_a_sector(curve, coverage, place, lane);
                }
            }
            self.normalise();
        }
    }

    /// The same where sectors may be contradicted: a reception outside its sector counts as one from beyond R, and a
    /// vertex that contradicts all receptions is not in the search set.
    pub(super) fn multiply_sectors(&mut self, curve: &ReceptionCurve, evidence: &PacketEvidence, wedges: &Wedges) {
        let mut is_near = [false; LANES];
        for &ReceivingStop { place, packets, sector } in evidence.receptions() {
            let mut factors = [0.0; LANES];
            for lane in 0..LANES {
                let square = self.distance_squared(place, lane);
                let is_inside = sector.is_none_or(|sector| wedges.admits(sector, self.apart(place, lane)));
                factors[lane] = if is_inside { curve.at(square) } else { curve.floor };
                is_near[lane] |= is_inside && square < curve.range_squared;
            }
            self.raise(curve, factors, packets);
        }
        for count in evidence.counts.iter().filter(|count| count.missed > 0) {
            self.multiply_missed(curve, count, wedges.coverage());
        }
        for (mantissa, is_near) in self.mantissa.iter_mut().zip(is_near) {
            *mantissa = if is_near { *mantissa } else { 0.0 };
        }
    }

    /// Multiplies by `factor` of the squared distance to each of `places`.
    #[inline(always)]
    pub(super) fn multiply(&mut self, curve: &ReceptionCurve, places: &[Position], factor: impl Fn(f64) -> f64) {
        for chunk in places.chunks(curve.chunk) {
            let mut product = self.mantissa;
            for &place in chunk {
                for (lane, product) in product.iter_mut().enumerate() {
                    *product *= factor(self.distance_squared(place, lane));
                }
            }
            self.mantissa = product;
            self.normalise();
        }
    }

    /// Multiplies by the factors of a stop that received some packets and missed others.
    fn multiply_count(&mut self, curve: &ReceptionCurve, count: &Count, coverage: Option<Coverage<'_>>) {
        let mut received = [0.0; LANES];
        for (lane, s) in received.iter_mut().enumerate() {
            *s = curve.at(self.distance_squared(count.place, lane));
        }
        self.raise(curve, received, count.received);
        self.multiply_missed(curve, count, coverage);
    }

    /// Multiplies by the factors of the packets that a stop missed.
    fn multiply_missed(&mut self, curve: &ReceptionCurve, count: &Count, coverage: Option<Coverage<'_>>) {
        let coverage = coverage.filter(|_| count.received == 0);
        let mut missed = [0.0; LANES];
        for (lane, factor) in missed.iter_mut().enumerate() {
            *factor = 1.0
                - match coverage {
                    Some(coverage) => self.heard_in_a_sector(curve, coverage, count.place, lane),
                    None => curve.at(self.distance_squared(count.place, lane)),
                };
        }
        self.raise(curve, missed, count.missed);
    }

    /// Multiplies by `factors` to the power `times`.
    fn raise(&mut self, curve: &ReceptionCurve, factors: [f64; LANES], times: u32) {
        for (lane, factor) in factors.into_iter().enumerate() {
            if times as usize <= curve.chunk {
                for _ in 0..times {
                    self.mantissa[lane] *= factor;
                }
            } else if factor > 0.0 {
                self.logarithm[lane] += f64::from(times) * libm::log(factor);
            } else {
                self.mantissa[lane] = 0.0;
            }
        }
        self.normalise();
    }

    /// Sets the product to zero where none of `places` is within range.
    fn keep_near(&mut self, places: impl Iterator<Item = Position>, range_squared: f64) {
        let mut nearest = [f64::INFINITY; LANES];
        for place in places {
            for (lane, nearest) in nearest.iter_mut().enumerate() {
                let square = self.distance_squared(place, lane);
                *nearest = if square < *nearest { square } else { *nearest };
            }
        }
        for (mantissa, nearest) in self.mantissa.iter_mut().zip(nearest) {
            *mantissa = if nearest < range_squared { *mantissa } else { 0.0 };
        }
    }

    /// Moves the powers of two of the mantissas (normal numbers, or zero) to the exponents.
    #[inline(always)]
    fn normalise(&mut self) {
        const FRACTION: u64 = (1 << 52) - 1;
        const ONE: u64 = 1023 << 52;
        for (mantissa, exponent) in self.mantissa.iter_mut().zip(&mut self.exponent) {
            let bits = mantissa.to_bits();
            *exponent += (bits >> 52) as i64 - 1023;
            let fraction = f64::from_bits(bits & FRACTION | ONE);
            *mantissa = if *mantissa > 0.0 { fraction } else { 0.0 };
        }
    }

    pub(super) fn highest(&self) -> f64 {
        (0..LANES).map(|lane| self.log_likelihood(lane)).fold(f64::NEG_INFINITY, f64::max)
    }

    pub(super) fn log_likelihood(&self, lane: usize) -> f64 {
        if self.mantissa[lane] > 0.0 {
            let exponent = self.exponent[lane] as f64;
            libm::log(self.mantissa[lane]) + exponent * std::f64::consts::LN_2 + self.logarithm[lane]
        } else {
            f64::NEG_INFINITY
        }
    }
}
