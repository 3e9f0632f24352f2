//! How fast a robot drives and how long it listens, as its log tells.

use std::fmt;

use serde::Serialize;
use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::RobotId;

use super::NextSettings;

/// A pause between two stops that is so many times as long as usual is none of driving or listening.
const PAUSE: f64 = 5.0;
/// The speed of a robot of whose time nothing is known (m/s).
const ASSUMED_M_PER_S: f64 = 0.5;
/// What is a smaller share of all of the time is left by rounding.
const ROUNDING: f64 = 1e-6;

/// How fast a robot drives and how long it listens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pace {
    /// Speed between stops (m/s).
    pub speed_m_per_s: f64,
    /// Time of listening at a stop (s).
    pub listen_s: f64,
    /// Usual way from one stop to the next (m).
    pub spacing_m: f64,
    /// What tells the speed.
    pub speed_from: PaceSource,
    /// What tells the time of listening.
    pub listen_from: PaceSource,
}

/// What tells how fast a robot is, or how long it listens.
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
        let mut stops: Vec<&Stop> = log.stops().iter().filter(|stop| stop.robot == robot).collect();
        stops.sort_by_key(|stop| stop.time);
        let leg = |pair: &[&Stop]| {
            let time_s = pair[1].time.saturating_since(pair[0].time).as_secs_f64();
            [pair[0].position.distance_m(pair[1].position), time_s]
        };
        let legs: Vec<[f64; 2]> = stops.windows(2).map(leg).filter(|[way_m, _]| *way_m > 0.0).collect();
        let spacing_m = median(legs.iter().map(|[way_m, _]| *way_m)).unwrap_or(1.0);
        let usual_s = median(legs.iter().map(|[_, time_s]| *time_s)).unwrap_or(0.0);
        let usual: Vec<[f64; 2]> =
            legs.into_iter().filter(|[_, time_s]| *time_s > 0.0 && *time_s <= PAUSE * usual_s).collect();
        let (given_speed, given_listen) = (next.speed_m_per_s, next.listen_s);
        let (told_speed, told_listen) = tell(&usual, given_speed, given_listen);
        let (speed_m_per_s, speed_from) = source(given_speed, told_speed, ASSUMED_M_PER_S);
        // Whoever drives at a speed that is assumed listens for the rest of the time.
        let (_, told_listen) = match speed_from {
            PaceSource::Assumed => tell(&usual, Some(speed_m_per_s), given_listen),
            PaceSource::Settings | PaceSource::Log => (told_speed, told_listen),
        };
        let (listen_s, listen_from) = source(given_listen, told_listen, 0.0);
        if speed_from == PaceSource::Assumed {
            let beside = given_listen.map_or(String::new(), |listen_s| format!(" beside {listen_s} s of listening"));
            notes.push(format!(
                "the times of the stops tell no speed{beside}: it is taken as {ASSUMED_M_PER_S} m/s (option `speed` sets it)"
            ));
        } else if listen_from == PaceSource::Assumed {
            notes.push("the times of the stops tell no time of listening: it is taken as 0 s".to_owned());
        }
        Self { speed_m_per_s, listen_s, spacing_m, speed_from, listen_from }
    }

    /// What a stop costs, however near it is to the way (s): listening, or the usual way between two stops.
    pub(super) fn least_s(&self) -> f64 {
        self.listen_s.max(self.spacing_m / self.speed_m_per_s)
    }
}

impl fmt::Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { speed_m_per_s, listen_s, speed_from, listen_from, .. } = self;
        if speed_from == listen_from {
            return write!(f, "{speed_m_per_s:.2} m/s and {listen_s:.1} s of listening, {}", speed_from.words());
        }
        let (speed, listen) = (speed_from.words(), listen_from.words());
        write!(f, "{speed_m_per_s:.2} m/s ({speed}) and {listen_s:.1} s of listening ({listen})")
    }
}

impl PaceSource {
    const fn words(self) -> &'static str {
        match self {
            Self::Settings => "as given",
            Self::Log => "as in the log",
            Self::Assumed => "as assumed",
        }
    }
}

/// The value that is given, or told, or assumed, and which of them it is.
fn source(given: Option<f64>, told: Option<f64>, assumed: f64) -> (f64, PaceSource) {
    match (given, told) {
        (Some(given), _) => (given, PaceSource::Settings),
        (None, Some(told)) => (told, PaceSource::Log),
        (None, None) => (assumed, PaceSource::Assumed),
    }
}

/// What legs of ways and times tell of the speed and the time of listening. If one of them is given, the other one is what makes
/// their whole time.
fn tell(legs: &[[f64; 2]], speed_m_per_s: Option<f64>, listen_s: Option<f64>) -> (Option<f64>, Option<f64>) {
    let count = legs.len() as f64;
    let (way, time) = legs.iter().fold((0.0, 0.0), |(way, time), leg| (way + leg[0], time + leg[1]));
    match (speed_m_per_s, listen_s) {
        (None, None) => fit(legs).unzip(),
        (None, Some(listen_s)) => {
            let driving = time - count * listen_s;
            // What is left by rounding is no driving.
            ((way > 0.0 && driving > ROUNDING * time).then(|| way / driving), None)
        }
        (Some(speed), None) => (None, (time > 0.0).then(|| ((time - way / speed) / count).max(0.0))),
        (Some(_), Some(_)) => (None, None),
    }
}

/// Speed and time of listening by the least squares of `time = listening + way / speed` over legs of ways and times; all of the time
/// is driving if the legs are of one length, which does not tell both apart. `None` if they have no times, or if longer legs do not
/// clearly take longer, as where a table has a stop each ten seconds.
fn fit(legs: &[[f64; 2]]) -> Option<(f64, f64)> {
    /// Ways of less spread than this share of their squares are of one length.
    const SPREAD: f64 = 1e-3;
    /// Longer legs take clearly longer if they do by so many standard errors.
    const CLEAR: f64 = 2.0;
    let count = legs.len() as f64;
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| legs.iter().map(of).sum::<f64>();
    let (way, time) = (sum(&|leg| leg[0]), sum(&|leg| leg[1]));
    if time <= 0.0 || way <= 0.0 {
        return None;
    }
    let square = sum(&|leg| leg[0] * leg[0]);
    let spread = square - way * way / count;
    if spread <= SPREAD * square {
        return Some((way / time, 0.0));
    }
    let slowness = (sum(&|leg| leg[0] * leg[1]) - way * time / count) / spread;
    let listen_s = (time - slowness * way) / count;
    let squared_errors = sum(&|leg| (leg[1] - listen_s - slowness * leg[0]).powi(2));
    let error = (squared_errors / (count - 2.0).max(1.0) / spread).sqrt();
    let is_told = slowness > CLEAR * error && slowness * way > ROUNDING * time;
    is_told.then(|| match listen_s * count > ROUNDING * time {
        true => (1.0 / slowness, listen_s),
        false => (way / time, 0.0),
    })
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;
    use sextant_kernel::SimTime;

    use super::*;

    #[test]
    fn legs_of_two_lengths_tell_driving_from_listening() {
        // 0.5 m/s and 6 s of listening.
        let (speed_m_per_s, listen_s) = fit(&[[2.0, 10.0], [2.0, 10.0], [5.0, 16.0], [2.0, 10.0]]).unwrap();
        assert!((speed_m_per_s - 0.5).abs() < 1e-9 && (listen_s - 6.0).abs() < 1e-9, "{speed_m_per_s} {listen_s}");
    }

    #[test]
    fn what_is_not_given_makes_the_whole_time_of_the_log() {
        // 1 m/s and 8 s of listening: legs of one length do not tell them apart, but either tells the other.
        let legs = [[2.0, 10.0], [2.0, 10.0]];
        assert_eq!(tell(&legs, None, Some(8.0)), (Some(1.0), None));
        assert_eq!(tell(&legs, Some(1.0), None), (None, Some(8.0)));
        // No time is left.
        assert_eq!(tell(&legs, None, Some(10.0)), (None, None));
        assert_eq!(tell(&legs, Some(0.1), None), (None, Some(0.0)));
        assert_eq!(tell(&[], Some(0.1), None), (None, None));
    }

    #[test]
    fn the_pace_follows_the_times_of_the_stops_and_says_what_tells_it() {
        let stop = |time_s: u64, x_m: f64| Stop {
            time: SimTime::from_secs(time_s),
            ..Stop::at(Position::new(x_m, 0.0, 0.0))
        };
        // The last row is the first stop.
        let stops = vec![stop(10, 2.0), stop(20, 4.0), stop(30, 6.0), stop(0, 0.0)];
        let log = ReceptionLog::new(vec!["n".to_owned()], stops, Vec::new(), Vec::new()).unwrap();
        let mut notes = Vec::new();
        let mut pace = |listen_s| {
            let next = NextSettings { listen_s, ..NextSettings::default() };
            Pace::new(&log, RobotId(0), &next, &mut notes)
        };
        let (all, listening) = (pace(None), pace(Some(8.0)));
        assert!((all.spacing_m - 2.0).abs() < 1e-12, "{}", all.spacing_m);
        assert_eq!(all.to_string(), "0.20 m/s and 0.0 s of listening, as in the log");
        assert_eq!(listening.to_string(), "1.00 m/s (as in the log) and 8.0 s of listening (as given)");
        assert!(notes.is_empty(), "{notes:?}");
    }

    #[test]
    fn stops_at_regular_times_tell_no_speed() {
        let ways = [2.9, 3.1, 3.4, 2.7, 3.05, 2.6];
        // Once exactly each ten seconds, and once by clocks that are a little off.
        for jitter_s in [0.0, 0.3] {
            let times = [0.2, -1.0, 0.4, 0.9, -0.7, 0.1].map(|off| 10.0 + jitter_s * off);
            let legs: Vec<[f64; 2]> = ways.into_iter().zip(times).map(|(way_m, time_s)| [way_m, time_s]).collect();
            assert_eq!(fit(&legs), None, "{jitter_s}");
        }
        let mut at_m = 0.0;
        let stop = |(step, way_m): (u64, f64)| {
            at_m += way_m;
            Stop { time: SimTime::from_secs(10 * step), ..Stop::at(Position::new(at_m, 0.0, 0.0)) }
        };
        let stops = (0..).zip([0.0].into_iter().chain(ways)).map(stop).collect();
        let log = ReceptionLog::new(vec!["n".to_owned()], stops, Vec::new(), Vec::new()).unwrap();
        let mut notes = Vec::new();
        let pace = Pace::new(&log, RobotId(0), &NextSettings::default(), &mut notes);
        assert_eq!(pace.to_string(), "0.50 m/s (as assumed) and 4.1 s of listening (as in the log)");
        assert!(notes.len() == 1 && notes[0].contains("tell no speed") && notes[0].contains("`speed`"), "{notes:?}");
        // Nor is it the rest of the time beside a time of listening that is all of it.
        let listening = NextSettings { listen_s: Some(10.0 - 1e-12), ..NextSettings::default() };
        let pace = Pace::new(&log, RobotId(0), &listening, &mut notes);
        assert_eq!(pace.speed_from, PaceSource::Assumed, "{pace}");
    }

    #[test]
    fn legs_of_one_length_tell_the_whole_time_only() {
        assert_eq!(fit(&[[2.0, 10.0], [2.0, 10.0]]), Some((0.2, 0.0)));
        assert_eq!(fit(&[]), None);
        assert_eq!(fit(&[[2.0, 0.0]]), None);
    }
}
