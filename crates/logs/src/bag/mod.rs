//! ROS bags as logs of real robots: files in MCAP or SQLite, and folders of `ros2 bag record`.
//!
//! Input: a bag with the path of the robot (poses, or transforms between frames) and with the packets that it received, in
//! messages of any type. The type is read from the bag. Output: a reception log. Bags are read several times from start to
//! end, with one chunk in memory: first their topics, then the poses, then the packets.

mod body;
mod clock;
mod definition;
mod field_path;
mod files;
mod fixes;
mod leaves;
mod obvious;
mod packet_fields;
mod packets;
mod poses;
mod selection;
#[cfg(feature = "sqlite-bags")]
mod sqlite;
#[cfg(feature = "sqlite-bags")]
mod standard_types;
mod topics;
mod transforms;

use std::path::Path as FilePath;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use self::clock::Moment;
use self::fixes::Fixes;
use self::packet_fields::PacketFields;
use self::packets::{BagPacket, PacketSource, Sought};
use self::poses::{PoseSource, TimedPosition};
use self::transforms::Chain;
use crate::error::bag_error::BagError;
use crate::error::robot_log_error::RobotLogError;
use crate::options::bag_options::BagClock;
use crate::options::read_options::ReadOptions;
use crate::packets::gatherer::Gatherer;
use crate::packets::packet::Packet;
use crate::packets::reciprocal::Roles;
use crate::path::robot_path::{Path, Pose};
use crate::place::local_plane::LocalPlane;
use crate::place::without_fix::leave_out;

pub(super) use self::clock::LeastDelay;
pub(super) use self::topics::Bag;

/// Whether the file or folder `path` is a ROS bag, in a format that can be read or not.
#[must_use]
pub(super) fn is_bag(path: &FilePath) -> bool {
    files::is_foreign_bag(path) || (path.is_file() && topics::is_bag_file(path))
}

/// Whether the folder `path` holds a bag for certain: MCAP files may be recordings of other programs.
#[must_use]
pub(super) fn holds_bag(path: &FilePath) -> bool {
    files::mcap_files(path).iter().any(|file| topics::is_bag_file(file)) || files::holds_other_bag(path)
}

/// The path of the robot in a bag.
pub(super) struct BagPath<'a> {
    bag: &'a Bag,
    source: PoseSource<'a>,
    track: BagTrack,
    /// Whether places that are no fix are left out.
    skips_no_fix: bool,
}

impl<'a> BagPath<'a> {
    /// Reads the poses that `options` name, or the only ones.
    ///
    /// # Errors
    /// If the bag cannot be read, has no such poses, or `options` do not fit them.
    pub(super) fn read(bag: &'a Bag, options: &ReadOptions) -> Result<Self, BagError> {
        let source = PoseSource::choose(bag, &options.bag)?;
        let track = BagTrack::read(bag, source, options)?;
        Ok(Self { bag, source, track, skips_no_fix: options.repair.skip_no_fix })
    }

    /// Whether all poses have stamps.
    pub(super) fn has_stamps(&self) -> bool {
        self.track.has_stamps()
    }

    /// The path by `clock`.
    ///
    /// # Errors
    /// If the poses are no path, or have no stamps.
    pub(super) fn path(&self, clock: BagClock, notes: &mut Vec<String>) -> Result<Path, RobotLogError> {
        let mut poses = self.track.poses(self.bag, self.source, clock)?;
        let topic = &self.source.topic().name;
        // Of fixes, the messages themselves told.
        let left_out = if self.skips_no_fix && self.plane().is_none() {
            leave_out(&mut poses, |pose| (pose.time, pose.position))
        } else {
            0
        };
        if left_out > 0 {
            notes.push(format!("{left_out} poses of `{topic}` without a fix are left out (option `skip_no_fix`)"));
        }
        Path::new(poses).map_err(|why| self.bag.topic_problem(topic, why.to_string()).into())
    }

    /// The plane of its places, if they are given by latitude and longitude.
    pub(super) fn plane(&self) -> Option<LocalPlane> {
        self.track.plane()
    }

    /// The least delay of its stamps.
    pub(super) fn least_delay(&self) -> LeastDelay {
        self.track.least_delay()
    }

    /// What gives it, for people.
    pub(super) fn described(&self) -> String {
        let topic = self.source.topic();
        let frames = match &self.track {
            BagTrack::Positions(_) | BagTrack::Fixes(_) => topic.message_type.clone(),
            BagTrack::Transforms(chain) => chain.frames(),
        };
        format!("`{}` ({frames})", topic.name)
    }

    /// What the user should know of it.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let BagTrack::Fixes(Fixes { missing: missing @ 1.., .. }) = &self.track {
            notes.push(format!("{missing} messages of `{}` without a fix are skipped", self.source.topic().name));
        }
        let transforms = || self.bag.topics().find(|topic| topic.name == "/tf");
        if let (PoseSource::Poses(..), Some(transforms)) = (self.source, transforms()) {
            notes.push(format!(
                "odometry drifts: if the transforms of `{0}` are corrected by a map, give `pose_topic={0}`",
                transforms.name
            ));
        }
        notes
    }
}

/// The packets in a bag.
pub(super) struct BagPackets<'a> {
    bag: &'a Bag,
    source: PacketSource<'a>,
}

impl<'a> BagPackets<'a> {
    /// The packets that `options` name, or the only ones.
    ///
    /// # Errors
    /// If the bag has no such packets, or lacks a field.
    pub(super) fn choose(bag: &'a Bag, options: &ReadOptions) -> Result<Self, RobotLogError> {
        let fields = PacketFields::of(&options.form)?;
        let source = PacketSource::choose(
            bag,
            Sought {
                what: "packets",
                topic: options.bag.packet_topic.as_ref(),
                topic_option: "packet_topic",
                fields: fields.as_ref(),
                fields_option: "packet_fields=node=PATH[,rssi_dbm=PATH]",
            },
        )?;
        if options.form.lora && source.fields.snr_db.is_none() {
            let problem = "option `lora` needs the field of the signal-to-noise ratio: give `packet_fields=node=PATH,rssi_dbm=PATH,\
                           snr_db=PATH`";
            return Err(bag.topic_problem(&source.topic.name, problem).into());
        }
        Ok(Self { bag, source })
    }

    /// The ranges that `options` name; `None` if they name none.
    ///
    /// # Errors
    /// If the bag has no such ranges, or lacks a field.
    pub(super) fn of_ranges(bag: &'a Bag, options: &ReadOptions) -> Result<Option<Self>, RobotLogError> {
        let fields_option = "range_fields=node=PATH,range_m=PATH";
        let Some(fields) = PacketFields::of_ranges(&options.form)? else {
            return match &options.bag.range_topic {
                Some(topic) => {
                    let problem = format!("option `range_topic` needs the fields of ranges: give `{fields_option}`");
                    Err(bag.topic_problem(topic, problem).into())
                }
                None => Ok(None),
            };
        };
        let sought = Sought {
            what: "ranges",
            topic: options.bag.range_topic.as_ref(),
            topic_option: "range_topic",
            fields: Some(&fields),
            fields_option,
        };
        Ok(Some(Self { bag, source: PacketSource::choose(bag, sought)? }))
    }

    /// Whether the packets have stamps.
    pub(super) fn has_stamps(&self) -> bool {
        self.source.has_stamps()
    }

    /// Gives the ranges to `gatherer`, with times by `clock`.
    ///
    /// # Errors
    /// If a message does not fit its definition or has no stamp, or the files cannot be read.
    pub(super) fn gather_ranges(&self, clock: BagClock, gatherer: &mut Gatherer) -> Result<(), RobotLogError> {
        let Self { bag, source } = self;
        bag.messages::<RobotLogError>(|message| {
            if message.topic != source.topic.name {
                return Ok(());
            }
            let visited = source.packets(message.log_ns, message.data, |packet| {
                let time = time(bag, &source.topic.name, packet.moment, clock)?;
                match packet.range_m {
                    Some(range_m) if !packet.node.is_empty() => gatherer.take_range(time, packet.node, range_m),
                    _ => Ok(()),
                }
            });
            visited.map_err(|problem| bag.topic_problem(&source.topic.name, problem))?
        })
    }

    /// What gives them, for people.
    pub(super) fn described(&self) -> String {
        let PacketSource { topic, fields, .. } = &self.source;
        format!("`{}` ({}; {fields})", topic.name, topic.message_type)
    }

    /// Gives the packets to `gatherer`, with times by `clock`. Returns the least delay of their stamps.
    ///
    /// # Errors
    /// If a message does not fit its definition or has no stamp, or the files cannot be read.
    pub(super) fn gather(
        &self,
        clock: BagClock,
        roles: &mut Roles,
        gatherer: &mut Gatherer,
        notes: &mut Vec<String>,
    ) -> Result<LeastDelay, RobotLogError> {
        let Self { bag, source } = self;
        let mut delay = LeastDelay::default();
        let mut nameless = 0_u64;
        bag.messages::<RobotLogError>(|message| {
            if message.topic != source.topic.name {
                return Ok(());
            }
            let visited = source.packets(message.log_ns, message.data, |packet| {
                delay.take(packet.moment);
                if packet.node.is_empty() {
                    nameless += 1;
                    return Ok(());
                }
                if let (Roles::Turned(transmitter), Some(sender)) = (&mut *roles, packet.sender) {
                    let is_wanted = transmitter.is_the_one(sender);
                    if !is_wanted.map_err(|problem| bag.topic_problem(&source.topic.name, problem))? {
                        return Ok(());
                    }
                }
                let time = time(bag, &source.topic.name, packet.moment, clock)?;
                let BagPacket { rssi_dbm, snr_db, sector, range_m, .. } = packet;
                gatherer.take(Packet { rssi_dbm, snr_db, sector, range_m, ..Packet::new(time, packet.node) })
            });
            visited.map_err(|problem| bag.topic_problem(&source.topic.name, problem))?
        })?;
        if nameless > 0 {
            notes.push(format!("{nameless} packets without the name of a node are skipped"));
        }
        Ok(delay)
    }
}

/// Where the robot was.
enum BagTrack {
    Positions(Vec<TimedPosition>),
    Transforms(Chain),
    Fixes(Fixes),
}

impl BagTrack {
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

    fn poses(&self, bag: &Bag, source: PoseSource<'_>, clock: BagClock) -> Result<Vec<Pose>, RobotLogError> {
        let topic = &source.topic().name;
        let pose = |(time, position): (SimTime, Position)| Pose { time, position };
        Ok(match self {
            Self::Positions(all) | Self::Fixes(Fixes { positions: all, .. }) => {
                let timed = |at: &TimedPosition| Ok(pose((time(bag, topic, at.moment, clock)?, at.position)));
                all.iter().map(timed).collect::<Result<_, BagError>>()?
            }
            Self::Transforms(chain) if clock == BagClock::Stamp && !chain.has_stamps() => {
                return Err(bag.topic_problem(topic, UNSTAMPED).into());
            }
            Self::Transforms(chain) => chain.positions(clock).into_iter().map(pose).collect(),
        })
    }
}

const UNSTAMPED: &str = "a message has no stamp, or the stamp 0; give `bag_clock=log`";

fn time(bag: &Bag, topic: &str, moment: Moment, clock: BagClock) -> Result<SimTime, BagError> {
    moment.time(clock).ok_or_else(|| bag.topic_problem(topic, UNSTAMPED))
}
