//! The path of the robot from a topic of poses.

use sextant_channel::Position;

use super::clock::Moment;
use super::field_path::FieldPath;
use super::selection::{Selection, Value};
use super::topics::{Bag, Topic};
use super::transforms;
use crate::error::bag_error::BagError;
use crate::options::bag_options::BagOptions;

/// The types of messages with one pose in the frame of a map, and the path of its position.
const POSE_TYPES: [(&str, &str); 3] = [
    ("nav_msgs/Odometry", "pose.pose.position"),
    ("geometry_msgs/PoseStamped", "pose.position"),
    ("geometry_msgs/PoseWithCovarianceStamped", "pose.pose.position"),
];

/// The type of messages with latitude and longitude.
const FIX_TYPE: &str = "sensor_msgs/NavSatFix";

/// Where the robot was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimedPosition {
    pub(super) moment: Moment,
    pub(super) position: Position,
}

/// What gives the path of the robot.
#[derive(Clone, Copy, Debug)]
pub(super) enum PoseSource<'a> {
    /// A topic of poses, and the path of the position in its messages.
    Poses(&'a Topic, &'static str),
    /// A topic of transforms.
    Transforms(&'a Topic),
    /// A topic of fixes of a satellite receiver.
    Fixes(&'a Topic),
}

impl<'a> PoseSource<'a> {
    /// What `options` name, or the only topic of poses; if there is none, the only topic of transforms or fixes.
    ///
    /// # Errors
    /// If there is no such topic, several, or the options do not fit it.
    pub(super) fn choose(bag: &'a Bag, options: &BagOptions) -> Result<Self, BagError> {
        let candidates: Vec<_> = bag.topics().filter_map(|topic| Some((Self::of(topic)?, topic))).collect();
        let source = match (&options.pose_topic, candidates.as_slice()) {
            (Some(name), _) => {
                let topic = bag.topic(name).ok_or_else(|| {
                    bag.problem(format!(
                        "it has no topic `{name}` with messages; its topics: {}",
                        Bag::list(bag.topics())
                    ))
                })?;
                Self::of(topic).ok_or_else(|| {
                    let found = &topic.message_type;
                    bag.topic_problem(name, format!("its messages are {found}; allowed for a path: {}", allowed()))
                })?
            }
            (None, all) => {
                let poses: Vec<_> = all.iter().filter(|(source, _)| matches!(source, Self::Poses(..))).collect();
                match (poses.as_slice(), all) {
                    ([(only, _)], _) | ([], [(only, _)]) => *only,
                    ([], []) => {
                        let topics = Bag::list(bag.topics());
                        let problem = format!(
                            "no topic gives the path of the robot; allowed: {}; its topics: {topics}",
                            allowed()
                        );
                        return Err(bag.problem(problem));
                    }
                    (_, several) => return Err(Self::ambiguous(bag, several.iter().map(|(_, topic)| *topic))),
                }
            }
        };
        let has_frames = options.child_frame.is_some() || options.fixed_frame.is_some();
        if has_frames && !matches!(source, Self::Transforms(_)) {
            let topic = source.topic();
            let found = &topic.message_type;
            let problem = format!(
                "option `child_frame` and option `fixed_frame` are for transforms, but its messages are {found}"
            );
            return Err(bag.topic_problem(&topic.name, problem));
        }
        Ok(source)
    }

    fn ambiguous(bag: &Bag, topics: impl Iterator<Item = &'a Topic>) -> BagError {
        bag.problem(format!(
            "several topics give the path of a robot; choose one with option `pose_topic`: {}",
            Bag::list(topics)
        ))
    }

    /// What `topic` is, if it can give a path. Fixed transforms cannot.
    fn of(topic: &'a Topic) -> Option<Self> {
        if transforms::is_of_transforms(topic) {
            return (!transforms::is_fixed(topic)).then_some(Self::Transforms(topic));
        }
        if topic.message_type == FIX_TYPE {
            return Some(Self::Fixes(topic));
        }
        let (_, position) = POSE_TYPES.iter().find(|(name, _)| *name == topic.message_type)?;
        Some(Self::Poses(topic, position))
    }

    /// The topic.
    pub(super) const fn topic(self) -> &'a Topic {
        match self {
            Self::Poses(topic, _) | Self::Transforms(topic) | Self::Fixes(topic) => topic,
        }
    }
}

fn allowed() -> String {
    let poses = POSE_TYPES.map(|(name, _)| name).join(", ");
    format!("{poses}, {}, {FIX_TYPE}", transforms::MESSAGE_TYPES.join(", "))
}

/// The positions of the messages of `topic`, in their order.
///
/// # Errors
/// If a message does not fit its definition, or a file cannot be read.
pub(super) fn read(bag: &Bag, topic: &Topic, position: &str) -> Result<Vec<TimedPosition>, BagError> {
    let paths =
        ["header.stamp".to_owned(), format!("{position}.x"), format!("{position}.y"), format!("{position}.z")];
    let mut found = Vec::new();
    rows(bag, topic, &paths, |log_ns, row| {
        if let [Value::Instant(stamp_ns), Value::Real(x_m), Value::Real(y_m), Value::Real(z_m)] = *row {
            let moment = Moment { stamp_ns: Some(stamp_ns), log_ns };
            found.push(TimedPosition { moment, position: Position::new(x_m, y_m, z_m) });
        }
        Ok(())
    })?;
    Ok(found)
}

/// Calls `take` with the values at `paths` in each message of `topic`, and when it was recorded (ns).
///
/// # Errors
/// If a message does not fit its definition, or a file cannot be read; or the error of `take`.
pub(super) fn rows(
    bag: &Bag,
    topic: &Topic,
    paths: &[String],
    mut take: impl FnMut(u64, &[Value<'_>]) -> Result<(), String>,
) -> Result<(), BagError> {
    let select = || {
        let paths = paths.iter().map(|path| FieldPath::parse(path)).collect::<Result<Vec<_>, _>>()?;
        Selection::new(topic.definitions()?, &paths)
    };
    let selection = select().map_err(|problem| bag.topic_problem(&topic.name, problem))?;
    bag.messages::<BagError>(|message| {
        if message.topic != topic.name {
            return Ok(());
        }
        let read = selection.rows(message.data, |row| take(message.log_ns, row));
        read.and_then(|visited| visited).map_err(|problem| bag.topic_problem(&topic.name, problem))
    })
}
