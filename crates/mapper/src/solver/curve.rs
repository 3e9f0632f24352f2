//! The reception profile in the form that the inner loop wants.

use super::evidence::Evidence;
use crate::ReceptionProfile;
use crate::profile::DEFAULT_FLOOR;

/// `S(d) = clamp(slope (R − d), floor, top)`: the trapezoid, with its plateau as a clamp.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    /// R [m].
    pub(crate) range_m: f64,
    /// R² [m²].
    pub(crate) range_squared: f64,
    slope: f64,
    top: f64,
    floor: f64,
    /// `ln(1 − floor)`: what a missed packet adds beyond R.
    pub(crate) ln_missed_afar: f64,
    /// Factors that can be multiplied before the product may leave the range of f64.
    pub(crate) chunk: usize,
}

impl Curve {
    pub(crate) fn new(profile: &ReceptionProfile) -> Self {
        let ReceptionProfile::Trapezoid(s) = profile;
        let slope = s.p0() / (s.range_m() - s.plateau_m());
        Self::with(s.range_m(), slope, s.p0().min(s.ceiling()), s.floor())
    }

    fn with(range_m: f64, slope: f64, top: f64, floor: f64) -> Self {
        // A factor is zero, or at least the floor, or at least one rounding step of `slope (R − d)` or `1 − S`.
        let least = floor.max(1e-17 * top.min(1.0 - top).max(1e-3 * top));
        let chunk = crate::lattice::whole(270.0 / -libm::log10(least)).clamp(1, 64);
        let ln_missed_afar = libm::log1p(-floor);
        Self { range_m, range_squared: range_m * range_m, slope, top, floor, ln_missed_afar, chunk }
    }

    /// The same curve with every outcome possible everywhere.
    pub(crate) fn clamped(&self) -> Self {
        let top = self.top.min(1.0 - DEFAULT_FLOOR);
        let floor = self.floor.max(DEFAULT_FLOOR.min(0.5 * top));
        Self::with(self.range_m, self.slope, top, floor)
    }

    /// S at a squared distance [m²].
    #[inline(always)]
    pub(crate) fn at(&self, distance_squared: f64) -> f64 {
        let s = (self.range_m - distance_squared.sqrt()) * self.slope;
        let s = if s < self.top { s } else { self.top };
        if s > self.floor { s } else { self.floor }
    }

    /// The most received packets that can come from beyond R at a vertex with at least the log-likelihood
    /// `least`: each of them costs `ln floor`, each other one at least `ln top`, and no vertex misses better than
    /// from afar. At most all packets but one.
    pub(crate) fn most_outliers(&self, evidence: &Evidence, least: f64) -> u64 {
        let (ln_top, ln_floor) = (libm::log(self.top), libm::log(self.floor));
        #[expect(clippy::cast_precision_loss, reason = "packet counts are far below 2^53")]
        let (heard, missed) = (evidence.heard_packets() as f64, evidence.missed_packets() as f64);
        let best = heard * ln_top + missed * self.ln_missed_afar;
        let outliers = (best - least) / (ln_top - ln_floor) + 1e-6;
        (crate::lattice::whole(outliers) as u64).min(evidence.heard_packets() - 1)
    }
}
