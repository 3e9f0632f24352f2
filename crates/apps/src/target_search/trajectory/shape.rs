//! Curves through the turns of a target, along one axis.

use std::f64::consts::PI;

use super::CurveForm;
use super::legendre::LegendreSeries;

/// Relative change of a curve over the last places below which it tells nothing about them.
const FLAT: f64 = 1e-6;

/// A curve through turns, before it is fitted to places.
pub(super) enum Shape {
    /// The cosine of the phase between these turns (s).
    Waves(Vec<f64>),
    /// A series on the time from the first of its turns to the last (s).
    Series {
        /// The series.
        series: LegendreSeries,
        /// The first turn.
        first_s: f64,
        /// The last turn.
        last_s: f64,
    },
}

impl Shape {
    /// The curve of this form through the turns, which are in ascending order; `None` if there are fewer than two.
    pub(super) fn new(form: CurveForm, turns_s: Vec<f64>) -> Option<Self> {
        let [first_s, .., last_s] = turns_s[..] else { return None };
        let u = |t_s: f64| scaled(t_s, first_s, last_s);
        let product = || turns_s.iter().fold(LegendreSeries::one(), |product, &turn_s| product.times_root(u(turn_s)));
        Some(match form {
            CurveForm::Waves => Self::Waves(turns_s),
            CurveForm::Integral => Self::Series { series: product().integral(), first_s, last_s },
            CurveForm::Product => Self::Series { series: product(), first_s, last_s },
        })
    }

    /// The curve at `t_s`.
    fn at(&self, t_s: f64) -> f64 {
        match self {
            Self::Waves(turns_s) => {
                let after = turns_s.partition_point(|&turn_s| turn_s <= t_s).clamp(1, turns_s.len() - 1);
                let (before_s, after_s) = (turns_s[after - 1], turns_s[after]);
                let phase = (t_s - before_s) / (after_s - before_s);
                let sign = if after % 2 == 1 { 1.0 } else { -1.0 };
                sign * libm::cos(PI * phase)
            }
            Self::Series { series, first_s, last_s } => series.at(scaled(t_s, *first_s, *last_s)),
        }
    }

    /// a times the curve plus C at `t_s`, with the a and C of least squares to `places` (s, m); `None` if the curve
    /// hardly changes there.
    pub(super) fn fitted(&self, places: &[(f64, f64)], t_s: f64) -> Option<f64> {
        let count = places.len() as f64;
        let pairs: Vec<_> = places.iter().map(|&(t_s, place_m)| (self.at(t_s), place_m)).collect();
        let mean_shape = pairs.iter().map(|(shape, _)| shape).sum::<f64>() / count;
        let mean_m = pairs.iter().map(|(_, place_m)| place_m).sum::<f64>() / count;
        let squares: f64 = pairs.iter().map(|(shape, _)| (shape - mean_shape).powi(2)).sum();
        let most = pairs.iter().map(|(shape, _)| shape.abs()).fold(0.0, f64::max);
        if squares <= (FLAT * most).powi(2) {
            return None;
        }
        let a = pairs.iter().map(|(shape, place_m)| (shape - mean_shape) * (place_m - mean_m)).sum::<f64>() / squares;
        Some(mean_m + a * (self.at(t_s) - mean_shape))
    }
}

/// `t_s` on the scale on which `first_s` is -1 and `last_s` is 1.
fn scaled(t_s: f64, first_s: f64, last_s: f64) -> f64 {
    2.0 * (t_s - first_s) / (last_s - first_s) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURNS_S: [f64; 4] = [3.0, 9.0, 15.0, 24.0];

    fn shape(form: CurveForm) -> Shape {
        Shape::new(form, TURNS_S.to_vec()).expect("four turns")
    }

    fn velocity(shape: &Shape, t_s: f64) -> f64 {
        (shape.at(t_s + 1e-4) - shape.at(t_s - 1e-4)) / 2e-4
    }

    #[test]
    fn the_velocity_is_zero_at_each_turn_and_nowhere_between() {
        for form in [CurveForm::Waves, CurveForm::Integral] {
            let shape = shape(form);
            for pair in TURNS_S.windows(2) {
                let fastest = velocity(&shape, 0.5 * (pair[0] + pair[1])).abs();
                assert!(velocity(&shape, pair[0]).abs() < 1e-3 * fastest, "{form:?} at {}", pair[0]);
                assert!(velocity(&shape, pair[1]).abs() < 1e-3 * fastest, "{form:?} at {}", pair[1]);
                let sign = velocity(&shape, pair[0] + 0.1).signum();
                for step in 1..20 {
                    let t_s = pair[0] + f64::from(step) / 20.0 * (pair[1] - pair[0]);
                    assert!(velocity(&shape, t_s) * sign > 0.0, "{form:?} at {t_s}");
                }
            }
        }
    }

    #[test]
    fn the_printed_product_has_the_same_place_at_all_turns_and_does_not_turn_there() {
        let product = shape(CurveForm::Product);
        let integral = shape(CurveForm::Integral);
        for turn_s in TURNS_S {
            assert!(product.at(turn_s).abs() < 1e-14);
            assert!(velocity(&product, turn_s).abs() > 0.01);
        }
        assert!((integral.at(TURNS_S[0]) - integral.at(TURNS_S[1])).abs() > 0.01);
    }

    #[test]
    fn a_target_on_the_integral_curve_is_predicted_exactly() {
        // x' = (t - 3) (t - 9) (t - 15) / 50, known from 10 s to 12 s.
        let x = |t: f64| (t.powi(4) / 4.0 - 9.0 * t.powi(3) + 207.0 * t * t / 2.0 - 405.0 * t) / 50.0 + 7.0;
        let shape = Shape::new(CurveForm::Integral, vec![3.0, 9.0, 15.0]).expect("three turns");
        let places = [10.0, 11.0, 12.0].map(|t_s| (t_s, x(t_s)));
        for t_s in [13.0, 15.0, 16.5] {
            let found = shape.fitted(&places, t_s).expect("a curve");
            assert!((found - x(t_s)).abs() < 1e-10, "{found} for {}", x(t_s));
        }
    }

    #[test]
    fn a_target_on_waves_is_predicted_exactly_past_uneven_turns() {
        let x = |phase: f64| 2.0 - 3.0 * libm::cos(PI * phase);
        let places = [(10.5, x(1.25)), (12.0, x(1.5)), (13.5, x(1.75))];
        let waves = shape(CurveForm::Waves);
        for (t_s, phase) in [(4.5, 0.25), (15.0, 2.0), (19.5, 2.5), (24.0, 3.0), (28.5, 3.5)] {
            let found = waves.fitted(&places, t_s).expect("a curve");
            assert!((found - x(phase)).abs() < 1e-12, "{found} for {} at {t_s}", x(phase));
        }
    }

    #[test]
    fn a_curve_that_is_level_over_the_places_tells_nothing() {
        assert!(shape(CurveForm::Waves).fitted(&[(9.0, 1.0), (9.0, 2.0), (9.0, 3.0)], 12.0).is_none());
        assert!(Shape::new(CurveForm::Waves, vec![1.0]).is_none());
    }
}
