//! The path of the robot from transforms between frames, as tf2 composes them.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_kernel::text::choices;

use super::clock::{LeastDelay, Moment};
use super::field_path::FieldPath;
use super::selection::{Selection, Value};
use super::topics::{Bag, Topic};
use crate::error::bag_error::BagError;
use crate::options::bag_options::{BagClock, BagOptions};

/// The types of messages with transforms.
pub(super) const MESSAGE_TYPES: [&str; 2] = ["tf2_msgs/TFMessage", "tf/tfMessage"];

/// The usual frames of a robot (REP 105).
const CHILD_FRAMES: [&str; 2] = ["base_link", "base_footprint"];

/// The usual topic of fixed transforms, and the end of its name.
const FIXED_TOPIC: &str = "/tf_static";
const FIXED_SUFFIX: &str = "_static";

pub(super) fn is_of_transforms(topic: &Topic) -> bool {
    MESSAGE_TYPES.contains(&topic.message_type.as_str())
}

/// Whether its transforms do not change.
pub(super) fn is_fixed(topic: &Topic) -> bool {
    topic.name.ends_with(FIXED_SUFFIX)
}

/// The transforms from the fixed frame to the frame of the robot.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// From the fixed frame outwards.
    links: Vec<Link>,
}

/// The transforms from one frame to the next.
#[derive(Clone, Debug)]
struct Link {
    parent: String,
    child: String,
    samples: Vec<TimedTransform>,
    /// Whether it does not change.
    is_fixed: bool,
}

#[derive(Clone, Copy, Debug)]
struct TimedTransform {
    moment: Moment,
    transform: Isometry3<f64>,
}

/// One transform of a message.
struct TransformRow<'a> {
    parent: &'a str,
    child: &'a str,
    sample: TimedTransform,
    is_fixed: bool,
}

impl Chain {
    /// Reads the transforms of `topic`, and the fixed ones beside it, from the fixed frame to that of the robot.
    ///
    /// # Errors
    /// If there is no such frame, or a message or a file cannot be read.
    pub(super) fn read(bag: &Bag, topic: &Topic, options: &BagOptions) -> Result<Self, BagError> {
        let mut parents = BTreeMap::<String, String>::new();
        visit(bag, topic, |row| match parents.get(row.child) {
            Some(parent) if parent != row.parent => {
                Err(format!("frame `{}` has two parents, `{parent}` and `{}`; allowed: one", row.child, row.parent))
            }
            Some(_) => Ok(()),
            None => {
                parents.insert(row.child.to_owned(), row.parent.to_owned());
                Ok(())
            }
        })?;
        let pairs = pairs(&parents, options).map_err(|problem| bag.topic_problem(&topic.name, problem))?;
        let new = |(parent, child)| Link { parent, child, samples: Vec::new(), is_fixed: true };
        let mut links: Vec<Link> = pairs.into_iter().map(new).collect();
        visit(bag, topic, |row| {
            if let Some(link) = links.iter_mut().find(|link| link.child == row.child && link.parent == row.parent) {
                link.is_fixed &= row.is_fixed;
                link.samples.push(row.sample);
            }
            Ok(())
        })?;
        if links.iter().all(|link| link.is_fixed) {
            let [first, .., last] = [&links[0].parent, &links[links.len() - 1].child];
            let problem =
                format!("frame `{last}` does not move in frame `{first}`: all transforms between them are fixed");
            return Err(bag.topic_problem(&topic.name, problem));
        }
        Ok(Self { links })
    }

    /// The frames, from the fixed one to that of the robot, for people.
    pub(super) fn frames(&self) -> String {
        let children = self.links.iter().map(|link| link.child.as_str());
        let frames: Vec<_> = self.links.iter().take(1).map(|link| link.parent.as_str()).chain(children).collect();
        frames.join(" -> ")
    }

    /// Whether each moving transform has a stamp.
    pub(super) fn has_stamps(&self) -> bool {
        self.moving().flat_map(|link| &link.samples).all(|sample| sample.moment.time(BagClock::Stamp).is_some())
    }

    /// The least delay of the transforms that come most often.
    pub(super) fn least_delay(&self) -> LeastDelay {
        let mut least = LeastDelay::default();
        if let Some(link) = self.moving().max_by_key(|link| link.samples.len()) {
            link.samples.iter().for_each(|sample| least.take(sample.moment));
        }
        least
    }

    /// Where the robot was at each time of the transforms that come most often, from the first time at which all are known
    /// to the last one. Between two transforms, the translation is linear and the rotation spherically linear, as in tf2.
    pub(super) fn positions(&self, clock: BagClock) -> Vec<(SimTime, Position)> {
        let timed = |link: &Link| {
            let sample = |sample: &TimedTransform| Some((sample.moment.time(clock)?, sample.transform));
            let mut samples: Vec<_> = link.samples.iter().filter_map(sample).collect();
            samples.sort_by_key(|(time, _)| *time);
            if link.is_fixed {
                // The last one holds, from the start on.
                samples = link.samples.last().map(|sample| (SimTime::ZERO, sample.transform)).into_iter().collect();
            }
            samples
        };
        let links: Vec<(bool, Vec<_>)> = self.links.iter().map(|link| (link.is_fixed, timed(link))).collect();
        let often = links.iter().filter(|(is_fixed, _)| !is_fixed).max_by_key(|(_, samples)| samples.len());
        let times = often.into_iter().flat_map(|(_, samples)| samples.iter().map(|(time, _)| *time));
        let place = |time| {
            let transforms = links.iter().map(|(is_fixed, samples)| match is_fixed {
                true => samples.first().map(|(_, transform)| *transform),
                false => at(samples, time),
            });
            let whole = compose(transforms)?;
            let [x, y, z] = whole.translation.vector.into();
            Some((time, Position::new(x, y, z)))
        };
        times.filter_map(place).collect()
    }

    fn moving(&self) -> impl Iterator<Item = &Link> {
        self.links.iter().filter(|link| !link.is_fixed)
    }
}

/// Composes transforms from the fixed frame outwards; `None` if any is unknown.
fn compose(mut transforms: impl Iterator<Item = Option<Isometry3<f64>>>) -> Option<Isometry3<f64>> {
    transforms.try_fold(Isometry3::identity(), |whole, next| Some(whole * next?))
}

/// The transform at a time; `None` before the first and after the last.
fn at(samples: &[(SimTime, Isometry3<f64>)], time: SimTime) -> Option<Isometry3<f64>> {
    let after = samples.partition_point(|(earlier, _)| *earlier <= time);
    let (before, transform) = &samples[after.checked_sub(1)?];
    if *before == time {
        return Some(*transform);
    }
    let (next, target) = samples.get(after)?;
    let share = (time - *before).as_secs_f64() / (*next - *before).as_secs_f64();
    // Opposite rotations have no shortest way between them: then the earlier one holds.
    Some(transform.try_lerp_slerp(target, share, 1e-9).unwrap_or(*transform))
}

/// Parent and child of each transform from the fixed frame to that of the robot.
fn pairs(parents: &BTreeMap<String, String>, options: &BagOptions) -> Result<Vec<(String, String)>, String> {
    let list = || {
        let pairs: Vec<_> = parents.iter().map(|(child, parent)| format!("{parent} -> {child}")).collect();
        choices(&pairs)
    };
    let child = match &options.child_frame {
        Some(name) => name.trim_start_matches('/').to_owned(),
        None => {
            let usual = CHILD_FRAMES.iter().find(|name| parents.contains_key(**name));
            let usual = usual.ok_or_else(|| {
                let names = CHILD_FRAMES.join(" or ");
                format!(
                    "there is no frame {names}; name that of the robot with option `child_frame`; transforms: {}",
                    list()
                )
            })?;
            (*usual).to_owned()
        }
    };
    if !parents.contains_key(&child) {
        return Err(format!("no transform leads to frame `{child}`; transforms: {}", list()));
    }
    let fixed = options.fixed_frame.as_ref().map(|name| name.trim_start_matches('/'));
    let mut pairs = Vec::new();
    let mut frame = child.clone();
    while Some(frame.as_str()) != fixed {
        let Some(parent) = parents.get(&frame) else { break };
        pairs.push((parent.clone(), std::mem::replace(&mut frame, parent.clone())));
        if pairs.len() > parents.len() {
            return Err(format!("the transforms form a circle; transforms: {}", list()));
        }
    }
    match fixed {
        Some(fixed) if frame != fixed => {
            Err(format!("frame `{fixed}` is not above frame `{child}`; transforms: {}", list()))
        }
        Some(_) if pairs.is_empty() => {
            Err(format!("option `fixed_frame` and the frame of the robot are both `{child}`"))
        }
        _ => {
            pairs.reverse();
            Ok(pairs)
        }
    }
}

/// Calls `take` with each transform of `topic` and of the fixed ones beside it.
fn visit(
    bag: &Bag,
    topic: &Topic,
    mut take: impl FnMut(TransformRow<'_>) -> Result<(), String>,
) -> Result<(), BagError> {
    let own_fixed = format!("{}{FIXED_SUFFIX}", topic.name);
    let mut selections: Vec<(&str, bool, Selection)> = Vec::new();
    for (name, is_fixed) in [(topic.name.as_str(), false), (&own_fixed, true), (FIXED_TOPIC, true)] {
        let known = selections.iter().any(|(known, ..)| *known == name);
        if let Some(topic) = bag.topic(name).filter(|topic| !known && is_of_transforms(topic)) {
            let selection = select(topic).map_err(|problem| bag.topic_problem(name, problem))?;
            selections.push((name, is_fixed, selection));
        }
    }
    bag.messages::<BagError>(|message| {
        let Some((name, is_fixed, selection)) = selections.iter().find(|(name, ..)| *name == message.topic) else {
            return Ok(());
        };
        let read = selection.rows(message.data, |row| take(transform(row, message.log_ns, *is_fixed)?));
        read.and_then(|visited| visited).map_err(|problem| bag.topic_problem(name, problem))
    })
}

fn select(topic: &Topic) -> Result<Selection, String> {
    let paths = [
        "header.stamp",
        "header.frame_id",
        "child_frame_id",
        "transform.translation.x",
        "transform.translation.y",
        "transform.translation.z",
        "transform.rotation.x",
        "transform.rotation.y",
        "transform.rotation.z",
        "transform.rotation.w",
    ];
    let paths = paths.map(|path| FieldPath::parse(&format!("transforms[].{path}")));
    Selection::new(topic.definitions()?, &paths.into_iter().collect::<Result<Vec<_>, _>>()?)
}

fn transform<'a>(row: &[Value<'a>], log_ns: u64, is_fixed: bool) -> Result<TransformRow<'a>, String> {
    let [Value::Instant(stamp_ns), Value::Text(parent), Value::Text(child), numbers @ ..] = row else {
        return Err("its transforms have no stamp or no names of frames".to_owned());
    };
    let mut values = [0.0; 7];
    for (value, number) in values.iter_mut().zip(numbers) {
        *value = match number {
            Value::Real(real) if real.is_finite() => *real,
            other => {
                return Err(format!(
                    "the transform to frame `{child}` has the value {other:?}; allowed: finite numbers"
                ));
            }
        };
    }
    let [x_m, y_m, z_m, i, j, k, w] = values;
    let rotation = Quaternion::new(w, i, j, k);
    if rotation.norm() < 0.5 {
        return Err(format!(
            "the transform to frame `{child}` has the rotation ({i}, {j}, {k}, {w}); allowed: norm 1"
        ));
    }
    let transform = Isometry3::from_parts(Translation3::new(x_m, y_m, z_m), UnitQuaternion::new_normalize(rotation));
    // Names of ROS 1 can begin with a slash.
    let [parent, child] = [parent, child].map(|name| name.trim_start_matches('/'));
    let moment = Moment { stamp_ns: Some(*stamp_ns), log_ns };
    Ok(TransformRow { parent, child, sample: TimedTransform { moment, transform }, is_fixed })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::Vector3;

    use super::*;

    const SECOND_NS: u64 = 1_000_000_000;

    /// A sample at a second: a translation along x, and a rotation about z.
    fn sample(second: u64, x_m: f64, yaw: f64) -> TimedTransform {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let moment = Moment { stamp_ns: Some((second * SECOND_NS).cast_signed()), log_ns: 0 };
        TimedTransform { moment, transform: Isometry3::from_parts(Translation3::new(x_m, 0.0, 0.0), rotation) }
    }

    fn link(is_fixed: bool, samples: &[TimedTransform]) -> Link {
        Link { parent: String::new(), child: String::new(), samples: samples.to_vec(), is_fixed }
    }

    #[test]
    fn transforms_are_interpolated_between_their_times() {
        // The map turns the odometry by 90° within 4 s, while the robot stays 2 m ahead; the antenna is 1 m before it.
        let map = link(false, &[sample(10, 0.0, 0.0), sample(14, 0.0, FRAC_PI_2)]);
        let robot: Vec<TimedTransform> = (9..=15).map(|second| sample(second, 2.0, 0.0)).collect();
        let chain = Chain { links: vec![map, link(false, &robot), link(true, &[sample(0, 1.0, 0.0)])] };
        let positions = chain.positions(BagClock::Stamp);
        let times: Vec<u64> = positions.iter().map(|(time, _)| time.as_nanos() / SECOND_NS).collect();
        assert_eq!(times, [10, 11, 12, 13, 14], "where all transforms are known");
        for (time, position) in positions {
            let angle = (time.as_secs_f64() - 10.0) / 4.0 * FRAC_PI_2;
            let expected = Position::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0);
            assert!(position.distance_m(expected) < 1e-12, "{position} at {time}");
        }
    }

    #[test]
    fn opposite_rotations_and_late_transforms_have_an_answer() {
        let turning = link(false, &[sample(2, 0.0, PI), sample(0, 0.0, 0.0)]);
        let chain = Chain { links: vec![turning, link(false, &[sample(1, 2.0, 0.0), sample(2, 2.0, 0.0)])] };
        let positions = chain.positions(BagClock::Stamp);
        assert!(!positions.is_empty());
        assert!(positions.iter().all(|(_, position)| position.is_within_reason()), "{positions:?}");
    }

    #[test]
    fn the_frames_between_the_fixed_one_and_the_robot_are_found() {
        let parents: BTreeMap<String, String> = [("base_link", "odom"), ("odom", "map"), ("camera", "base_link")]
            .map(|(child, parent)| (child.to_owned(), parent.to_owned()))
            .into();
        let pairs_of = |child: Option<&str>, fixed: Option<&str>| {
            let options = BagOptions {
                child_frame: child.map(str::to_owned),
                fixed_frame: fixed.map(str::to_owned),
                ..BagOptions::default()
            };
            let frames = |pairs: Vec<(String, String)>| {
                pairs.iter().map(|(parent, child)| format!("{parent}/{child}")).collect::<Vec<_>>().join(" ")
            };
            pairs(&parents, &options).map(frames)
        };
        assert_eq!(pairs_of(None, None).as_deref(), Ok("map/odom odom/base_link"));
        assert_eq!(pairs_of(Some("/camera"), Some("odom")).as_deref(), Ok("odom/base_link base_link/camera"));
        for (child, fixed, problem) in [
            (Some("laser"), None, "no transform leads to frame `laser`"),
            (None, Some("camera"), "frame `camera` is not above frame `base_link`"),
            (None, Some("base_link"), "option `fixed_frame` and the frame of the robot are both `base_link`"),
        ] {
            let found = pairs_of(child, fixed).unwrap_err();
            assert!(found.starts_with(problem), "{found}");
        }
    }
}
