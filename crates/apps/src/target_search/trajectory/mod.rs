//! The way of a target, continued from its turns ("behaviour formula extraction", Gunathillake 2018, section 6.3.2).
//!
//! Each axis for itself: the times at which the target turned are found in the filtered places. The target is taken to
//! turn again after the mean interval between turns, up to one turn past the time asked for. A curve whose velocity is
//! zero at all these times is fitted to the last filtered places, and is the prediction.
//!
//! An axis with fewer than two turns goes on as the filter says, at constant velocity, and so does one whose turns are
//! too irregular for the curve to have predicted the last places. No prediction is farther from
//! the last place than the target can go, or outside the field.
//!
//! The thesis finds the turns at the zeros of the derivative of a polynomial through all places, and its curve is a
//! polynomial in time too: [`TrajectorySettings::as_in_thesis`]. Such curves swing ever wider past their last data. The
//! waves of [`TrajectorySettings::new`] do not.

mod axis;
mod legendre;
mod shape;
mod turn;

use sextant_channel::{Bounds, Position};
use sextant_kernel::SimTime;

use self::axis::Axis;
use super::target_state::TargetState;
pub(crate) use turn::TurnTimes;

/// How the way of a target is continued.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrajectorySettings {
    /// How past turns are found.
    pub turn_times: TurnTimes,
    /// When the target turns next.
    pub next_turn: NextTurn,
    /// The curve through the turns.
    pub form: CurveForm,
    /// Which axes follow a curve.
    pub trust: Trust,
    /// Number of last filtered places to which the curve is fitted, 3 or more.
    pub fitted_places: usize,
    /// Largest speed of the target (m/s).
    pub max_speed_m_per_s: f64,
    /// Predictions stay within these bounds.
    pub field: Bounds,
}

impl TrajectorySettings {
    /// Waves through the extremes of the way, for a target of this speed in this field.
    #[must_use]
    pub(crate) fn new(max_speed_m_per_s: f64, field: Bounds) -> Self {
        Self {
            turn_times: TurnTimes::Extremes(1.0),
            next_turn: NextTurn::AfterLastTurn,
            form: CurveForm::Waves,
            trust: Trust::Proven,
            fitted_places: 5,
            max_speed_m_per_s,
            field,
        }
    }

    /// The polynomials of the thesis, with the integral that its text describes.
    #[must_use]
    pub(crate) fn as_in_thesis(max_speed_m_per_s: f64, field: Bounds) -> Self {
        Self {
            turn_times: TurnTimes::Polynomial { least_m: 1.0, most_degree: 8 },
            next_turn: NextTurn::AfterLastSample,
            form: CurveForm::Integral,
            trust: Trust::Always,
            fitted_places: 3,
            ..Self::new(max_speed_m_per_s, field)
        }
    }
}

/// When a target turns next. Further turns follow at the mean interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum NextTurn {
    /// One mean interval after its last turn. If that is more than half an interval before the last sample, the target
    /// has changed its ways, and it is taken to go straight on.
    #[default]
    AfterLastTurn,
    /// One mean interval after the last sample, as printed in the thesis.
    AfterLastSample,
}

/// The curve through the turns TD_i.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum CurveForm {
    /// a cos(πφ) + C, where the phase φ grows by one from turn to turn, at a constant rate between two turns.
    #[default]
    Waves,
    /// a ∫ Π(t - TD_i) dt + C: the polynomial whose velocity is zero at each turn, as the text of the thesis describes.
    Integral,
    /// a Π(t - TD_i) + C, as printed in the thesis. Its place is the same at all turns, and its velocity is not zero.
    Product,
}

/// Which axes follow a curve through their turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Trust {
    /// Those on which the curve would have predicted the last places with less than half of the squared error of
    /// constant velocity (hindcast).
    #[default]
    Proven,
    /// All that turned twice, as in the thesis.
    Always,
}

/// How a coordinate was predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxisForecast {
    /// By a curve through this many past and future turns.
    Curve {
        /// Turns of the target so far.
        past: usize,
        /// Turns that it is taken to make.
        future: usize,
    },
    /// At the velocity of the filter, because there are fewer than two turns.
    TooFewTurns,
    /// At the velocity of the filter, because the curve would not have predicted the last places clearly better.
    StraightIsBetter,
    /// At the velocity of the filter, because the target should have turned long ago.
    Overdue,
    /// At the velocity of the filter, because the curve hardly changes where the last places are.
    FlatCurve,
}

/// What a prediction was limited by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    /// Nothing.
    None,
    /// The speed of the target.
    Speed,
    /// The bounds of the field.
    Field,
    /// Both.
    SpeedAndField,
}

/// A predicted place, and how it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Forecast {
    /// The place (m).
    pub place: Position,
    /// How x, y and z were predicted.
    pub axes: [AxisForecast; 3],
    /// What they were limited by.
    pub limit: Limit,
}

/// The way of a target so far, ready for predictions.
#[derive(Clone, Debug)]
pub(crate) struct Trajectory {
    settings: TrajectorySettings,
    /// The instant from which times count: that of the first sample.
    origin: SimTime,
    last: SimTime,
    state: TargetState,
    axes: [Axis; 3],
}

impl Trajectory {
    /// The way through the `filtered` places, in order of time. `state` is what the filter says at the last of them.
    #[must_use]
    pub(crate) fn new(settings: TrajectorySettings, filtered: &[(SimTime, Position)], state: TargetState) -> Self {
        let instant = |sample: Option<&(SimTime, Position)>| sample.map_or(SimTime::ZERO, |&(time, _)| time);
        let (origin, last) = (instant(filtered.first()), instant(filtered.last()));
        let axis = |axis: usize| {
            let coordinate = |place: Position| <[f64; 3]>::from(place)[axis];
            let points: Vec<_> = (filtered.iter())
                .map(|&(time, place)| (time.saturating_since(origin).as_secs_f64(), coordinate(place)))
                .collect();
            Axis::new(&settings, &points, coordinate(state.place), coordinate(state.velocity_m_per_s))
        };
        Self { settings, origin, last, state, axes: [0, 1, 2].map(axis) }
    }

    /// Where the target is at `time`; for a time before the last sample, where it was at that sample.
    #[must_use]
    pub(crate) fn at(&self, time: SimTime) -> Forecast {
        let ahead_s = time.saturating_since(self.last).as_secs_f64();
        let last_s = self.last.saturating_since(self.origin).as_secs_f64();
        let forecasts = self.axes.each_ref().map(|axis| axis.forecast(last_s, ahead_s));
        let free = Position::from(forecasts.map(|(coordinate, _)| coordinate));
        let (way, most_m) = (free - self.state.place, self.settings.max_speed_m_per_s * ahead_s);
        let is_fast = way.length_m() > most_m;
        let reached = if is_fast { self.state.place + way * (most_m / way.length_m()) } else { free };
        let field = self.settings.field;
        let place = Position::new(
            reached.x_m.max(field.min.x_m).min(field.max.x_m),
            reached.y_m.max(field.min.y_m).min(field.max.y_m),
            reached.z_m.max(field.min.z_m).min(field.max.z_m),
        );
        let limit = match (is_fast, place != reached) {
            (false, false) => Limit::None,
            (true, false) => Limit::Speed,
            (false, true) => Limit::Field,
            (true, true) => Limit::SpeedAndField,
        };
        Forecast { place, axes: forecasts.map(|(_, forecast)| forecast), limit }
    }

    /// Times at which the target turned along x, y and z, in seconds after the first sample.
    #[cfg(test)]
    fn turns_s(&self) -> [&[f64]; 3] {
        self.axes.each_ref().map(Axis::turns_s)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::target_state::AxisCovariance;
    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    fn field() -> Bounds {
        Bounds { min: Position::new(-20.0, -20.0, 0.0), max: Position::new(20.0, 20.0, 0.0) }
    }

    /// The trajectory of a target that is at `x(t)` and y = `t`/4, sampled once a second until `end_s`.
    fn sampled(settings: TrajectorySettings, x: impl Fn(f64) -> f64, end_s: u32) -> Trajectory {
        let samples: Vec<_> =
            (0..=end_s).map(f64::from).map(|t_s| (at(t_s), Position::new(x(t_s), 0.25 * t_s, 0.0))).collect();
        let end_s = f64::from(end_s);
        let velocity_m_per_s = Position::new((x(end_s + 1e-6) - x(end_s - 1e-6)) / 2e-6, 0.25, 0.0);
        let covariance = AxisCovariance { place_m2: 1.0, cross_m2_per_s: 0.0, velocity_m2_per_s2: 1.0 };
        let place = samples[samples.len() - 1].1;
        Trajectory::new(settings, &samples, TargetState { place, velocity_m_per_s, covariance })
    }

    /// To and fro, 5 m to each side, with a turn each 11.3 s.
    fn sine(t_s: f64) -> f64 {
        5.0 * (std::f64::consts::PI * (t_s - 3.0) / 11.3).sin()
    }

    #[test]
    fn the_next_half_wave_of_a_target_that_goes_to_and_fro_is_predicted() {
        // The curve is good as soon as there are two turns, and proven after three.
        let ends = (24..=60).map(|end_s| (Trust::Always, end_s)).chain((44..=60).map(|end_s| (Trust::Proven, end_s)));
        for (trust, end_s) in ends {
            let trajectory =
                sampled(TrajectorySettings { trust, ..TrajectorySettings::new(2.0, field()) }, sine, end_s);
            for ahead_s in 1..=11 {
                let time_s = f64::from(end_s + ahead_s);
                let Forecast { place, axes, limit } = trajectory.at(at(time_s));
                assert!(matches!(axes[0], AxisForecast::Curve { .. }), "{axes:?} at {end_s} s");
                assert_eq!((axes[1], limit), (AxisForecast::TooFewTurns, Limit::None), "{end_s} {ahead_s}");
                let error_m = (place.x_m - sine(time_s)).abs();
                assert!(error_m < 0.5, "{error_m} m after {ahead_s} s from {end_s} s");
                assert!((place.y_m - 0.25 * time_s).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_target_that_turns_at_random_is_not_trusted_to_follow_its_curve() {
        // Turns after 4, 9, 3, 12, 5 and 10 seconds.
        let turns_s = [4.0, 13.0, 16.0, 28.0, 33.0, 43.0];
        let velocity =
            |t_s: f64| if turns_s.iter().filter(|&&turn_s| turn_s <= t_s).count() % 2 == 0 { 1.0 } else { -1.0 };
        let x =
            |t_s: f64| (0..1000).map(|i| velocity((f64::from(i) + 0.5) * t_s / 1000.0) * t_s / 1000.0).sum::<f64>();
        let settings = TrajectorySettings::new(2.0, field());
        let forecast = |trust| sampled(TrajectorySettings { trust, ..settings }, x, 40).at(at(42.0));
        assert_eq!(forecast(Trust::Proven).axes[0], AxisForecast::StraightIsBetter);
        assert!(matches!(forecast(Trust::Always).axes[0], AxisForecast::Curve { .. }));
        let error_m = |trust| (forecast(trust).place.x_m - x(42.0)).abs();
        assert!(error_m(Trust::Proven) < error_m(Trust::Always));
    }

    #[test]
    fn a_target_that_turned_once_goes_straight_on() {
        let trajectory = sampled(TrajectorySettings::new(2.0, field()), sine, 14);
        let prediction = trajectory.at(at(15.0));
        assert_eq!(prediction.axes, [AxisForecast::TooFewTurns; 3]);
        assert!((prediction.place.x_m - (2.0 * sine(14.0) - sine(13.0))).abs() < 0.3);
        assert_eq!(trajectory.turns_s()[0].len(), 1);
    }

    #[test]
    fn a_target_that_should_have_turned_long_ago_goes_straight_on() {
        // Turns at 5 s and 10 s, then straight on.
        let zigzag = |t_s: f64| if t_s < 5.0 { t_s } else { 5.0 - (t_s - 5.0) + 2.0 * (t_s - 10.0).max(0.0) };
        let settings = TrajectorySettings { trust: Trust::Always, ..TrajectorySettings::new(2.0, field()) };
        let axis = |end_s| sampled(settings, zigzag, end_s).at(at(f64::from(end_s) + 1.0));
        assert_eq!(axis(17).axes[0], AxisForecast::Curve { past: 2, future: 2 });
        let late = axis(18);
        assert_eq!(late.axes[0], AxisForecast::Overdue);
        assert!((late.place.x_m - 9.0).abs() < 1e-6);
    }

    #[test]
    fn predictions_are_limited_by_the_speed_and_by_the_field() {
        let settings = TrajectorySettings::new(2.0, field());
        let slow = sampled(TrajectorySettings { max_speed_m_per_s: 0.5, ..settings }, sine, 40).at(at(42.0));
        assert_eq!(slow.limit, Limit::Speed);
        assert!((slow.place.distance_m(Position::new(sine(40.0), 10.0, 0.0)) - 1.0).abs() < 1e-9);
        let narrow = Bounds { min: Position::new(-20.0, -20.0, 0.0), max: Position::new(20.0, 10.2, 0.0) };
        let limited = sampled(TrajectorySettings { field: narrow, ..settings }, sine, 40).at(at(44.0));
        assert_eq!((limited.limit, limited.place.y_m), (Limit::Field, 10.2));
        let both = sampled(TrajectorySettings { field: narrow, max_speed_m_per_s: 0.2, ..settings }, |t| t.sin(), 40);
        assert_eq!(both.at(at(60.0)).limit, Limit::SpeedAndField);
    }

    #[test]
    fn at_the_last_sample_the_target_is_where_the_filter_says() {
        let trajectory = sampled(TrajectorySettings::as_in_thesis(2.0, field()), sine, 40);
        for time_s in [12.0, 40.0] {
            assert_eq!(trajectory.at(at(time_s)).place, Position::new(sine(40.0), 10.0, 0.0));
        }
    }

    #[test]
    fn without_samples_the_state_is_all_that_is_known() {
        let covariance = AxisCovariance { place_m2: 1.0, cross_m2_per_s: 0.0, velocity_m2_per_s2: 1.0 };
        let velocity_m_per_s = Position::new(1.0, 0.0, 0.0);
        let state = TargetState { place: Position::ORIGIN, velocity_m_per_s, covariance };
        let trajectory = Trajectory::new(TrajectorySettings::new(2.0, field()), &[], state);
        assert_eq!(trajectory.at(at(3.0)).place, Position::new(3.0, 0.0, 0.0));
    }
}
