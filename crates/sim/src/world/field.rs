//! Scalar fields: quantities such as a temperature or a concentration, which have a value at each place and time.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::{SettingError, SimTime};

use crate::station::check_name;

/// A scalar field, as written in a scenario: the sum of its sources.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FieldConfig {
    /// Name, also used in its topic of the recording; no other field has it.
    pub name: String,
    /// The sources: at least one.
    pub gaussians: Vec<GaussianConfig>,
}

/// A source of a field, as written in a scenario: `peak exp(-d² / (2 sigma²))` at the distance d from its centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GaussianConfig {
    /// Its centre (m).
    pub center_m: Position,
    /// Value at the centre, in the unit of the field; negative for a sink.
    pub peak: f64,
    /// Distance from the centre at which the value is 0.61 of the peak (m).
    pub sigma_m: f64,
    /// When it appears (s).
    #[serde(default)]
    pub appears_s: f64,
    /// When it is removed (s), if no application removes it before; it is not removed by itself if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed_s: Option<f64>,
    /// What remains of it after it was removed; nothing if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fades: Option<FadeConfig>,
}

/// What remains of a source after it was removed, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FadeConfig {
    /// All of it for this time, then nothing (s).
    LingersS(f64),
    /// It decays exponentially with this time constant (s).
    TimeConstantS(f64),
}

/// A scalar field.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    name: String,
    gaussians: Vec<Gaussian>,
}

/// A source of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    center: Position,
    peak: f64,
    sigma_m: f64,
    appears: SimTime,
    removed: Option<SimTime>,
    fade: Fade,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fade {
    Lingers(Duration),
    TimeConstant(Duration),
}

impl TryFrom<&FieldConfig> for Field {
    type Error = SettingError;

    fn try_from(config: &FieldConfig) -> Result<Self, SettingError> {
        check_name(&config.name)?;
        if config.gaussians.is_empty() {
            return Err(SettingError::new("gaussians", "an empty list", "at least one source"));
        }
        let gaussian = |(i, config): (usize, &GaussianConfig)| {
            Gaussian::try_from(*config).map_err(|error| error.within(format!("gaussians[{i}]")))
        };
        let gaussians = config.gaussians.iter().enumerate().map(gaussian).collect::<Result<_, _>>()?;
        Ok(Self { name: config.name.clone(), gaussians })
    }
}

/// The longest time of a source (s).
const LONGEST_S: f64 = 1e9;

impl TryFrom<GaussianConfig> for Gaussian {
    type Error = SettingError;

    fn try_from(config: GaussianConfig) -> Result<Self, SettingError> {
        let GaussianConfig { center_m, peak, sigma_m, appears_s, removed_s, fades } = config;
        if !center_m.is_finite() {
            let [x, y, z] = center_m.into();
            return Err(SettingError::new("center_m", format!("[{x}, {y}, {z}]"), "finite coordinates in metres"));
        }
        let span = |key, seconds: f64, least_s: f64| {
            SettingError::in_range(key, seconds, least_s, LONGEST_S).map(Duration::from_secs_f64)
        };
        let appears = SimTime::ZERO + span("appears_s", appears_s, 0.0)?;
        let removed = removed_s.map(|removed_s| span("removed_s", removed_s, appears_s)).transpose()?;
        Ok(Self {
            center: center_m,
            peak: SettingError::finite("peak", peak)?,
            sigma_m: SettingError::positive("sigma_m", sigma_m)?,
            appears,
            removed: removed.map(|removed| SimTime::ZERO + removed),
            fade: match fades {
                None => Fade::Lingers(Duration::ZERO),
                Some(FadeConfig::LingersS(seconds)) => Fade::Lingers(span("fades.lingers_s", seconds, 0.0)?),
                Some(FadeConfig::TimeConstantS(seconds)) => {
                    Fade::TimeConstant(span("fades.time_constant_s", seconds, 1e-9)?)
                }
            },
        })
    }
}

impl Field {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sources.
    #[must_use]
    pub fn gaussians(&self) -> &[Gaussian] {
        &self.gaussians
    }

    /// The value at `place` and `time`: the sum over the sources (thesis, section 7.4, "field distribution function").
    #[must_use]
    pub fn value(&self, place: Position, time: SimTime) -> f64 {
        self.gaussians.iter().map(|gaussian| gaussian.value(place, time)).sum()
    }

    /// The gradient at `place` and `time`: x, y and z, in the unit of the field per metre.
    #[must_use]
    pub fn gradient(&self, place: Position, time: SimTime) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for gaussian in &self.gaussians {
            for (sum, slope) in sum.iter_mut().zip(gaussian.gradient(place, time)) {
                *sum += slope;
            }
        }
        sum
    }

    /// The value at `place` if all sources are there at once, each with its whole peak: what the signal-to-noise
    /// ratio of sensors refers to.
    #[must_use]
    pub fn full_value(&self, place: Position) -> f64 {
        self.gaussians.iter().map(|gaussian| gaussian.peak * gaussian.share(place)).sum()
    }

    /// Removes the source number `source` at `time`.
    ///
    /// # Panics
    /// If there is no such source.
    pub fn remove(&mut self, source: usize, time: SimTime) {
        let gaussian = &mut self.gaussians[source];
        if gaussian.is_active(time) {
            gaussian.removed = Some(time);
        }
    }
}

impl Gaussian {
    /// Its value at the centre, in the unit of the field.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// Its centre (m).
    #[must_use]
    pub fn center(&self) -> Position {
        self.center
    }

    /// Whether it has appeared and has not been removed.
    #[must_use]
    pub fn is_active(&self, time: SimTime) -> bool {
        time >= self.appears && self.removed.is_none_or(|removed| time < removed)
    }

    /// `exp(-d² / (2 sigma²))` at the distance d from the centre. The thesis writes `exp(-d² / w)` (section 7.4):
    /// w = 2 sigma².
    fn share(&self, place: Position) -> f64 {
        let step = place - self.center;
        libm::exp(-0.5 * step.dot(step) / (self.sigma_m * self.sigma_m))
    }

    /// What there is of it at `time`: 0 to 1.
    fn strength(&self, time: SimTime) -> f64 {
        if time < self.appears {
            return 0.0;
        }
        let Some(removed) = self.removed.filter(|&removed| time >= removed) else { return 1.0 };
        let since = time - removed;
        match self.fade {
            Fade::Lingers(span) => f64::from(u8::from(since < span)),
            Fade::TimeConstant(span) => libm::exp(-since.as_secs_f64() / span.as_secs_f64()),
        }
    }

    fn value(&self, place: Position, time: SimTime) -> f64 {
        self.peak * self.strength(time) * self.share(place)
    }

    /// The derivative of the value: `-value (place - center) / sigma²`.
    fn gradient(&self, place: Position, time: SimTime) -> [f64; 3] {
        let per_m = -self.value(place, time) / (self.sigma_m * self.sigma_m);
        ((place - self.center) * per_m).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PLAIN: GaussianConfig = GaussianConfig {
        center_m: Position::ORIGIN,
        peak: 10.0,
        sigma_m: 2.0,
        appears_s: 0.0,
        removed_s: None,
        fades: None,
    };

    fn field(gaussians: &[GaussianConfig]) -> Field {
        Field::try_from(&FieldConfig { name: "gas".into(), gaussians: gaussians.into() }).unwrap()
    }

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    #[test]
    fn the_field_of_the_thesis_has_the_values_of_its_formula() {
        // 10 exp(-((x-40)² + (y-38)²) / 300) + 10 exp(-((x-10)² + (y-18)²) / 200)
        let source = |x, y, width: f64| GaussianConfig {
            center_m: Position::new(x, y, 0.0),
            sigma_m: (width / 2.0).sqrt(),
            ..PLAIN
        };
        let field = field(&[source(40.0, 38.0, 300.0), source(10.0, 18.0, 200.0)]);
        for (x, y) in [(40.0, 38.0), (10.0, 18.0), (25.0, 28.0), (0.0, 60.0)] {
            let square = |a: f64, b: f64| (x - a) * (x - a) + (y - b) * (y - b);
            let expected =
                10.0 * (-square(40.0, 38.0) / 300.0_f64).exp() + 10.0 * (-square(10.0, 18.0) / 200.0_f64).exp();
            let place = Position::new(x, y, 0.0);
            assert!((field.value(place, at(3.0)) - expected).abs() < 1e-12);
            assert!((field.full_value(place) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_source_appears_is_removed_and_fades() {
        let place = Position::ORIGIN;
        let source = GaussianConfig { appears_s: 5.0, removed_s: Some(20.0), ..PLAIN };
        let strengths = |fades, times: &[f64]| {
            let field = field(&[GaussianConfig { fades, ..source }]);
            times.iter().map(|&time| field.value(place, at(time)) / 10.0).collect::<Vec<_>>()
        };
        assert_eq!(strengths(None, &[4.999, 5.0, 19.999, 20.0]), [0.0, 1.0, 1.0, 0.0]);
        let lingers = Some(FadeConfig::LingersS(8.0));
        assert_eq!(strengths(lingers, &[20.0, 27.999, 28.0]), [1.0, 1.0, 0.0]);
        let faded = strengths(Some(FadeConfig::TimeConstantS(4.0)), &[20.0, 24.0, 28.0]);
        for (found, expected) in faded.into_iter().zip([1.0, (-1.0_f64).exp(), (-2.0_f64).exp()]) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_source_is_removed_once_and_the_others_stay() {
        let other = GaussianConfig { center_m: Position::new(30.0, 0.0, 0.0), peak: -3.0, ..PLAIN };
        let mut field = field(&[PLAIN, other]);
        let before = field.value(Position::ORIGIN, at(7.0));
        field.remove(0, at(7.0));
        field.remove(0, at(9.0));
        assert!((field.value(Position::ORIGIN, at(6.9)) - before).abs() < 1e-12, "the past does not change");
        assert!(field.value(Position::ORIGIN, at(7.0)).abs() < 1e-12);
        assert!((field.value(Position::new(30.0, 0.0, 0.0), at(7.0)) + 3.0).abs() < 1e-12);
        assert_eq!([0, 1].map(|source| field.gaussians()[source].is_active(at(8.0))), [false, true]);
    }

    #[test]
    fn a_source_that_has_not_appeared_cannot_be_removed() {
        let mut field = field(&[GaussianConfig { appears_s: 5.0, ..PLAIN }]);
        field.remove(0, at(2.0));
        assert!((field.value(Position::ORIGIN, at(6.0)) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn invalid_sources_are_rejected_with_their_key() {
        let key = |config: GaussianConfig| {
            Field::try_from(&FieldConfig { name: "gas".into(), gaussians: vec![PLAIN, config] }).unwrap_err().key
        };
        assert_eq!(key(GaussianConfig { sigma_m: -1.0, ..PLAIN }), "gaussians[1].sigma_m");
        assert_eq!(key(GaussianConfig { peak: f64::NAN, ..PLAIN }), "gaussians[1].peak");
        assert_eq!(key(GaussianConfig { appears_s: -1.0, ..PLAIN }), "gaussians[1].appears_s");
        assert_eq!(key(GaussianConfig { appears_s: 3.0, removed_s: Some(2.0), ..PLAIN }), "gaussians[1].removed_s");
        let fades = Some(FadeConfig::TimeConstantS(0.0));
        assert_eq!(key(GaussianConfig { fades, ..PLAIN }), "gaussians[1].fades.time_constant_s");
        let center_m = Position::new(f64::NAN, 0.0, 0.0);
        assert_eq!(key(GaussianConfig { center_m, ..PLAIN }), "gaussians[1].center_m");
        let empty = FieldConfig { name: "gas".into(), gaussians: Vec::new() };
        assert_eq!(Field::try_from(&empty).unwrap_err().key, "gaussians");
        let unnamed = FieldConfig { name: "a b".into(), gaussians: vec![PLAIN] };
        assert_eq!(Field::try_from(&unnamed).unwrap_err().key, "name");
    }

    proptest! {
        #[test]
        fn the_gradient_is_that_of_finite_differences(
            sources in proptest::collection::vec(([-20.0..20.0, -20.0..20.0, -5.0..5.0_f64], -9.0..9.0_f64, 0.8..15.0_f64), 1..5),
            place in [-25.0..25.0, -25.0..25.0, -6.0..6.0_f64],
            seconds in 0.0..30.0_f64,
        ) {
            const STEP_M: f64 = 1e-4;
            let gaussians: Vec<_> = sources.into_iter().map(|(center, peak, sigma_m)| GaussianConfig {
                center_m: center.into(), peak, sigma_m, removed_s: Some(10.0),
                fades: Some(FadeConfig::TimeConstantS(7.0)), ..PLAIN
            }).collect();
            let (field, place, time) = (field(&gaussians), Position::from(place), at(seconds));
            let steps = [[STEP_M, 0.0, 0.0], [0.0, STEP_M, 0.0], [0.0, 0.0, STEP_M]].map(Position::from);
            for (slope, step) in field.gradient(place, time).into_iter().zip(steps) {
                let difference = field.value(place + step, time) - field.value(place - step, time);
                // Rounding 1e-15 / step, curvature of the third order step².
                prop_assert!((slope - difference / (2.0 * STEP_M)).abs() < 1e-6, "{slope} {difference}");
            }
        }
    }
}
