//! Colours that can be distinguished with any colour vision and in black and white.

use plotters::style::RGBColor;

/// Text, frames and ticks.
pub(crate) const INK: RGBColor = RGBColor(0x26, 0x26, 0x26);
/// Secondary text.
pub(crate) const FAINT_INK: RGBColor = RGBColor(0x5a, 0x5a, 0x5a);
/// Lines of a grid behind curves.
pub(crate) const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
/// Background.
pub(crate) const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// The body of an obstacle.
pub(crate) const OBSTACLE: RGBColor = RGBColor(0xc9, 0xc9, 0xc9);
/// The outline of an obstacle.
pub(crate) const OBSTACLE_RIM: RGBColor = RGBColor(0x8a, 0x8a, 0x8a);
/// A line that is less visible than the points that it connects.
pub(crate) const THREAD: RGBColor = RGBColor(0x9a, 0x9a, 0x9a);
/// Important marks (vermillion of Okabe and Ito).
pub(crate) const ACCENT: RGBColor = RGBColor(0xd5, 0x5e, 0x00);

/// Colours of curves: Okabe and Ito, "Color Universal Design" (2008), without yellow, which is hard to see on white.
pub(crate) const CURVES: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x00, 0x00, 0x00),
];

/// The colour of the robot with this number, the same in all figures.
pub(crate) fn of_robot(number: usize) -> RGBColor {
    CURVES[(2 * number) % CURVES.len()]
}

/// The colour of the target with this number, which no robot has unless there are many.
pub(crate) fn of_target(number: usize) -> RGBColor {
    CURVES[(2 * number + 1) % CURVES.len()]
}

/// Dash patterns of curves: lengths of dashes and gaps (px).
pub(crate) const PATTERNS: [&[f64]; 4] = [&[], &[9.0, 4.0], &[2.5, 3.0], &[9.0, 3.0, 2.5, 3.0]];

/// Viridis (van der Walt and Smith, 2015) at equal steps, from bright to dark.
const VIRIDIS: [RGBColor; 9] = [
    RGBColor(0xfd, 0xe7, 0x25),
    RGBColor(0xad, 0xdc, 0x30),
    RGBColor(0x5e, 0xc9, 0x62),
    RGBColor(0x28, 0xae, 0x80),
    RGBColor(0x21, 0x91, 0x8c),
    RGBColor(0x2c, 0x72, 0x8e),
    RGBColor(0x3b, 0x52, 0x8b),
    RGBColor(0x47, 0x2d, 0x7b),
    RGBColor(0x44, 0x01, 0x54),
];

/// A colour for each number from 0 to 1; larger numbers are darker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ramp {
    /// For small marks on white: without the brightest part.
    Marks,
    /// For areas that touch each other.
    Areas,
}

impl Ramp {
    /// The colour of `share`, which is clamped to 0 to 1; NaN counts as 0.
    pub(crate) fn color(self, share: f64) -> RGBColor {
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        let brightest = match self {
            Self::Marks => 0.1,
            Self::Areas => 0.0,
        };
        let at = (brightest + (1.0 - brightest) * share) * 8.0;
        let lower = (0..8_u8).rev().find(|&i| f64::from(i) <= at).unwrap_or(0);
        let weight = at - f64::from(lower);
        let (from, to) = (VIRIDIS[usize::from(lower)], VIRIDIS[usize::from(lower) + 1]);
        RGBColor(mixed(from.0, to.0, weight), mixed(from.1, to.1, weight), mixed(from.2, to.2, weight))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of octets is an octet")]
fn mixed(from: u8, to: u8, weight: f64) -> u8 {
    (f64::from(from) * (1.0 - weight) + f64::from(to) * weight).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, roughly.
    fn light(RGBColor(r, g, b): RGBColor) -> f64 {
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    }

    #[test]
    fn a_larger_number_is_darker() {
        for ramp in [Ramp::Marks, Ramp::Areas] {
            let shades: Vec<_> = (0..=100).map(|i| light(ramp.color(f64::from(i) / 100.0))).collect();
            assert!(shades.windows(2).all(|pair| pair[1] <= pair[0] + 0.5), "{shades:?}");
            assert!(shades[0] > shades[100] + 100.0);
        }
    }

    #[test]
    fn numbers_outside_the_range_are_clamped() {
        assert_eq!(Ramp::Areas.color(7.0), VIRIDIS[8]);
        assert_eq!(Ramp::Areas.color(f64::NAN), VIRIDIS[0]);
        assert_eq!(Ramp::Areas.color(-1.0), VIRIDIS[0]);
    }
}
