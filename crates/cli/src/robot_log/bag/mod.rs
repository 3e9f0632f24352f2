//! ROS bags as logs of real robots: MCAP files, and folders of `ros2 bag record`.
//!
//! Input: a bag with the path of the robot (poses, or transforms between frames) and with the packets that it received, in
//! messages of any type. The type is read from the bag. Output: a reception log. Bags are read several times from start to
//! end, with one chunk in memory: first their topics, then the poses, then the packets.

mod body;
mod clock;
mod definition;
mod files;
mod fixes;
mod leaves;
mod obvious;
mod packets;
mod poses;
mod selection;
mod topics;
mod transforms;

use std::path::Path as FilePath;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use self::clock::{LeastDelay, Moment};
use self::fixes::Fixes;
use self::packets::PacketSource;
use self::poses::{PoseSource, TimedPosition};
use self::topics::Bag;
use self::transforms::Chain;
use super::bag_error::BagError;
use super::bag_options::BagClock;
use super::error::RobotLogError;
use super::gatherer::Gatherer;
use super::local_plane::LocalPlane;
use super::log::RobotLog;
use super::options::ReadOptions;
use super::packet::Packet;
use super::path::{Path, Pose};

/// Whether the file or folder `path` is a ROS bag, in a format that can be read or not.
#[must_use]
pub(super) fn is_bag(path: &FilePath) -> bool {
    files::is_foreign_bag(path) || (path.is_file() && topics::is_bag_file(path))
}

/// Reads the bag `path`.
///
/// # Errors
/// If it cannot be read, has no path of a robot or no packets, or `options` do not fit it.
pub(super) fn read(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let bag = Bag::open(path)?;
    let poses = PoseSource::choose(&bag, &options.bag)?;
    let packets = PacketSource::choose(&bag, &options.bag)?;
    let track = Track::read(&bag, poses, options)?;
    let clock = match options.bag.bag_clock {
        Some(clock) => clock,
        None if track.has_stamps() && packets.has_stamps() => BagClock::Stamp,
        None => BagClock::Log,
    };
    let path_of_robot = track.path(&bag, poses, clock)?;
    let mut gatherer = Gatherer::new(path_of_robot, options)?;
    let mut delay = LeastDelay::default();
    let mut nameless = 0_u64;
    bag.messages::<RobotLogError>(|message| {
        if message.topic != packets.topic.name {
            return Ok(());
        }
        let visited = packets.packets(message.log_ns, message.data, |packet| {
            delay.take(packet.moment);
            if packet.node.is_empty() {
                nameless += 1;
                return Ok(());
            }
            let time = time(&bag, &packets.topic.name, packet.moment, clock)?;
            let (rssi_dbm, sector) = (packet.rssi_dbm, packet.sector);
            gatherer.take(Packet { rssi_dbm, sector, ..Packet::new(time, packet.node) })
        });
        visited.map_err(|problem| bag.topic_problem(&packets.topic.name, problem))?
    })?;
    let mut log = gatherer.finish()?;
    let mut notes = bag.notes.clone();
    notes.push(described(&track, poses, &packets, clock));
    if let Track::Fixes(Fixes { missing: missing @ 1.., .. }) = &track {
        notes.push(format!("{missing} messages of `{}` without a fix are skipped", poses.topic().name));
    }
    if let (PoseSource::Poses(..), Some(transforms)) = (poses, bag.topics().find(|topic| topic.name == "/tf")) {
        notes.push(format!(
            "odometry drifts: if the transforms of `{0}` are corrected by a map, give `--pose-topic {0}`",
            transforms.name
        ));
    }
    if nameless > 0 {
        notes.push(format!("{nameless} packets without the name of a node are skipped"));
    }
    if clock == BagClock::Stamp {
        notes.extend(track.least_delay().differs(delay));
    }
    notes.append(&mut log.notes);
    Ok(RobotLog { notes, plane: track.plane(), ..log })
}

/// What is read, for people.
fn described(track: &Track, poses: PoseSource<'_>, packets: &PacketSource<'_>, clock: BagClock) -> String {
    let pose_topic = poses.topic();
    let frames = match track {
        Track::Positions(_) | Track::Fixes(_) => pose_topic.message_type.clone(),
        Track::Transforms(chain) => chain.frames(),
    };
    let times = match clock {
        BagClock::Stamp => "the stamps of the messages",
        BagClock::Log => "when the messages were recorded",
    };
    let (topic, fields) = (packets.topic, &packets.fields);
    format!(
        "the path is that of `{}` ({frames}), the packets are those of `{}` ({}; {fields}), the times are {times}",
        pose_topic.name, topic.name, topic.message_type
    )
}

/// Where the robot was.
enum Track {
    Positions(Vec<TimedPosition>),
    Transforms(Chain),
    Fixes(Fixes),
}

impl Track {
    fn read(bag: &Bag, source: PoseSource<'_>, options: &ReadOptions) -> Result<Self, BagError> {
        match source {
            PoseSource::Poses(topic, position) => poses::read(bag, topic, position).map(Self::Positions),
            PoseSource::Transforms(topic) => Chain::read(bag, topic, &options.bag).map(Self::Transforms),
            PoseSource::Fixes(topic) => fixes::read(bag, topic, options.repair.skip_no_fix).map(Self::Fixes),
        }
    }

    /// The plane of its places, if they are given by latitude and longitude.
    fn plane(&self) -> Option<LocalPlane> {
        match self {
            Self::Positions(_) | Self::Transforms(_) => None,
            Self::Fixes(fixes) => fixes.plane,
        }
    }

    fn has_stamps(&self) -> bool {
        match self {
            Self::Positions(all) | Self::Fixes(Fixes { positions: all, .. }) => {
                all.iter().all(|pose| pose.moment.time(BagClock::Stamp).is_some())
            }
            Self::Transforms(chain) => chain.has_stamps(),
        }
    }

    fn least_delay(&self) -> LeastDelay {
        match self {
            Self::Positions(all) | Self::Fixes(Fixes { positions: all, .. }) => {
                let mut least = LeastDelay::default();
                all.iter().for_each(|pose| least.take(pose.moment));
                least
            }
            Self::Transforms(chain) => chain.least_delay(),
        }
    }

    fn path(&self, bag: &Bag, source: PoseSource<'_>, clock: BagClock) -> Result<Path, RobotLogError> {
        let topic = &source.topic().name;
        let pose = |(time, position): (SimTime, Position)| Pose { time, position };
        let poses: Vec<Pose> = match self {
            Self::Positions(all) | Self::Fixes(Fixes { positions: all, .. }) => {
                let timed = |at: &TimedPosition| Ok(pose((time(bag, topic, at.moment, clock)?, at.position)));
                all.iter().map(timed).collect::<Result<_, BagError>>()?
            }
            Self::Transforms(chain) if clock == BagClock::Stamp && !chain.has_stamps() => {
                return Err(bag.topic_problem(topic, UNSTAMPED).into());
            }
            Self::Transforms(chain) => chain.positions(clock).into_iter().map(pose).collect(),
        };
        Path::new(poses).map_err(|why| bag.topic_problem(topic, why.to_string()).into())
    }
}

const UNSTAMPED: &str = "a message has no stamp, or the stamp 0; give `--bag-clock log`";

fn time(bag: &Bag, topic: &str, moment: Moment, clock: BagClock) -> Result<SimTime, BagError> {
    moment.time(clock).ok_or_else(|| bag.topic_problem(topic, UNSTAMPED))
}
