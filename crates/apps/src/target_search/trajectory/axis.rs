//! One coordinate of the way of a target.

use super::shape::Shape;
use super::{AxisForecast, NextTurn, TrajectorySettings, Trust};

/// Maximum number of future turns; a later time is predicted with these.
const MOST_FUTURE_TURNS: usize = 16;
/// Number of last samples that a hindcast predicts.
const HINDCASTS: usize = 12;
/// How many samples before each of them it stops looking at the data.
const LEAD: usize = 4;
/// The squared error of the curve must be below this share of that of constant velocity.
const PROOF: f64 = 0.5;
/// Number of last places that give the velocity of a hindcast.
const VELOCITY_PLACES: usize = 3;

/// One coordinate of the way, ready for predictions.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    settings: TrajectorySettings,
    /// Past turns, ascending (s).
    turns_s: Vec<f64>,
    /// The last filtered coordinates (s, m).
    recent: Vec<(f64, f64)>,
    place_m: f64,
    velocity_m_per_s: f64,
    /// Whether the curve is worse than constant velocity.
    is_irregular: bool,
}

impl Axis {
    /// The way through the filtered `points` (s, m), which ends with this place and velocity.
    pub(super) fn new(
        settings: &TrajectorySettings,
        points: &[(f64, f64)],
        place_m: f64,
        velocity_m_per_s: f64,
    ) -> Self {
        let mut axis = Self::trusted(settings, points, place_m, velocity_m_per_s);
        if settings.trust == Trust::Proven && axis.turns_s.len() >= 2 {
            axis.is_irregular = !is_proven(settings, points);
        }
        axis
    }

    /// The same without a hindcast.
    fn trusted(settings: &TrajectorySettings, points: &[(f64, f64)], place_m: f64, velocity_m_per_s: f64) -> Self {
        let recent = points[points.len().saturating_sub(settings.fitted_places)..].to_vec();
        let turns_s = settings.turn_times.of(points);
        Self { settings: *settings, turns_s, recent, place_m, velocity_m_per_s, is_irregular: false }
    }

    /// Past turns, ascending (s).
    #[cfg(test)]
    pub(super) fn turns_s(&self) -> &[f64] {
        &self.turns_s
    }

    /// The coordinate `ahead_s` seconds after the last sample, which is at `last_s`.
    pub(super) fn forecast(&self, last_s: f64, ahead_s: f64) -> (f64, AxisForecast) {
        let curve = || {
            if self.is_irregular {
                return Err(AxisForecast::StraightIsBetter);
            }
            let future_s = self.future_turns_s(last_s, ahead_s)?;
            let turns_s = [&self.turns_s[..], &future_s].concat();
            let shape = Shape::new(self.settings.form, turns_s).ok_or(AxisForecast::FlatCurve)?;
            let curve_m = shape.fitted(&self.recent, last_s + ahead_s).ok_or(AxisForecast::FlatCurve)?;
            Ok((curve_m, AxisForecast::Curve { past: self.turns_s.len(), future: future_s.len() }))
        };
        curve().unwrap_or_else(|reason| (self.straight_m(ahead_s), reason))
    }

    fn straight_m(&self, ahead_s: f64) -> f64 {
        self.place_m + ahead_s * self.velocity_m_per_s
    }

    /// Turns after those that were seen, up to the first one after the time asked for.
    ///
    /// # Errors
    /// The reason why there are none.
    fn future_turns_s(&self, last_s: f64, ahead_s: f64) -> Result<Vec<f64>, AxisForecast> {
        let [first_s, .., newest_s] = self.turns_s[..] else { return Err(AxisForecast::TooFewTurns) };
        let interval_s = (newest_s - first_s) / (self.turns_s.len() - 1) as f64;
        let mut turn_s = match self.settings.next_turn {
            NextTurn::AfterLastTurn => newest_s + interval_s,
            NextTurn::AfterLastSample => last_s + interval_s,
        };
        if turn_s + 0.5 * interval_s < last_s {
            return Err(AxisForecast::Overdue);
        }
        let mut turns_s = vec![turn_s];
        while turns_s.len() < MOST_FUTURE_TURNS && turn_s <= last_s + ahead_s {
            turn_s += interval_s;
            turns_s.push(turn_s);
        }
        Ok(turns_s)
    }
}

/// Whether the curve, with what was known `LEAD` samples before, predicts the last samples clearly better than
/// constant velocity does.
fn is_proven(settings: &TrajectorySettings, points: &[(f64, f64)]) -> bool {
    let (mut curve_m2, mut straight_m2) = (0.0, 0.0);
    let first = points.len().saturating_sub(HINDCASTS).max(LEAD + VELOCITY_PLACES);
    for target in first..points.len() {
        let known = &points[..=target - LEAD];
        let ((last_s, last_m), (time_s, place_m)) = (known[known.len() - 1], points[target]);
        let (start_s, start_m) = known[known.len() - VELOCITY_PLACES];
        let axis = Axis::trusted(settings, known, last_m, (last_m - start_m) / (last_s - start_s));
        let ahead_s = time_s - last_s;
        let most_m = settings.max_speed_m_per_s * ahead_s;
        let squared_error_m2 = |found_m: f64| (found_m.clamp(last_m - most_m, last_m + most_m) - place_m).powi(2);
        curve_m2 += squared_error_m2(axis.forecast(last_s, ahead_s).0);
        straight_m2 += squared_error_m2(axis.straight_m(ahead_s));
    }
    curve_m2 < PROOF * straight_m2
}
