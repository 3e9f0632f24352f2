//! The transmit queue: how many frames wait, in which order they leave, and which are not taken.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{Destination, FrameId, Packets, SendError, SendOutcome};

use crate::network::{self, Ended};
use crate::scripted::Scripted;

const SENDER: StationId = StationId(0);
const LISTENER: StationId = StationId(1);

/// Two nodes within reach of each other; `sender` runs on the first one, and `queue_frames` wait.
fn run(sender: Scripted, queue_frames: u16) -> Ended<Scripted> {
    let places = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0)];
    let link = network::link(2.0, CsmaConfig { queue_frames, ..network::prompt() });
    network::run(network::engine(&places, link, 5), vec![sender, Scripted::listener()])
}

/// A sender of `count` frames at the same instant; each has its number as payload.
fn burst(count: u8, to: Destination) -> Scripted {
    (0..count).fold(Scripted::listener(), |sender, number| sender.and_sends(Duration::ZERO, to, &[number]))
}

#[test]
fn one_frame_more_than_the_queue_holds_is_refused_and_the_others_leave_in_order() {
    for to in [Destination::All, Destination::Station(LISTENER)] {
        let ended = run(burst(6, to), 3);
        let [sender, listener] = &ended.applications[..] else { panic!("two stations") };
        let full = Err(SendError::QueueFull(3));
        // One under way, three that wait.
        let taken = [0, 1, 2, 3].map(|number| Ok(FrameId(number)));
        assert_eq!(sender.answers, [&taken[..], &[full; 2]].concat());
        assert_eq!(listener.payloads(), [[0], [1], [2], [3]]);
        let reported: Vec<FrameId> = sender.reports.iter().map(|(_, report)| report.frame).collect();
        assert_eq!(reported, [0, 1, 2, 3].map(FrameId));
        let expected = Packets {
            offered: 6,
            sent: 4,
            received: 4,
            lost_queue: 2,
            transmissions: 4,
            assessments: 4,
            octets_received: 4,
            ..Packets::default()
        };
        assert_eq!(ended.networks[0].packets[SENDER.index()], expected);
    }
}

#[test]
fn frames_of_a_queue_leave_one_interframe_spacing_apart() {
    // CCA, turnaround, then 12 octets of MPDU and 6 before it: 128 + 192 + 576 us; 192 us of short spacing.
    let ended = run(burst(3, Destination::All), 2);
    let ends: Vec<u64> = ended.applications[0].reports.iter().map(|(at, _)| at.as_nanos() / 1000).collect();
    assert_eq!(ends, [896, 2 * 896 + 192, 3 * 896 + 2 * 192]);
    // An acknowledgement takes a turnaround and 352 us, and the spacing begins after it.
    let ended = run(burst(3, Destination::Station(LISTENER)), 2);
    let ends: Vec<u64> = ended.applications[0].reports.iter().map(|(at, _)| at.as_nanos() / 1000).collect();
    let one = 896 + 192 + 352;
    assert_eq!(ends, [one, 2 * one + 192, 3 * one + 2 * 192]);
}

#[test]
fn without_a_queue_a_frame_is_refused_only_while_another_one_is_under_way() {
    let sender = burst(2, Destination::All).and_sends(Duration::from_millis(2), Destination::All, &[9]);
    let ended = run(sender, 0);
    assert_eq!(ended.applications[0].answers, [Ok(FrameId(0)), Err(SendError::QueueFull(0)), Ok(FrameId(2))]);
    assert_eq!(ended.applications[1].payloads(), [[0], [9]]);
}

#[test]
fn the_largest_payload_is_taken_and_one_octet_more_is_not() {
    for to in [Destination::All, Destination::Station(LISTENER)] {
        let sender = Scripted::listener()
            .and_sends(Duration::ZERO, to, &[7; 116])
            .and_sends(Duration::from_millis(50), to, &[7; 117])
            .and_sends(Duration::from_millis(100), to, &[7; 300])
            .and_sends(Duration::from_millis(150), to, &[]);
        let ended = run(sender, 0);
        let oversized = |found| Err(SendError::Oversized { found, allowed: 116 });
        // A frame that is not taken has no number, and is not counted.
        assert_eq!(ended.applications[0].answers, [Ok(FrameId(0)), oversized(117), oversized(300), Ok(FrameId(1))]);
        assert_eq!(ended.applications[1].payloads(), [&[7; 116][..], &[]]);
        assert_eq!(ended.networks[0].packets[0].offered, 2);
        assert_eq!(ended.networks[0].packets[0].octets_received, 116);
    }
}

#[test]
fn a_frame_to_its_sender_or_to_nobody_is_not_taken() {
    let sender = Scripted::listener()
        .and_sends(Duration::ZERO, Destination::Station(SENDER), b"me")
        .and_sends(Duration::ZERO, Destination::Station(StationId(2)), b"nobody")
        .and_sends(Duration::ZERO, Destination::Station(LISTENER), b"you");
    let ended = run(sender, 0);
    assert_eq!(
        ended.applications[0].answers,
        [Err(SendError::NoSuchStation(SENDER)), Err(SendError::NoSuchStation(StationId(2))), Ok(FrameId(0))]
    );
    assert_eq!(ended.applications[0].reports[0].1.outcome, SendOutcome::Acknowledged);
    assert_eq!(ended.networks[0].packets[0].offered, 1);
}
