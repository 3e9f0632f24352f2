//! How fast robots drive, by their places and times.
//!
//! A robot in centimetres drives as fast as a car in metres. A car is the better explanation if it turns and brakes as cars do;
//! no vehicle does so a hundred times as hard as a robot. Degrees are in no other unit, so there only the times can be wrong.

use sextant_channel::Position;

use super::extent;
use super::finding::Finding;
use super::survey::{Points, Survey};
use crate::place::distance::plane_m;
use crate::place::without_fix::TimedPlace;

/// What drives on the ground or flies is usually slower: places in metres (m/s), and fixes of satellites, which ride on trains and
/// planes too.
const FASTEST: f64 = 40.0;
const FASTEST_FIX: f64 = 100.0;
/// Faster than this, a robot needs to drive as a car does.
const CAR: f64 = 15.0;
/// Slower robots are not doubted (m/s).
const ROBOT: f64 = 5.0;
/// No vehicle changes its velocity faster (m/s²); one that drives does so more than the slightest change.
const HARDEST: f64 = 12.0;
const SLIGHTEST: f64 = 0.3;
/// So many changes that no vehicle makes, and at least this share of all; a vehicle makes so many.
const LEAST_CHANGES: usize = 3;
const SHARE_OF_CHANGES: f64 = 0.01;
/// Transmitters are weaker as a rule (dBm).
const USUAL_DBM: f64 = 25.0;
/// A single leg is a jump if it is faster than this (m/s), so many times as fast as usual, longer than this (m), and longer
/// than this share of the extent of the path.
const JUMP: f64 = 15.0;
const JUMP_TIMES: f64 = 10.0;
const JUMP_M: f64 = 2.0;
const JUMP_SHARE: f64 = 0.02;
/// Nothing that drives is always slower (m/s); nothing with a pose only each so many seconds creeps on from pose to pose.
const SLOWEST: f64 = 0.003;
const CREEPING: f64 = 0.02;
const SELDOM_S: f64 = 20.0;
/// A path has at least so many legs.
const LEAST: usize = 5;
/// Units that are mistaken for metres: how many are a metre, and what to do with them.
const UNITS: [(f64, &str, &str); 3] = [
    (100.0, "centimetres", "divide them by 100"),
    (1000.0, "millimetres", "divide them by 1000"),
    (1.0 / 0.3048, "feet", "multiply them by 0.3048"),
];
/// How fast robots drive (m/s).
const USUAL: [f64; 2] = [0.02, 3.5];

/// A straight line between two places.
struct Leg {
    from: TimedPlace,
    length_m: f64,
    span_s: f64,
}

/// What is odd of the speeds in a survey.
pub(super) fn finding(survey: &Survey<'_>) -> Option<Finding> {
    let of_pair = |pair: &[TimedPlace]| {
        let span_s = pair[1].0.saturating_since(pair[0].0).as_secs_f64();
        (span_s > 0.0).then(|| Leg { from: pair[0], length_m: plane_m(pair[0].1, pair[1].1), span_s })
    };
    let pairs = survey.robots.iter().flat_map(|places| places.windows(2));
    let legs: Vec<Leg> = pairs.filter_map(of_pair).filter(|leg| leg.length_m > 0.0).collect();
    if legs.len() < LEAST {
        return None;
    }
    let speeds = sorted(legs.iter().map(|leg| leg.length_m / leg.span_s));
    let usual = speeds[speeds.len() / 2];
    let high = speeds[speeds.len() * 9 / 10];
    let seldom_s = sorted(legs.iter().map(|leg| leg.span_s))[legs.len() / 2];
    // Of stops that are a second apart each, the times are numbers.
    let are_numbers = survey.points == Points::Stops && legs.iter().all(|leg| (leg.span_s - 1.0).abs() < 1e-9);
    let doubtful = if are_numbers { FASTEST } else { ROBOT };
    too_fast(survey, usual, doubtful)
        .or_else(|| too_slow(survey, usual, high, seldom_s))
        .or_else(|| jumps(&legs, usual, survey.points))
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// What is odd of a survey whose `usual` speed is that (m/s), if it is that of other units than metres and seconds. In metres,
/// speeds up to `doubtful` are not doubted.
fn too_fast(survey: &Survey<'_>, usual: f64, doubtful: f64) -> Option<Finding> {
    let what = survey.points.noun();
    let (odd, remedy) = if survey.plane.is_some() {
        (usual > FASTEST_FIX).then(|| (String::new(), "times need seconds: check their unit".to_owned()))?
    } else if usual > FASTEST {
        (String::new(), units(usual))
    } else if usual > doubtful {
        let changes = if survey.points == Points::Poses { Changes::of(&survey.robots) } else { Changes::default() };
        let is_strong = || extent::needed_power_dbm(survey.log).is_some_and(|power_dbm| power_dbm > USUAL_DBM);
        if changes.are_hard() {
            (format!(" and turns or brakes with up to {:.0} m/s², as no vehicle does", changes.hardest), units(usual))
        } else if usual > CAR && !changes.are_those_of_a_vehicle() {
            (", as fast as a car on a road".to_owned(), units(usual))
        } else if is_strong() {
            (", and hears nodes as far as if they sent with more than 25 dBm".to_owned(), units(usual))
        } else {
            return None;
        }
    } else {
        return None;
    };
    Some(Finding {
        check: "speed",
        odd: format!("the robot usually moves at {usual:.1} m/s between {what}{odd}"),
        cost: "the map is as many times too large as the path, or packets are placed far from where they were heard"
            .to_owned(),
        remedy,
    })
}

/// What is odd of a survey that is slow in thousandths.
fn too_slow(survey: &Survey<'_>, usual: f64, high: f64, seldom_s: f64) -> Option<Finding> {
    let creeps = usual < CREEPING && seldom_s >= SELDOM_S;
    if survey.points != Points::Poses || !(high < SLOWEST || creeps) {
        return None;
    }
    let kilometres = if survey.plane.is_some() { "" } else { ", places in kilometres multiplied by 1000" };
    Some(Finding {
        check: "speed",
        odd: if high < SLOWEST {
            format!("the robot moves at {high:.1e} m/s or less on nine tenths of its path")
        } else {
            format!("the robot usually moves at {usual:.1e} m/s, and has a pose each {seldom_s:.0} s only")
        },
        cost: "the map is as many times too small as the path, or stops are far too long".to_owned(),
        remedy: format!(
            "places need metres and times seconds: times in milliseconds need to be divided by 1000, or called `t_ms` (the robot \
             moves at {:.2} m/s then){kilometres}",
            1000.0 * usual
        ),
    })
}

/// How the velocities of robots change in a second.
#[derive(Clone, Copy, Debug, Default)]
struct Changes {
    all: usize,
    hard: usize,
    gentle: usize,
    /// The largest (m/s²).
    hardest: f64,
}

impl Changes {
    /// Those on `paths` whose places are a second apart at most as a rule; no changes otherwise.
    fn of(paths: &[Vec<TimedPlace>]) -> Self {
        let mut changes = Self::default();
        for places in paths {
            let spans = sorted(places.windows(2).map(|pair| pair[1].0.saturating_since(pair[0].0).as_secs_f64()));
            if spans.get(spans.len() / 2).is_some_and(|usual_s| *usual_s <= 1.0) {
                each_second(places).windows(3).for_each(|three| changes.take(three));
            }
        }
        changes
    }

    /// Takes three places, a second from one to the next.
    fn take(&mut self, three: &[Position]) {
        let change = three[2] - three[1] - (three[1] - three[0]);
        let change = libm::hypot(change.x_m, change.y_m);
        self.all += 1;
        self.hard += usize::from(change > HARDEST);
        self.gentle += usize::from(change > SLIGHTEST && change <= HARDEST);
        self.hardest = self.hardest.max(change);
    }

    fn are_hard(&self) -> bool {
        self.hard >= LEAST_CHANGES && self.hard as f64 >= SHARE_OF_CHANGES * self.all as f64
    }

    fn are_those_of_a_vehicle(&self) -> bool {
        !self.are_hard() && self.gentle >= LEAST_CHANGES
    }
}

/// Where a robot was each second from the start on. Where it has no place for more than two seconds, a new start is made by leaving
/// these out.
fn each_second(places: &[TimedPlace]) -> Vec<Position> {
    let mut found = Vec::new();
    let Some(&(start, _)) = places.first() else { return found };
    let seconds = |place: &TimedPlace| place.0.saturating_since(start).as_secs_f64();
    let mut next_s = 0.0;
    for pair in places.windows(2) {
        let (from_s, to_s) = (seconds(&pair[0]), seconds(&pair[1]));
        if to_s - from_s > 2.0 {
            next_s = to_s;
            continue;
        }
        while next_s < to_s {
            let share = ((next_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
            found.push(pair[0].1 + (pair[1].1 - pair[0].1) * share);
            next_s += 1.0;
        }
    }
    found
}

/// What is odd of single legs that are far too fast.
fn jumps(legs: &[Leg], usual: f64, points: Points) -> Option<Finding> {
    let along = |axis: fn(Position) -> f64| {
        let values = legs.iter().map(|leg| axis(leg.from.1));
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    let extent_m = libm::hypot(along(|at| at.x_m), along(|at| at.y_m));
    let is_jump = |leg: &&Leg| {
        leg.length_m / leg.span_s > JUMP.max(JUMP_TIMES * usual) && leg.length_m > JUMP_M.max(JUMP_SHARE * extent_m)
    };
    let fastest =
        legs.iter().filter(is_jump).max_by(|a, b| (a.length_m / a.span_s).total_cmp(&(b.length_m / b.span_s)))?;
    let count = legs.iter().filter(is_jump).count();
    Some(Finding {
        check: "speed",
        odd: format!(
            "the path jumps {count} times, by up to {:.1} m/s ({:.1} m in {:.2} s after {} s), where the robot usually moves \
             at {usual:.2} m/s",
            fastest.length_m / fastest.span_s,
            fastest.length_m,
            fastest.span_s,
            crate::time::instant::format(fastest.from.0)
        ),
        cost: "what was heard near a jump is placed up to as far away from where it was heard".to_owned(),
        remedy: format!("remove the {} that are outliers, or smooth the path (a robot cannot jump)", points.noun()),
    })
}

/// What to do with places and times that give this speed (m/s).
fn units(usual: f64) -> String {
    let in_unit = |&(in_a_metre, unit, remedy): &(f64, &str, &str)| {
        let speed = usual / in_a_metre;
        (USUAL[0]..=USUAL[1])
            .contains(&speed)
            .then(|| format!("if the places are in {unit}, {remedy} (the robot moves at {speed:.2} m/s then)"))
    };
    let mut told: Vec<String> = UNITS.iter().filter_map(in_unit).collect();
    if (USUAL[0]..=USUAL[1]).contains(&(usual / 1000.0)) && usual > FASTEST {
        told.push("if times in seconds are called `t_ms`, call them `t_s`".to_owned());
    }
    let what = if told.is_empty() { "check the units of both".to_owned() } else { told.join("; ") };
    format!("places need metres and times seconds: {what}")
}

#[cfg(test)]
mod tests {
    use sextant_channel::ReceptionLog;
    use sextant_kernel::SimTime;

    use super::*;
    use crate::LocalPlane;
    use crate::time::instant;

    fn empty() -> ReceptionLog {
        ReceptionLog::new(Vec::new(), Vec::new(), Vec::new(), Vec::new()).unwrap()
    }

    /// What is told of a robot that is at `place` each `step_s`.
    fn told(points: Points, step_s: f64, place: impl Fn(f64) -> [f64; 2]) -> Option<Finding> {
        told_in(None, points, step_s, place)
    }

    fn told_in(
        plane: Option<&LocalPlane>,
        points: Points,
        step_s: f64,
        place: impl Fn(f64) -> [f64; 2],
    ) -> Option<Finding> {
        let at = |i: u32| {
            let time_s = step_s * f64::from(i);
            let [x, y] = place(time_s);
            (instant::shifted(SimTime::ZERO, time_s).unwrap(), Position::new(x, y, 0.0))
        };
        let log = empty();
        finding(&Survey { robots: vec![(0..400).map(at).collect()], points, plane, log: &log })
    }

    /// A robot on lanes of 20 m to and fro, a metre from each other, at `speed` (m/s).
    fn lanes(speed: f64, time_s: f64) -> [f64; 2] {
        let way_m = speed * time_s;
        let (lane, along_m) = ((way_m / 21.0).floor(), way_m % 21.0);
        let x = along_m.min(20.0);
        [if lane % 2.0 < 0.5 { x } else { 20.0 - x }, lane + (along_m - 20.0).max(0.0)]
    }

    /// A car that speeds up and brakes between 10 and 25 m/s on a road with bends of 200 m.
    fn road(time_s: f64) -> [f64; 2] {
        let way_m = 17.5 * time_s + 60.0 * (time_s / 8.0).sin();
        [200.0 * (way_m / 200.0).sin() + 0.5 * way_m, 200.0 * (way_m / 200.0).cos()]
    }

    #[test]
    fn robots_drones_and_cars_are_not_too_fast() {
        for step_s in [0.1, 0.5] {
            for speed in [0.05, 0.7, 3.0] {
                assert_eq!(told(Points::Poses, step_s, |time_s| lanes(speed, time_s)), None, "{speed} m/s");
            }
            assert_eq!(told(Points::Poses, step_s, road), None, "a car");
            let drone = |time_s: f64| [30.0 * (0.3 * time_s).sin(), 30.0 * (0.3 * time_s).cos()];
            assert_eq!(told(Points::Poses, step_s, drone), None, "a drone at 9 m/s in circles");
        }
        let plane = LocalPlane::new(50.0, 3.0, 0.0);
        assert_eq!(told_in(Some(&plane), Points::Poses, 0.5, |time_s| [70.0 * time_s, 0.0]), None, "a plane");
    }

    #[test]
    fn lanes_in_centimetres_millimetres_and_feet_are_too_fast_whatever_their_poses() {
        for (in_a_metre, unit) in
            [(100.0, "centimetres, divide them by 100"), (1000.0, "millimetres, divide them by 1000")]
        {
            for (points, step_s) in [(Points::Poses, 0.1), (Points::Poses, 0.5), (Points::Stops, 5.0)] {
                let found = told(points, step_s, |time_s| lanes(0.39, time_s).map(|at| at * in_a_metre)).unwrap();
                assert!(found.odd.starts_with("the robot usually moves at 39"), "{found}");
                assert!(
                    found.remedy.contains(unit) && found.remedy.contains("(the robot moves at 0.39 m/s then)"),
                    "{found}"
                );
            }
        }
        let slow = told(Points::Poses, 1.0, |time_s| lanes(0.15, time_s).map(|at| at * 100.0)).unwrap();
        assert!(
            slow.odd.starts_with("the robot usually moves at 15.0 m/s between poses and turns or brakes"),
            "{slow}"
        );
        let feet = told(Points::Poses, 0.5, |time_s| lanes(3.0, time_s).map(|at| at / 0.3048)).unwrap();
        assert!(feet.remedy.contains("feet, multiply them by 0.3048 (the robot moves at 3.00 m/s then)"), "{feet}");
        let straight = told(Points::Poses, 1.0, |time_s| [39.0 * time_s, 3.0]).unwrap();
        assert!(straight.odd.ends_with("as fast as a car on a road"), "{straight}");
    }

    #[test]
    fn times_in_milliseconds_are_too_slow() {
        for speed in [0.5, 2.0, 12.0] {
            let found = told(Points::Poses, 100.0, |time_s| lanes(speed, time_s / 1000.0)).unwrap();
            assert!(found.remedy.contains("called `t_ms`"), "{found}");
        }
        let found = told(Points::Poses, 1.0, |time_s| [5e-4 * time_s, 0.0]).unwrap();
        assert!(found.odd.contains("5.0e-4 m/s") && found.remedy.contains("kilometres"), "{found}");
        assert_eq!(told(Points::Stops, 3600.0, |time_s| [5e-4 * time_s, 0.0]), None, "a stop an hour");
        assert_eq!(told(Points::Poses, 60.0, |time_s| [0.1 * time_s, 0.0]), None, "a buoy that drifts");
    }

    #[test]
    fn stops_whose_times_are_their_numbers_have_no_speed() {
        let anywhere = |time_s: f64| [30.0 * (7.0 * time_s).sin(), 30.0 * (11.0 * time_s).cos()];
        assert_eq!(told(Points::Stops, 1.0, anywhere), None);
        assert!(told(Points::Stops, 1.1, anywhere).is_some());
    }

    #[test]
    fn a_place_beside_the_path_is_a_jump() {
        let beside = |time_s: f64| [0.5 * time_s, if (39.5..40.5).contains(&time_s) { 52.0 } else { 3.0 }];
        let found = told(Points::Poses, 1.0, beside).unwrap();
        assert!(
            found.odd.starts_with("the path jumps 2 times, by up to 49.0 m/s (49.0 m in 1.00 s after"),
            "{found}"
        );
    }
}
