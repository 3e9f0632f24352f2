//! The messages of a target search, as octets.

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::TargetId;

use crate::navigation::{Answer, FloodKey, Request};
use crate::octets::{MessageError, Reader, put, put_place, put_station};

const VERSION: u8 = 1;

const REQUEST: u8 = 1;
const ANSWER: u8 = 2;
const TREE: u8 = 3;
const DETECTION: u8 = 4;
const ALARM: u8 = 5;
const CLAIM: u8 = 6;
const GRADIENT: u8 = 7;
const DOUBTED_ALARM: u8 = 8;

/// Largest payload of a message (octets): it fits into a frame beside its header.
pub(super) const LARGEST_OCTETS: usize = 102;
/// Octets of a detection in an ANSWER.
const DETECTION_OCTETS: usize = 10;
/// Octets of a target in a CLAIM.
const CLAIM_OCTETS: usize = 7;
/// The time of leaving of a target that is still there.
const STILL: u32 = u32::MAX;

/// A message, as octets in this layout.
///
/// All numbers are little-endian. Times are in milliseconds from the start; `f32` is IEEE 754 binary32. The first octet
/// has the version (1) in the high four bits and the kind in the low four. The sender is the source address of the
/// frame.
///
/// | kind | octets after the first |
/// | --- | --- |
/// | 1 REQUEST | a [`Request`] |
/// | 2 ANSWER | an [`Answer`]; then for each detection: 2 target, 4 time of entering, 4 time of leaving (4294967295: still there) |
/// | 3 TREE | 4 origin, 2 number, 1 hops from the sink to the sender |
/// | 4 DETECTION | 4 node that detected, 2 target, 4 time, 12 place of the node on the map: x, y, z as `f32` |
/// | 5 ALARM | 4 origin, 2 number, 2 target, 4 time, 12 place on the map: x, y, z as `f32` |
/// | 6 CLAIM | 4 origin, 2 number; then for each target: 2 target, 1 state (0 sought, 1 captured), 4 seconds to its interception as `f32` |
/// | 7 GRADIENT | 2 round, 2 target, 1 hops to a node that detects the target, 4 pseudo-gradient of the sender as `f32`, 4 when the newest of these nodes detected it |
/// | 8 ALARM of doubted detections | as 5; then 1 number of nodes that detected the target together |
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Message {
    /// A robot asks the nodes around it.
    Request(Request),
    /// A node answers a robot: when it detected which targets.
    Answer(Answer, Vec<Detection>),
    /// The way to a sink: how many hops the sender is away from it.
    Tree {
        /// Which message it is.
        key: FloodKey,
        /// Hops from the sink to the sender.
        hops: u8,
    },
    /// A node tells the sink that it detected a target that was unknown.
    Detection(FirstDetection),
    /// A sink tells all robots where and when a target was detected first.
    Alarm {
        /// Which message it is.
        key: FloodKey,
        /// The target.
        target: TargetId,
        /// When it was detected first.
        time: SimTime,
        /// Where it was detected first, on the map (m).
        place: Position,
        /// Number of nodes that detected it together, where detections are doubted.
        nodes: Option<u8>,
    },
    /// A robot tells the other robots which targets it can reach when, and which ones it has captured.
    Claim {
        /// Which message it is.
        key: FloodKey,
        /// What it knows of each target.
        targets: Vec<(TargetId, Claim)>,
    },
    /// A node passes the pseudo-gradient of a target on.
    Gradient(GradientMessage),
}

/// When a node detected a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Detection {
    /// The target.
    pub target: TargetId,
    /// When it entered the radius of detection.
    pub entered: SimTime,
    /// When it left it; `None` if it is still there.
    pub left: Option<SimTime>,
}

/// A node detected a target that was unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FirstDetection {
    /// The node that detected it.
    pub node: StationId,
    /// The target.
    pub target: TargetId,
    /// When.
    pub time: SimTime,
    /// Place of the node on the map (m).
    pub place: Position,
}

/// What a robot says of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Claim {
    /// It seeks the target and would meet it in this time (s).
    Sought(f64),
    /// It has captured the target.
    Captured,
}

/// The pseudo-gradient of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GradientMessage {
    /// Number of the round: a new one begins whenever the target has moved.
    pub round: u16,
    /// The target.
    pub target: TargetId,
    /// Hops from the sender to a node that detects the target.
    pub hops: u8,
    /// The pseudo-gradient: hops, less the closeness to nodes that are one hop nearer.
    pub value: f64,
    /// When the newest of the detecting nodes so many hops away detected the target.
    pub detected: SimTime,
}

/// A time to whole milliseconds.
fn put_time(octets: &mut Vec<u8>, time: SimTime) {
    let milliseconds = u32::try_from(time.as_nanos() / 1_000_000).unwrap_or(STILL - 1);
    octets.extend(milliseconds.to_le_bytes());
}

fn time_of(milliseconds: u32) -> SimTime {
    SimTime::ZERO + std::time::Duration::from_millis(milliseconds.into())
}

fn put_key(octets: &mut Vec<u8>, key: FloodKey) {
    put_station(octets, key.origin);
    octets.extend(key.number.to_le_bytes());
}

fn key(reader: &mut Reader<'_>) -> Result<FloodKey, MessageError> {
    let part = "the origin";
    Ok(FloodKey { origin: reader.station(part)?, number: reader.u16(part)? })
}

fn time(reader: &mut Reader<'_>) -> Result<SimTime, MessageError> {
    Ok(time_of(reader.u32("the time")?))
}

fn target(reader: &mut Reader<'_>) -> Result<TargetId, MessageError> {
    Ok(TargetId(reader.u16("the target")?))
}

impl Message {
    /// Most detections in an ANSWER.
    pub(crate) const MOST_DETECTIONS: usize = (LARGEST_OCTETS - 1 - Answer::OCTETS) / DETECTION_OCTETS;
    /// Most targets in a CLAIM.
    pub(crate) const MOST_CLAIMS: usize = (LARGEST_OCTETS - 7) / CLAIM_OCTETS;

    /// The octets of the message.
    #[must_use]
    pub(crate) fn to_octets(&self) -> Vec<u8> {
        let mut octets = Vec::with_capacity(LARGEST_OCTETS);
        let kind = match self {
            Self::Request(_) => REQUEST,
            Self::Answer(..) => ANSWER,
            Self::Tree { .. } => TREE,
            Self::Detection(_) => DETECTION,
            Self::Alarm { nodes: None, .. } => ALARM,
            Self::Alarm { nodes: Some(_), .. } => DOUBTED_ALARM,
            Self::Claim { .. } => CLAIM,
            Self::Gradient(_) => GRADIENT,
        };
        octets.push(VERSION << 4 | kind);
        match self {
            Self::Request(request) => request.write(&mut octets),
            Self::Answer(answer, detections) => {
                answer.write(&mut octets);
                for Detection { target, entered, left } in detections {
                    octets.extend(target.0.to_le_bytes());
                    put_time(&mut octets, *entered);
                    match left {
                        Some(left) => put_time(&mut octets, *left),
                        None => octets.extend(STILL.to_le_bytes()),
                    }
                }
            }
            Self::Tree { key, hops } => {
                put_key(&mut octets, *key);
                octets.push(*hops);
            }
            Self::Detection(FirstDetection { node, target, time, place }) => {
                put_station(&mut octets, *node);
                octets.extend(target.0.to_le_bytes());
                put_time(&mut octets, *time);
                put_place(&mut octets, *place);
            }
            Self::Alarm { key, target, time, place, nodes } => {
                put_key(&mut octets, *key);
                octets.extend(target.0.to_le_bytes());
                put_time(&mut octets, *time);
                put_place(&mut octets, *place);
                octets.extend(nodes);
            }
            Self::Claim { key, targets } => {
                put_key(&mut octets, *key);
                for (target, claim) in targets {
                    octets.extend(target.0.to_le_bytes());
                    let (state, seconds) = match claim {
                        Claim::Sought(seconds) => (0, *seconds),
                        Claim::Captured => (1, 0.0),
                    };
                    octets.push(state);
                    put(&mut octets, seconds);
                }
            }
            Self::Gradient(GradientMessage { round, target, hops, value, detected }) => {
                octets.extend(round.to_le_bytes());
                octets.extend(target.0.to_le_bytes());
                octets.push(*hops);
                put(&mut octets, *value);
                put_time(&mut octets, *detected);
            }
        }
        octets
    }

    /// Reads a message.
    ///
    /// # Errors
    /// If the octets are not a message.
    pub(crate) fn read(octets: &[u8]) -> Result<Self, MessageError> {
        let mut reader = Reader::new(octets);
        let [first] = reader.take("the header")?;
        if first >> 4 != VERSION {
            return Err(MessageError::Version(first >> 4));
        }
        let reader = &mut reader;
        let message = match first & 0xF {
            REQUEST => Self::Request(Request::read(reader)?),
            ANSWER => {
                let answer = Answer::read(reader)?;
                let mut detections = Vec::with_capacity(reader.left() / DETECTION_OCTETS);
                while reader.left() > 0 {
                    let (target, entered) = (target(reader)?, time(reader)?);
                    let left = reader.u32("the time")?;
                    detections.push(Detection { target, entered, left: (left != STILL).then(|| time_of(left)) });
                }
                Self::Answer(answer, detections)
            }
            TREE => {
                let key = key(reader)?;
                let [hops] = reader.take("the hops")?;
                Self::Tree { key, hops }
            }
            DETECTION => Self::Detection(FirstDetection {
                node: reader.station("the node")?,
                target: target(reader)?,
                time: time(reader)?,
                place: reader.place("the place")?,
            }),
            kind @ (ALARM | DOUBTED_ALARM) => {
                let (key, target, time) = (key(reader)?, target(reader)?, time(reader)?);
                let place = reader.place("the place")?;
                let nodes = (kind == DOUBTED_ALARM).then(|| reader.take("the number of nodes")).transpose()?;
                Self::Alarm { key, target, time, place, nodes: nodes.map(|[nodes]| nodes) }
            }
            CLAIM => {
                let key = key(reader)?;
                let mut targets = Vec::with_capacity(reader.left() / CLAIM_OCTETS);
                while reader.left() > 0 {
                    let target = target(reader)?;
                    let [state] = reader.take("the state")?;
                    let seconds = reader.number("the time of interception")?;
                    targets.push((target, if state == 1 { Claim::Captured } else { Claim::Sought(seconds) }));
                }
                Self::Claim { key, targets }
            }
            GRADIENT => {
                let (round, target) = (reader.u16("the round")?, target(reader)?);
                let [hops] = reader.take("the hops")?;
                let value = reader.number("the pseudo-gradient")?;
                Self::Gradient(GradientMessage { round, target, hops, value, detected: time(reader)? })
            }
            found => return Err(MessageError::Kind { found, allowed: "1 to 8" }),
        };
        reader.end()?;
        Ok(message)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use proptest::prelude::*;
    use sextant_channel::Dbm;

    use super::*;
    use crate::navigation::any as polls;

    fn target() -> impl Strategy<Value = TargetId> {
        any::<u16>().prop_map(TargetId)
    }

    fn time() -> impl Strategy<Value = SimTime> {
        (0..STILL).prop_map(time_of)
    }

    fn key() -> impl Strategy<Value = FloodKey> {
        (any::<u32>(), any::<u16>()).prop_map(|(origin, number)| FloodKey { origin: StationId(origin), number })
    }

    fn message() -> impl Strategy<Value = Message> {
        let detection = (target(), time(), prop::option::of(time())).prop_map(|(target, entered, left)| Detection {
            target,
            entered,
            left,
        });
        let detections = prop::collection::vec(detection, 0..=Message::MOST_DETECTIONS);
        let claim = prop_oneof![polls::number().prop_map(Claim::Sought), Just(Claim::Captured)];
        let claims = prop::collection::vec((target(), claim), 0..=Message::MOST_CLAIMS);
        prop_oneof![
            polls::request().prop_map(Message::Request),
            (polls::answer(), detections).prop_map(|(answer, detections)| Message::Answer(answer, detections)),
            (key(), any::<u8>()).prop_map(|(key, hops)| Message::Tree { key, hops }),
            (any::<u32>(), target(), time(), polls::place()).prop_map(|(node, target, time, place)| {
                Message::Detection(FirstDetection { node: StationId(node), target, time, place })
            }),
            (key(), target(), time(), polls::place(), any::<Option<u8>>())
                .prop_map(|(key, target, time, place, nodes)| Message::Alarm { key, target, time, place, nodes }),
            (key(), claims).prop_map(|(key, targets)| Message::Claim { key, targets }),
            (any::<u16>(), target(), any::<u8>(), polls::number(), time()).prop_map(
                |(round, target, hops, value, detected)| {
                    Message::Gradient(GradientMessage { round, target, hops, value, detected })
                }
            ),
        ]
    }

    proptest! {
        #[test]
        fn a_message_reads_as_it_was_written(message in message()) {
            let octets = message.to_octets();
            prop_assert!(octets.len() <= LARGEST_OCTETS);
            prop_assert_eq!(Message::read(&octets), Ok(message));
        }

        #[test]
        fn cut_messages_are_errors_or_shorter_messages(message in message(), at in 0_usize..200) {
            let octets = message.to_octets();
            let cut = &octets[..at % octets.len()];
            if let Ok(read) = Message::read(cut) {
                prop_assert_eq!(read.to_octets(), cut);
            }
        }
    }

    #[test]
    fn the_octets_of_an_answer_are_those_of_the_table() {
        let answer = Answer { number: 0x0102, place: Position::new(1.0, 0.0, 0.0), tx_power: Dbm(-50.0) };
        let at = |seconds| SimTime::ZERO + Duration::from_secs(seconds);
        let detections = vec![Detection { target: TargetId(3), entered: at(1), left: None }];
        let octets = Message::Answer(answer, detections).to_octets();
        let mut expected = vec![0x12, 0x02, 0x01, 0, 0, 0x80, 0x3F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x48, 0xC2];
        expected.extend([3, 0, 0xE8, 0x03, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
        assert_eq!(octets, expected);
    }

    #[test]
    fn what_is_no_message_says_why() {
        assert_eq!(Message::read(&[]), Err(MessageError::Truncated { octets: 0, part: "the header" }));
        assert_eq!(Message::read(&[0x21]), Err(MessageError::Version(2)));
        assert_eq!(Message::read(&[0x19]), Err(MessageError::Kind { found: 9, allowed: "1 to 8" }));
    }
}
