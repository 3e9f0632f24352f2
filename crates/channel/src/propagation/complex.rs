//! Complex numbers, for fields: equal, bit for bit, on all platforms.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A complex number `re + j im`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    /// One.
    pub(crate) const ONE: Self = Self::real(1.0);

    /// A real number.
    pub(crate) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    /// The absolute value.
    pub(crate) fn abs(self) -> f64 {
        libm::hypot(self.re, self.im)
    }

    /// The angle from the real axis (rad), -π to π.
    pub(crate) fn arg(self) -> f64 {
        libm::atan2(self.im, self.re)
    }

    /// The root whose real part is not negative.
    pub(crate) fn sqrt(self) -> Self {
        let abs = self.abs();
        if abs <= 0.0 {
            return Self::real(0.0);
        }
        // Each part from the one that cancels no digits.
        if self.re >= 0.0 {
            let re = ((abs + self.re) / 2.0).sqrt();
            Self { re, im: self.im / (2.0 * re) }
        } else {
            let im = ((abs - self.re) / 2.0).sqrt().copysign(self.im);
            Self { re: self.im / (2.0 * im), im }
        }
    }

    /// The exponential function.
    pub(crate) fn exp(self) -> Self {
        let (sin, cos) = libm::sincos(self.im);
        Self { re: cos, im: sin } * Self::real(libm::exp(self.re))
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let square = other.re * other.re + other.im * other.im;
        let conjugate = Self { re: other.re, im: -other.im };
        let product = self * conjugate;
        Self { re: product.re / square, im: product.im / square }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_quotients_and_powers_are_inverses(re in -9.0..9.0_f64, im in -9.0..9.0_f64, turn in -3.0..3.0_f64) {
            let z = Complex { re, im };
            prop_assume!(z.abs() > 1e-3);
            let root = z.sqrt();
            prop_assert!(root.re >= 0.0 && (root * root - z).abs() < 1e-12 * z.abs());
            let other = Complex { re: im, im: 1.0 };
            prop_assert!((z * other / other - z).abs() < 1e-12 * z.abs());
            let unit = Complex { re: 0.0, im: turn }.exp();
            prop_assert!((unit.abs() - 1.0).abs() < 1e-12 && (unit.arg() - turn).abs() < 1e-12);
        }
    }
}
