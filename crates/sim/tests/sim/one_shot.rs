//! Unslotted CSMA-CA over the medium against reference values: all nodes hear each other, get one frame at the same
//! instant, and any overlap destroys. The references are exact enumerations (two to four nodes) and Monte Carlo
//! means with a standard error of at most 0.0007, from an event simulation independent of this one.

use std::time::Duration;

use sextant_channel::{ChannelConfig, Position};
use sextant_kernel::SimTime;
use sextant_sim::{FrameOnAir, FrameOutcome, Observer, OnceConfig, Setup, Simulation, TrafficConfig};

use crate::network;
use crate::on_air::Frames;

/// Collects the ends of received frames.
#[derive(Default)]
struct Ends {
    received: f64,
    sum_ms: f64,
}

impl Observer for Ends {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        if frame.outcome == FrameOutcome::Received {
            self.received += 1.0;
            self.sum_ms += 1e3 * (frame.start + frame.airtime).as_secs_f64();
        }
    }
}

fn setup(nodes: usize, mpdu_octets: u8, acknowledged: bool, seed: u64) -> Setup {
    let query = OnceConfig { mpdu_octets, at_s: 0.0, acknowledged, to: None };
    let robot = network::tour(vec![Position::ORIGIN], 0.1, Duration::from_millis(400));
    Setup {
        robots: vec![robot],
        ..network::setup(&network::cluster(nodes), -20.0, ChannelConfig::default(), TrafficConfig::Query(query), seed)
    }
}

/// A mean over rounds with its standard error.
#[derive(Default)]
struct Mean {
    count: f64,
    sum: f64,
    square: f64,
}

impl Mean {
    fn add(&mut self, x: f64) {
        self.count += 1.0;
        self.sum += x;
        self.square += x * x;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    fn error(&self) -> f64 {
        ((self.square / self.count - self.mean().powi(2)).max(0.0) / self.count).sqrt()
    }

    /// Within 4.5 standard errors of both sides together: one false alarm in 150 000 comparisons.
    fn assert_near(&self, reference: f64, reference_error: f64, what: &str) {
        // Half a unit of the last printed digit is added to the reference's own error.
        let allowed = 4.5 * self.error().hypot(reference_error) + 5e-5;
        assert!(
            (self.mean() - reference).abs() <= allowed,
            "{what}: {:.5} found, {reference} expected, {allowed:.5} allowed",
            self.mean()
        );
    }
}

/// Compares shares without acknowledgement: nodes, MPDU octets, share received, share without channel access, mean end of received
/// frames (ms), standard error of the reference.
fn without_acknowledgement(cases: &[(usize, u8, f64, f64, f64, f64)]) {
    for &(nodes, octets, share, failure, end_ms, reference_error) in cases {
        let (mut received, mut failed, mut ends) = (Mean::default(), Mean::default(), Ends::default());
        for round in 0..40_000 / nodes as u64 {
            let mut observer = Ends::default();
            let survey =
                Simulation::new(setup(nodes, octets, false, round)).expect("a good setup").run(&mut observer);
            let packets = survey.packets;
            assert_eq!(packets.offered, nodes as u64);
            assert_eq!(packets.received + packets.lost_collision + packets.lost_channel_access, packets.offered);
            received.add(packets.received as f64 / nodes as f64);
            failed.add(packets.lost_channel_access as f64 / nodes as f64);
            ends.received += observer.received;
            ends.sum_ms += observer.sum_ms;
        }
        let case = format!("{nodes} nodes, {octets} octets");
        received.assert_near(share, reference_error, &format!("{case}: received"));
        failed.assert_near(failure, reference_error, &format!("{case}: channel access failure"));
        if end_ms.is_finite() {
            let mean_ms = ends.sum_ms / ends.received;
            assert!((mean_ms / end_ms - 1.0).abs() < 0.01, "{case}: mean end {mean_ms} ms, not {end_ms}");
        }
    }
}

#[test]
fn without_acknowledgement_success_and_failure_match_enumerations() {
    without_acknowledgement(&[
        (2, 20, 0.874_999_8, 2.09e-7, f64::NAN, 0.0),
        (2, 44, 0.874_989_2, 1.085e-5, f64::NAN, 0.0),
        (2, 114, 0.874_521_9, 4.781e-4, f64::NAN, 0.0),
        (3, 20, 0.798_362_6, 1.34e-5, f64::NAN, 0.0),
        // The rule for ties matters here: the value would be 0.8312 if a CCA that starts when a frame ends read busy.
        (3, 44, 0.824_819_2, 2.437e-4, f64::NAN, 0.0),
        (3, 45, 0.831_196_7, 2.424e-4, f64::NAN, 0.0),
        (4, 44, 0.770_527_5, 1.430e-3, f64::NAN, 0.0),
        (4, 114, 0.757_874_5, 4.0708e-2, f64::NAN, 0.0),
    ]);
}

#[test]
fn without_acknowledgement_success_failure_and_delay_match_another_simulation() {
    without_acknowledgement(&[
        (5, 20, 0.6813, 0.0003, 5.735, 0.0007),
        (5, 44, 0.7167, 0.0042, 8.184, 0.0007),
        (5, 45, 0.7362, 0.0047, 8.654, 0.0007),
        (5, 114, 0.6815, 0.0843, 13.839, 0.0007),
        (10, 20, 0.5407, 0.0054, 8.873, 0.0007),
        (10, 44, 0.5191, 0.0415, 11.954, 0.0007),
        (10, 114, 0.4026, 0.2806, 17.127, 0.0007),
        (20, 20, 0.3655, 0.0384, 12.675, 0.0007),
        (20, 44, 0.3035, 0.1400, 15.837, 0.0007),
        (20, 114, 0.1843, 0.4594, 20.370, 0.0007),
        (30, 44, 0.1975, 0.2076, 18.048, 0.0007),
        (50, 20, 0.1435, 0.1314, 17.896, 0.0007),
        (50, 44, 0.1032, 0.2797, 20.928, 0.0007),
        (50, 114, 0.0498, 0.5914, 25.796, 0.0007),
    ]);
}

#[test]
fn with_acknowledgement_and_retries_delivery_and_failures_match_the_references() {
    // Nodes, MPDU octets, share delivered, share without channel access (after earlier transmissions included).
    for (nodes, octets, delivered, failed) in [
        (2, 20, 0.9998, 0.0000),
        (2, 44, 0.9992, 0.0000),
        (5, 20, 0.9887, 0.0053),
        (5, 44, 0.9525, 0.0455),
        (5, 114, 0.8100, 0.1902),
        (10, 20, 0.8532, 0.1140),
        (10, 44, 0.7056, 0.2911),
        (20, 20, 0.5237, 0.3804),
        (20, 114, 0.2582, 0.7479),
        (50, 44, 0.1484, 0.8018),
    ] {
        let (mut received, mut caf) = (Mean::default(), Mean::default());
        for round in 0..12_000 / nodes as u64 {
            let survey = Simulation::new(setup(nodes, octets, true, round)).unwrap().run(&mut Ends::default());
            received.add(survey.packets.received as f64 / nodes as f64);
            caf.add(survey.packets.channel_access_failures as f64 / nodes as f64);
        }
        let case = format!("{nodes} nodes, {octets} octets, acknowledged");
        received.assert_near(delivered, 0.0007, &format!("{case}: delivered"));
        caf.assert_near(failed, 0.0007, &format!("{case}: channel access failure"));
    }
}

#[test]
fn one_node_alone_sends_one_frame_after_its_backoff() {
    let mut counts = [0_u32; 8];
    for round in 0..4000 {
        let mut starts = Frames::kept(|frame| frame.start);
        Simulation::new(setup(1, 20, false, round)).unwrap().run(&mut starts);
        let [start] = starts.0[..] else { panic!("one frame, not {:?}", starts.0) };
        let periods = (start - SimTime::ZERO).as_micros() - 320;
        assert_eq!(periods % 320, 0, "access delay {periods} us");
        counts[usize::try_from(periods / 320).unwrap()] += 1;
    }
    let chi_square: f64 = counts.iter().map(|&n| (f64::from(n) - 500.0).powi(2) / 500.0).sum();
    // The upper 1e-5 of chi-square with 7 degrees of freedom.
    assert!(chi_square < 35.3, "backoff is not uniform: {counts:?}");
}
