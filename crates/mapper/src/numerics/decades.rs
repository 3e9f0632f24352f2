//! A fast decadic logarithm of squares.

use std::f64::consts::LOG10_2;

/// Bits of the mantissa that name an entry of the table.
const BITS: u32 = 8;
/// Entries between a power of two and the next.
const ENTRIES: usize = 1 << BITS;

/// The decadic logarithm of a root by linear interpolation, exact to 10⁻⁶.
#[derive(Clone, Debug)]
pub(crate) struct Decades {
    /// Logarithms of the roots of mantissas from 1 to 2.
    values: Vec<f64>,
}

impl Decades {
    pub(crate) fn new() -> Self {
        let of = |entry: usize| 0.5 * libm::log10(1.0 + entry as f64 / ENTRIES as f64);
        Self { values: (0..=ENTRIES).map(of).collect() }
    }

    /// `lg √square` of a normal number above 0.
    #[inline]
    pub(crate) fn of_root(&self, square: f64) -> f64 {
        let bits = square.to_bits();
        let exponent = f64::from((bits >> 52) as u32) - 1023.0;
        let mantissa = bits & ((1 << 52) - 1);
        let entry = (mantissa >> (52 - BITS)) as usize;
        let share = (mantissa & ((1 << (52 - BITS)) - 1)) as f64 / (1_u64 << (52 - BITS)) as f64;
        let (low, high) = (self.values[entry], self.values[entry + 1]);
        0.5 * LOG10_2 * exponent + low + share * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_logarithm_of_the_root_to_a_millionth() {
        let decades = Decades::new();
        for i in 1..20_000_u32 {
            let square = libm::exp(f64::from(i) * 0.002 - 20.0);
            assert!((decades.of_root(square) - libm::log10(square.sqrt())).abs() < 1e-6, "{square}");
        }
    }
}
