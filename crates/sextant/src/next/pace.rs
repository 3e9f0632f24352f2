//! How fast a robot drives and how long it listens, as its log tells.

use serde::Serialize;
use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::RobotId;

use super::NextSettings;

/// A pause between two stops that is so many times as long as usual is none of driving or listening.
const PAUSE: f64 = 5.0;
/// The speed of a robot of whose time nothing is known (m/s).
const ASSUMED_M_PER_S: f64 = 0.5;

/// How fast a robot drives and how long it listens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pace {
    /// Speed between stops (m/s).
    pub speed_m_per_s: f64,
    /// Time of listening at a stop (s).
    pub listen_s: f64,
    /// Usual way from one stop to the next (m).
    pub spacing_m: f64,
    /// What tells it.
    pub from: PaceSource,
}

/// What tells how fast a robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PaceSource {
    /// The settings.
    Settings,
    /// The times of the stops.
    Log,
    /// Nothing: it is assumed.
    Assumed,
}

impl Pace {
    /// The pace of a robot of `log`: as the settings say, otherwise as the times of its stops tell.
    pub(super) fn new(log: &ReceptionLog, robot: RobotId, next: &NextSettings, notes: &mut Vec<String>) -> Self {
        let stops: Vec<&Stop> = log.stops().iter().filter(|stop| stop.robot == robot).collect();
        let leg = |pair: &[&Stop]| {
            let time_s = pair[1].time.saturating_since(pair[0].time).as_secs_f64();
            [pair[0].position.distance_m(pair[1].position), time_s]
        };
        let legs: Vec<[f64; 2]> = stops.windows(2).map(leg).filter(|[way_m, _]| *way_m > 0.0).collect();
        let spacing_m = median(legs.iter().map(|[way_m, _]| *way_m)).unwrap_or(1.0);
        let usual_s = median(legs.iter().map(|[_, time_s]| *time_s)).unwrap_or(0.0);
        let usual: Vec<[f64; 2]> =
            legs.into_iter().filter(|[_, time_s]| *time_s > 0.0 && *time_s <= PAUSE * usual_s).collect();
        let told = if next.speed_m_per_s.is_some() && next.listen_s.is_some() { None } else { fit(&usual) };
        let (speed_m_per_s, listen_s) = told.unwrap_or((ASSUMED_M_PER_S, 0.0));
        let from = match (next.speed_m_per_s, told) {
            (Some(_), _) => PaceSource::Settings,
            (None, Some(_)) => PaceSource::Log,
            (None, None) => {
                notes.push(format!("the times of the stops tell no speed: it is taken as {ASSUMED_M_PER_S} m/s"));
                PaceSource::Assumed
            }
        };
        Self {
            speed_m_per_s: next.speed_m_per_s.unwrap_or(speed_m_per_s),
            listen_s: next.listen_s.unwrap_or(listen_s),
            spacing_m,
            from,
        }
    }

    /// What a stop costs, however near it is to the way (s): listening, or the usual way between two stops.
    pub(super) fn least_s(&self) -> f64 {
        self.listen_s.max(self.spacing_m / self.speed_m_per_s)
    }
}

/// Speed and time of listening by the least squares of `time = listening + way / speed` over legs of ways and times; all of the time
/// is driving if the legs do not tell both apart. `None` if they have no times.
fn fit(legs: &[[f64; 2]]) -> Option<(f64, f64)> {
    let count = legs.len() as f64;
    let sum = |of: fn(&[f64; 2]) -> f64| legs.iter().map(of).sum::<f64>();
    let (way, time) = (sum(|leg| leg[0]), sum(|leg| leg[1]));
    if time <= 0.0 || way <= 0.0 {
        return None;
    }
    let (square, product) = (sum(|leg| leg[0] * leg[0]), sum(|leg| leg[0] * leg[1]));
    let spread = square - way * way / count;
    let slowness = (product - way * time / count) / spread;
    let listen_s = (time - slowness * way) / count;
    // What is left by rounding is no listening.
    let is_told = spread > 1e-3 * square && slowness > 0.0 && listen_s * count > 1e-6 * time;
    Some(if is_told { (1.0 / slowness, listen_s) } else { (way / time, 0.0) })
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_of_two_lengths_tell_driving_from_listening() {
        // 0.5 m/s and 6 s of listening.
        let (speed_m_per_s, listen_s) = fit(&[[2.0, 10.0], [2.0, 10.0], [5.0, 16.0], [2.0, 10.0]]).unwrap();
        assert!((speed_m_per_s - 0.5).abs() < 1e-9 && (listen_s - 6.0).abs() < 1e-9, "{speed_m_per_s} {listen_s}");
    }

    #[test]
    fn legs_of_one_length_tell_the_whole_time_only() {
        assert_eq!(fit(&[[2.0, 10.0], [2.0, 10.0]]), Some((0.2, 0.0)));
        assert_eq!(fit(&[]), None);
        assert_eq!(fit(&[[2.0, 0.0]]), None);
    }
}
