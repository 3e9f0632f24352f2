//! The reception profile in the form for the inner loop.

use super::evidence::PacketEvidence;
use super::single::single;
use crate::profile::{DEFAULT_FLOOR, ReceptionProfile};

/// `S(d) = clamp(s(d), floor, top)` with the trapezoid `s(d) = slope (R − d)`, its plateau being a clamp, or the
/// table `s(d)` of a profile.
#[derive(Clone, Debug)]
pub(crate) struct ReceptionCurve {
    /// R (m).
    pub(crate) range_m: f64,
    /// R² (m²).
    pub(crate) range_squared: f64,
    pub(super) slope: f64,
    pub(super) top: f64,
    pub(super) floor: f64,
    /// Values at equal distances with the increments to the next; empty for a trapezoid.
    table: Vec<[f64; 2]>,
    /// The same in single precision.
    pub(super) table_single: Vec<[f32; 2]>,
    /// Highest slope of the table, up or down (1/m).
    pub(super) steepest_per_m: f64,
    /// Distance of neighbouring values of the table (m).
    pub(super) step_m: f64,
    /// `ln(1 − floor)`: what a missed packet adds beyond R.
    pub(crate) ln_missed_afar: f64,
    /// Factors that can be multiplied before the product may leave the range of f64.
    pub(crate) chunk: usize,
}

impl ReceptionCurve {
    pub(crate) fn new(profile: &ReceptionProfile) -> Self {
        match profile {
            ReceptionProfile::Trapezoid(s) => {
                let slope = s.p0() / (s.range_m() - s.plateau_m());
                Self::with(s.range_m(), slope, s.p0().min(s.ceiling()), s.floor())
            }
            ReceptionProfile::Table(s) => {
                let values = s.probabilities();
                let top = values.iter().fold(0.0, |top: f64, &s| top.max(s)).min(s.ceiling());
                let table = values.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]).collect();
                Self::with(s.range_m(), 0.0, top, s.floor()).of_table(table, s.step_m())
            }
        }
    }

    fn with(range_m: f64, slope: f64, top: f64, floor: f64) -> Self {
        // A factor is zero, or at least the clamp, or at least one rounding step of `slope (R − d)` or `1 − S`.
        let least = floor.max(1e-17 * top).min((1.0 - top).max(1e-17));
        let chunk = crate::numerics::whole(270.0 / -libm::log10(least)).clamp(1, 64);
        let ln_missed_afar = libm::log1p(-floor);
        let range_squared = range_m * range_m;
        Self {
            range_m,
            range_squared,
            slope,
            top,
            floor,
            table: Vec::new(),
            table_single: Vec::new(),
            steepest_per_m: 0.0,
            step_m: 1.0,
            ln_missed_afar,
            chunk,
        }
    }

    fn of_table(self, table: Vec<[f64; 2]>, step_m: f64) -> Self {
        // Between a value of the table and zero lies at least a rounding step of the value.
        let chunk = if self.floor > 0.0 { self.chunk } else { self.chunk.min(5) };
        let table_single = table.iter().map(|pair| pair.map(single)).collect();
        let steepest = table.iter().fold(0.0, |most: f64, [_, increment]| most.max(increment.abs()));
        Self { table, table_single, steepest_per_m: steepest / step_m, step_m, chunk, ..self }
    }

    /// The same curve, clamped so that every outcome is possible everywhere.
    pub(crate) fn clamped(&self) -> Self {
        let top = self.top.min(1.0 - DEFAULT_FLOOR);
        let floor = self.floor.max(DEFAULT_FLOOR.min(0.5 * top));
        let table = self.table.clone();
        Self::with(self.range_m, self.slope, top, floor).of_table(table, self.step_m)
    }

    /// Whether the profile is a table.
    pub(crate) fn is_table(&self) -> bool {
        !self.table.is_empty()
    }

    /// S at a squared distance (m²).
    #[inline(always)]
    pub(crate) fn at(&self, distance_squared: f64) -> f64 {
        let d = distance_squared.sqrt();
        let s = if self.table.is_empty() { (self.range_m - d) * self.slope } else { self.interpolated(d) };
        let s = if s < self.top { s } else { self.top };
        if s > self.floor { s } else { self.floor }
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "an index of a table")]
    #[expect(clippy::cast_sign_loss, reason = "distances are not negative")]
    fn interpolated(&self, d: f64) -> f64 {
        // The result equals that of the profile to the last bit, so that a probability of 0 or 1 is 0 or 1 here too.
        let along = d / self.step_m;
        let below = (along as usize).min(self.table.len() - 1);
        let [value, increment] = self.table[below];
        if d < self.range_m { value + increment * (along - below as f64) } else { 0.0 }
    }

    /// The most received packets that can come from beyond R at a vertex with at least the log-likelihood `least`:
    /// each of them costs `ln floor`, each other received packet at least `ln top`, and missed packets cost least far
    /// away. At most all packets but one.
    pub(crate) fn most_outliers(&self, evidence: &PacketEvidence, least: f64) -> u64 {
        let (ln_top, ln_floor) = (libm::log(self.top), libm::log(self.floor));
        let (heard, missed) = (evidence.heard_packets() as f64, evidence.missed_packets() as f64);
        let best = heard * ln_top + missed * self.ln_missed_afar;
        let outliers = (best - least) / (ln_top - ln_floor) + 1e-6;
        (crate::numerics::whole(outliers) as u64).min(evidence.heard_packets() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{ProfileConfig, TrapezoidConfig};

    #[test]
    fn a_chunk_of_the_smallest_factors_does_not_underflow() {
        for (p0, floor, ceiling) in
            [(1.0, 0.0, 1.0), (1.0, 0.3, 1.0), (0.5, 0.0, 0.9), (1e-9, 0.0, 1.0), (0.9, 1e-6, 1.0)]
        {
            let config = TrapezoidConfig { floor, ceiling, ..TrapezoidConfig::new(p0, 2.0, 10.0) };
            let profile = ReceptionProfile::try_from(ProfileConfig::Trapezoid(config)).unwrap();
            let curve = ReceptionCurve::new(&profile);
            let distances = [0.0, 2.0_f64.next_up(), 2.0, 10.0_f64.next_down(), 10.0];
            for s in distances.map(|d| curve.at(d * d)) {
                for factor in [s, 1.0 - s] {
                    let product = (0..curve.chunk).fold(1.0, |product, _| product * factor);
                    assert!(factor <= 0.0 || f64::is_normal(product), "{factor}^{} with {curve:?}", curve.chunk);
                }
            }
        }
    }
}
