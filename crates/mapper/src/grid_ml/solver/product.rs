//! Products of many factors in single precision that do not underflow.

use wide::f32x4;

use super::places::LANES;

/// Factors, each at least [`LEAST`] and at most about 1, whose product is a normal number in single precision.
pub(super) const GROUP: usize = 4;

/// Groups whose product is a normal number in double precision.
pub(super) const GROUPS: usize = 8;

/// Lowest factor. Raising a factor keeps it an upper bound.
pub(super) const LEAST: f32 = 1e-9;

/// A running product by lanes: `mantissa · 2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneProduct {
    mantissa: [f64; LANES],
    exponent: i64,
}

impl Default for LaneProduct {
    fn default() -> Self {
        Self { mantissa: [1.0; LANES], exponent: 0 }
    }
}

impl LaneProduct {
    /// Multiplies by the product of a group. [`normalise`](Self::normalise) after [`GROUPS`] of them.
    #[inline(always)]
    pub(super) fn multiply(&mut self, group: f32x4) {
        for (mantissa, product) in self.mantissa.iter_mut().zip(group.to_array()) {
            *mantissa *= f64::from(product);
        }
    }

    /// Multiplies by a factor, the same in all lanes, to the power `times`.
    pub(super) fn raise(&mut self, factor: f32x4, times: u32) {
        let factor = f64::from(factor.to_array()[0].max(LEAST));
        for done in 0..times {
            self.mantissa[0] *= factor;
            if done % 16 == 15 {
                self.normalise();
            }
        }
        self.normalise();
    }

    /// Moves the powers of two of the mantissas, which are normal numbers, to the exponent.
    #[inline(always)]
    pub(super) fn normalise(&mut self) {
        for mantissa in &mut self.mantissa {
            let bits = mantissa.to_bits();
            self.exponent += (bits >> 52) as i64 - 1023;
            *mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52);
        }
    }

    /// All lanes in one.
    #[inline(always)]
    fn joined(mut self) -> Self {
        let [a, b, c, d] = self.mantissa;
        self.mantissa = [(a * b) * (c * d), 1.0, 1.0, 1.0];
        self.normalise();
        self
    }

    /// A number that grows with the product of all lanes: its binary logarithm, linear between powers of two.
    #[inline(always)]
    pub(super) fn key(self) -> f64 {
        let joined = self.joined();
        joined.exponent as f64 + (joined.mantissa[0] - 1.0)
    }

    /// The natural logarithm of the product of all lanes.
    pub(super) fn ln(self) -> f64 {
        let joined = self.joined();
        joined.exponent as f64 * std::f64::consts::LN_2 + libm::log(joined.mantissa[0])
    }
}
