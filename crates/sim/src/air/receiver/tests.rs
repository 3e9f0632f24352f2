//! Frames that overlap at one receiver.

use std::time::Duration;

use super::*;
use sextant_channel::{Db, Dbm};

fn rules(model: ReceptionModel) -> ReceptionRules {
    ReceptionRules {
        model,
        sensitivity: Dbm(-90.0).to_milliwatts(),
        noise: Dbm(-90.403).to_milliwatts(),
        preamble: Duration::from_micros(128),
        lock: Db(-5.0).to_factor(),
        carrier: None,
        bit_rate_hz: 250_000.0,
        bit_error_rate: sextant_mac::oqpsk::bit_error_rate,
    }
}

fn at(us: u64) -> SimTime {
    SimTime::ZERO + Duration::from_micros(us)
}

/// Outcomes of frames of 832 us, each (start in us, power in dBm), at one receiver that always listens.
fn fates(model: ReceptionModel, luck: f64, frames: &[(u64, f64)]) -> Vec<FrameOutcome> {
    let rules = rules(model);
    let mut receiver = Receiver::default();
    receiver.start(at(0));
    let mut changes: Vec<(u64, bool, u64)> = Vec::new();
    for (packet, &(start, _)) in (0..).zip(frames) {
        changes.push((start, true, packet));
        changes.push((start + 832, false, packet));
    }
    changes.sort_unstable();
    let mut fates = vec![FrameOutcome::WORST; frames.len()];
    for (us, begins, packet) in changes {
        let frame = frames[usize::try_from(packet).unwrap()];
        if begins {
            receiver.begin(at(us), packet, Dbm(frame.1).to_milliwatts(), None, &rules);
        } else {
            let heard = receiver.end(at(us), packet, &rules, || luck).expect("it began");
            fates[usize::try_from(packet).unwrap()] = heard.outcome;
        }
    }
    fates
}

const CAPTURE: ReceptionModel = ReceptionModel::SinrThreshold { least: 1.995 };

#[test]
fn a_frame_without_interference_is_received_if_it_is_strong_enough() {
    for model in [ReceptionModel::Overlap, CAPTURE, ReceptionModel::Ber] {
        assert_eq!(fates(model, 0.5, &[(0, -80.0)]), [FrameOutcome::Received], "{model:?}");
        assert_eq!(fates(model, 0.5, &[(0, -90.1)]), [FrameOutcome::Weak], "{model:?}");
    }
    // At the sensitivity the noise leaves 0.4 dB: less than the threshold of 3 dB.
    assert_eq!(fates(CAPTURE, 0.5, &[(0, -89.0)]), [FrameOutcome::Weak]);
}

#[test]
fn the_probability_of_a_frame_alone_is_that_of_the_receiver() {
    let models = [ReceptionModel::Overlap, CAPTURE, ReceptionModel::SirThreshold { least: 2.0 }, ReceptionModel::Ber];
    for model in models {
        for power in [-100.0, -92.0, -90.1, -89.9, -89.0, -88.0, -87.4, -87.3, -80.0] {
            let share = rules(model).reception_alone(Dbm(power).to_milliwatts(), Duration::from_micros(832));
            let is_received = |luck| fates(model, luck, &[(0, power)]) == [FrameOutcome::Received];
            for luck in [share - 1e-9, share + 1e-9].into_iter().filter(|luck| (0.0..1.0).contains(luck)) {
                assert_eq!(is_received(luck), luck < share, "{model:?} {power} {luck}");
            }
        }
    }
}

#[test]
fn overlap_destroys_both_frames_at_any_power_unless_one_is_inaudible() {
    let both = [FrameOutcome::Collided, FrameOutcome::Collided];
    assert_eq!(fates(ReceptionModel::Overlap, 0.5, &[(0, -50.0), (831, -80.0)]), both);
    assert_eq!(fates(ReceptionModel::Overlap, 0.5, &[(0, -50.0), (832, -80.0)]), [FrameOutcome::Received; 2]);
    assert_eq!(
        fates(ReceptionModel::Overlap, 0.5, &[(0, -50.0), (400, -91.0)]),
        [FrameOutcome::Received, FrameOutcome::Weak]
    );
}

#[test]
fn the_stronger_first_frame_is_captured() {
    assert_eq!(fates(CAPTURE, 0.5, &[(0, -60.0), (400, -64.0)]), [FrameOutcome::Received, FrameOutcome::Collided]);
    assert_eq!(fates(CAPTURE, 0.5, &[(0, -60.0), (400, -62.0)]), [FrameOutcome::Collided, FrameOutcome::Collided]);
}

#[test]
fn a_locked_receiver_does_not_switch_to_a_stronger_frame() {
    assert_eq!(fates(CAPTURE, 0.5, &[(0, -80.0), (129, -50.0)]), [FrameOutcome::Collided, FrameOutcome::Collided]);
    // During the preamble of a much weaker frame it does: the receiver has not locked on to that frame.
    assert_eq!(fates(CAPTURE, 0.5, &[(0, -80.0), (127, -50.0)]), [FrameOutcome::Collided, FrameOutcome::Received]);
}

#[test]
fn of_two_equal_frames_the_one_locked_first_survives_with_the_rate_of_the_bit_error_formula() {
    // 20 octets and the two of delimiter and header after the preamble, less the 4 us before the second begins.
    let bits = 8.0 * 22.0 - 1.0;
    let noise = Dbm(-90.403).to_milliwatts();
    let power = Dbm(-50.0).to_milliwatts();
    let survival = (bits * (-sextant_mac::oqpsk::bit_error_rate(power.ratio(power + noise))).ln_1p()).exp();
    assert!((survival - 0.972).abs() < 2e-3, "{survival}");
    let frames = [(0, -50.0), (132, -50.0)];
    assert_eq!(fates(ReceptionModel::Ber, survival - 1e-6, &frames)[0], FrameOutcome::Received);
    assert_eq!(fates(ReceptionModel::Ber, survival + 1e-6, &frames)[0], FrameOutcome::Collided);
}

#[test]
fn a_frame_that_began_before_the_receiver_listened_is_only_interference() {
    let rules = rules(CAPTURE);
    let mut receiver = Receiver::default();
    receiver.start(at(100));
    receiver.begin(at(100), 7, Dbm(-50.0).to_milliwatts(), Some(Deafness::Asleep), &rules);
    receiver.begin(at(200), 8, Dbm(-50.0).to_milliwatts(), None, &rules);
    assert_eq!(
        receiver.end(at(800), 7, &rules, || 0.5).map(|heard| heard.outcome),
        Some(FrameOutcome::NotListened(Deafness::Asleep))
    );
    assert_eq!(receiver.end(at(1032), 8, &rules, || 0.5).map(|heard| heard.outcome), Some(FrameOutcome::Collided));
    receiver.begin(at(2000), 9, Dbm(-50.0).to_milliwatts(), None, &rules);
    receiver.stop(at(2100), Deafness::Transmitting);
    assert_eq!(receiver.end(at(2832), 9, &rules, || 0.5), None);
    // It sent while that frame was on air, but not during one that begins when it has fallen asleep.
    receiver.stop(at(2500), Deafness::Asleep);
    assert_eq!(receiver.deafness_since(at(2000)), Deafness::Transmitting);
    assert_eq!(receiver.deafness_since(at(2500)), Deafness::Asleep);
}
