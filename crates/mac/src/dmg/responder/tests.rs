//! Tests of the machine with a scripted radio.

use std::time::Duration;

use super::super::frame::BeamRefinement;
use super::super::port::Aim;
use super::super::script::{OTHER, ROBOT, SENSOR, Script, at, iss, layout, rss, us};
use super::super::{AbftConfig, ContentionConfig, CsmaFeedbackConfig, SweepConfig, TxSector};
use super::*;
use crate::Class;

mod reports;
mod slots;

/// End of the sweeps of the tests.
const T0: u64 = 1_017_176;
/// Earliest start of a backoff of no slots: MBIFS and AIFS after the end of the sweep.
const FIRST: u64 = T0 + 9_000 + 18_000;
const SSW: u64 = 14_909;
/// A sweep of eight sectors.
const SWEEP: u64 = 126_272;

struct Bench {
    machine: Responder,
    radio: Script,
    reports: Vec<(u64, ResponderReport)>,
}

impl Bench {
    /// A sensor with eight sectors.
    fn new(contention: ContentionConfig, draws: &[u32]) -> Self {
        let config = SweepConfig { contention, window_ms: 50.0, ..SweepConfig::default() };
        Self::with(config, draws)
    }

    fn with(config: SweepConfig, draws: &[u32]) -> Self {
        Self::of(8, config, draws)
    }

    /// A sensor with so many sectors.
    fn of(sectors: u8, config: SweepConfig, draws: &[u32]) -> Self {
        let settings = SweepSettings::try_from(config).expect("good settings");
        let machine = Responder::new(SENSOR, settings.answers(layout(&[sectors])).expect("the sectors fit"));
        Self { machine, radio: Script::new(draws), reports: Vec::new() }
    }

    /// Runs until just before events of `class` at `ns`.
    fn run(&mut self, ns: u64, class: Class) {
        while let Some(event) = self.radio.next(at(ns), class) {
            let report = self.machine.handle(self.radio.now, event, &mut self.radio);
            self.note(report);
        }
        self.radio.now = at(ns);
    }

    fn note(&mut self, report: Option<ResponderReport>) {
        self.reports.extend(report.map(|report| (self.radio.now.as_nanos(), report)));
    }

    fn event(&mut self, ns: u64, event: Event) {
        self.run(ns, event.class());
        let report = self.machine.handle(at(ns), event, &mut self.radio);
        self.note(report);
    }

    fn busy(&mut self, from: u64, until: u64) {
        self.event(from, Event::CarrierBusy);
        self.event(until, Event::CarrierIdle);
    }

    fn hear(&mut self, ns: u64, frame: SweepFrame, snr: f64) {
        self.run(ns, Class::EndOfSignal);
        let report = self.machine.receive(at(ns), &frame, Db(snr), &mut self.radio);
        self.note(report);
    }

    /// Hears one frame of a sweep of 64 sectors of the robot that ends at T0.
    fn hear_sweep(&mut self) {
        let sweep = layout(&[64]);
        let end = T0 - u64::try_from(sweep.remaining_after(37, SSW_AIRTIME).as_nanos()).expect("a short time");
        self.hear(end, iss(ROBOT, MacAddress::BROADCAST, &sweep, 37), 12.0);
    }

    fn finish(&mut self) {
        self.run(1_000_000_000, Class::Timer);
    }

    fn outcomes(&self) -> Vec<(u64, ResponderOutcome, u8)> {
        let outcome = |&(ns, report): &(u64, ResponderReport)| match report {
            ResponderReport::Answered { outcome, sweeps, .. } => Some((ns, outcome, sweeps)),
            ResponderReport::Heard(_) => None,
        };
        self.reports.iter().filter_map(outcome).collect()
    }
}

fn feedback(max_retries: u8) -> ContentionConfig {
    ContentionConfig::CsmaFeedback(CsmaFeedbackConfig { max_retries, report_all_sectors: false })
}

fn feedback_frame(to: MacAddress, sector: u8) -> SweepFrame {
    let feedback =
        SectorFeedback { select: TxSector::first_antenna(sector), snr: SnrReport(10), poll_required: false };
    let body = SweepBody::Feedback { feedback, refinement: BeamRefinement::default() };
    SweepFrame { duration_us: 0, to, from: ROBOT, body }
}

#[test]
fn events_are_small() {
    assert!(size_of::<Event>() <= 2);
}

#[test]
fn the_end_of_a_sweep_follows_from_any_of_its_frames() {
    for sectors in [&[64_u8][..], &[32, 32], &[10, 1, 20, 3], &[1, 1, 1, 1]] {
        let sweep = layout(sectors);
        let mut end = 0;
        for index in 0..sweep.total() {
            end += SSW;
            let mut sensor = Bench::new(ContentionConfig::Csma, &[]);
            sensor.hear(end, iss(ROBOT, MacAddress::BROADCAST, &sweep, index), 3.0);
            sensor.finish();
            let total = u64::try_from(sweep.sweep_duration().as_nanos()).expect("a short time");
            let (told, ResponderReport::Heard(heard)) = sensor.reports[0] else { panic!("the sweep comes first") };
            assert_eq!(
                (told, heard.end, heard.sector),
                (total, at(total), sweep.sector(index)),
                "{sectors:?} {index}"
            );
            if index + 1 < sweep.total() {
                end += u64::try_from(sweep.gap_after(index).as_nanos()).expect("a short time");
            }
        }
    }
}

#[test]
fn the_best_frame_counts_and_of_equals_the_first() {
    let mut sensor = Bench::new(ContentionConfig::Csma, &[]);
    let sweep = layout(&[64]);
    for (index, snr) in [(3, 2.0), (9, 11.0), (10, 7.0), (11, 11.0)] {
        let end = u64::from(index) * (SSW + 1000) + SSW;
        sensor.hear(end, iss(ROBOT, MacAddress::BROADCAST, &sweep, index), snr);
    }
    sensor.finish();
    let expected = HeardSweep {
        total_sectors: 64,
        initiator: ROBOT,
        sector: TxSector::first_antenna(9),
        snr: Db(11.0),
        frames: 4,
        end: at(T0),
        is_unicast: false,
    };
    assert_eq!(sensor.reports[0], (T0, ResponderReport::Heard(expected)));
}

#[test]
fn without_feedback_the_sectors_are_swept_once_after_aifs_and_backoff() {
    let mut sensor = Bench::new(ContentionConfig::Csma, &[7]);
    sensor.hear_sweep();
    sensor.finish();
    let start = FIRST + 7 * 5_000;
    assert_eq!(sensor.radio.windows, [15]);
    assert_eq!(sensor.radio.starts(), (0..8).map(|i| start + i * (SSW + 1000)).collect::<Vec<_>>());
    for (index, (_, frame, aim)) in (0_u8..).zip(&sensor.radio.sent) {
        let sector = TxSector::first_antenna(index);
        let choice =
            SectorFeedback { select: TxSector::first_antenna(37), snr: SnrReport(-28), poll_required: false };
        let body = SweepBody::Rss { cdown: 7 - u16::from(index), sector, feedback: choice };
        assert_eq!((frame.to, frame.from, frame.body, *aim), (ROBOT, SENSOR, body, Aim::Sector(sector)));
    }
    // What remains after each frame: 7 * 15.909 us, and so on.
    let durations: Vec<_> = sensor.radio.sent.iter().map(|sent| sent.1.duration_us).collect();
    assert_eq!(durations, [112, 96, 80, 64, 48, 32, 16, 0]);
    assert_eq!(sensor.outcomes(), [(start + SWEEP, ResponderOutcome::Sent, 1)]);
    assert_eq!(sensor.radio.aim, Aim::QuasiOmni);
    assert!(!sensor.machine.is_busy());
    // Eight frames, seven gaps.
    assert_eq!(sensor.radio.meter.span(RadioState::Transmit), Duration::from_nanos(8 * SSW));
    assert_eq!(sensor.radio.meter.span(RadioState::Idle), us(7));
}

#[test]
fn the_access_category_gives_aifs_and_window() {
    let config = SweepConfig { access_category: crate::dmg::AccessCategory::Voice, ..SweepConfig::default() };
    let mut sensor = Bench::with(config, &[3]);
    sensor.hear_sweep();
    sensor.finish();
    assert_eq!((sensor.radio.windows[0], sensor.radio.starts()[0]), (3, T0 + 9_000 + 13_000 + 3 * 5_000));
}

#[test]
fn a_sweep_of_another_station_freezes_the_backoff_with_few_timers() {
    // Another station starts after two slots of ten; this one cannot decode it. Its gaps are shorter than AIFS.
    let mut sensor = Bench::new(ContentionConfig::Csma, &[10]);
    sensor.hear_sweep();
    let other = FIRST + 2 * 5_000;
    let before = sensor.radio.timers;
    for i in 0..8 {
        sensor.busy(other + i * (SSW + 1000), other + i * (SSW + 1000) + SSW);
    }
    let timers = sensor.radio.timers - before;
    assert!(timers <= 6, "{timers} timers");
    sensor.run(other + SWEEP + 18_000 + 8 * 5_000, Class::StartOfSignal);
    assert!(sensor.radio.sent.is_empty());
    sensor.finish();
    assert_eq!(sensor.radio.starts()[0], other + SWEEP + 18_000 + 8 * 5_000);
}

#[test]
fn one_decoded_frame_keeps_a_station_silent_to_the_end_of_the_sweep() {
    // Only the frame in the middle reaches this station: it claims the medium for the other four frames.
    let mut sensor = Bench::new(ContentionConfig::Csma, &[10]);
    sensor.hear_sweep();
    let start = FIRST + 2 * 5_000 - 3 * (SSW + 1000);
    let frame = start + 3 * (SSW + 1000);
    sensor.event(frame, Event::CarrierBusy);
    sensor.hear(frame + SSW, rss(OTHER, 3, TxSector::default(), Duration::ZERO), 9.0);
    sensor.event(frame + SSW, Event::CarrierIdle);
    sensor.finish();
    let claimed = frame + SSW + 64_000;
    assert!((start + SWEEP..start + SWEEP + 1000).contains(&claimed));
    assert_eq!(sensor.radio.starts()[0], claimed + 18_000 + 8 * 5_000);
    // One early timer, which then waits for the end.
    assert!(sensor.radio.timers <= 3 + 8, "{} timers", sensor.radio.timers);
}

#[test]
fn equal_slots_collide_and_slots_5_us_apart_do_not() {
    for (noticed, other) in
        [(false, FIRST + 20_000), (false, FIRST + 17_001), (true, FIRST + 17_000), (true, FIRST + 15_000)]
    {
        let mut sensor = Bench::new(ContentionConfig::Csma, &[4]);
        sensor.hear_sweep();
        sensor.busy(other, other + SWEEP);
        sensor.finish();
        let waits = sensor.radio.starts()[0] != FIRST + 20_000;
        assert_eq!(waits, noticed, "another station starts at {other}");
    }
}

#[test]
fn a_channel_that_is_busy_from_the_start_delays_the_whole_backoff() {
    let mut sensor = Bench::new(ContentionConfig::Csma, &[0]);
    sensor.event(1000, Event::CarrierBusy);
    sensor.hear_sweep();
    sensor.event(T0 + 400_000, Event::CarrierIdle);
    sensor.finish();
    assert_eq!(sensor.radio.starts()[0], T0 + 400_000 + 18_000);
}

#[test]
fn without_feedback_in_time_the_contention_window_doubles_seven_times() {
    let mut sensor = Bench::new(feedback(7), &[0; 8]);
    sensor.hear_sweep();
    sensor.finish();
    assert_eq!(sensor.radio.windows, [15, 31, 63, 127, 255, 511, 1023, 1023]);
    let starts: Vec<_> = sensor.radio.starts().into_iter().step_by(8).collect();
    // Sweep, MBIFS, SSW-Feedback, twice the propagation, AIFS.
    let period = SWEEP + 9_000 + 18_255 + 200 + 18_000;
    assert_eq!(starts, (0..8).map(|i| FIRST + i * period).collect::<Vec<_>>());
    let end = FIRST + 8 * period - 18_000;
    assert_eq!(sensor.outcomes(), [(end, ResponderOutcome::NoFeedback, 8)]);
    // The sweep claims the medium for its feedback too: 7 * 15.909 + 9 + 18.255 us.
    assert_eq!(sensor.radio.sent[0].1.duration_us, 139);
}

#[test]
fn feedback_ends_an_answer() {
    let mut sensor = Bench::new(feedback(7), &[0, 5]);
    sensor.hear_sweep();
    let first = FIRST + SWEEP;
    // Feedback to another station does not count.
    sensor.hear(first + 9_000 + 18_255, feedback_frame(OTHER, 2), 20.0);
    let second = first + 9_000 + 18_255 + 200 + 18_000 + 25_000 + SWEEP;
    sensor.hear(second + 9_000 + 18_255, feedback_frame(SENSOR, 6), 20.0);
    sensor.finish();
    let [(ns, ResponderOutcome::Trained(feedback), 2)] = sensor.outcomes()[..] else { panic!("trained once") };
    assert_eq!((ns, feedback.select.sector), (second + 27_255, 6));
    assert_eq!(sensor.radio.sent.len(), 16);
}

#[test]
fn an_answer_that_would_end_after_the_window_is_given_up() {
    // The window of 0.2 ms ends 209 us after the sweep: the sweep must start 82.728 us after it.
    let config = SweepConfig { window_ms: 0.2, ..SweepConfig::default() };
    let mut sensor = Bench::with(config, &[11]);
    sensor.hear_sweep();
    sensor.finish();
    assert_eq!(sensor.radio.starts()[0], FIRST + 55_000);
    let mut sensor = Bench::with(config, &[12]);
    sensor.hear_sweep();
    sensor.finish();
    assert!(sensor.radio.sent.is_empty());
    assert_eq!(sensor.outcomes().iter().map(|o| o.1).collect::<Vec<_>>(), [ResponderOutcome::WindowOver]);
}

#[test]
fn a_sweep_for_this_station_alone_is_answered_without_contention_and_acknowledged() {
    let mut sensor = Bench::new(ContentionConfig::Csma, &[]);
    let sweep = layout(&[64]);
    sensor.hear(T0, iss(ROBOT, SENSOR, &sweep, 63), 12.0);
    let end = T0 + 9_000 + SWEEP;
    sensor.hear(end + 9_000 + 18_255, feedback_frame(SENSOR, 3), 20.0);
    let ack = end + 2 * 9_000 + 18_255;
    // The acknowledgement is lost: the feedback comes again.
    sensor.run(ack + 50_000, Class::EndOfSignal);
    sensor.hear(ack + 80_000, feedback_frame(SENSOR, 3), 20.0);
    sensor.finish();
    assert!(sensor.radio.windows.is_empty());
    assert_eq!(sensor.radio.starts()[0], T0 + 9_000);
    let (starts, last) = (sensor.radio.starts(), sensor.radio.sent[8]);
    assert_eq!(starts[8..], [ack, ack + 80_000 + 9_000]);
    assert_eq!(last.2, Aim::Sector(TxSector::first_antenna(3)));
    assert!(matches!(last.1.body, SweepBody::Ack { feedback, .. } if feedback.select.sector == 63));
    assert!(matches!(sensor.outcomes()[..], [(ns, ResponderOutcome::Trained(_), 1)] if ns == ack + 18_255));
}

#[test]
fn sweeps_for_others_and_announcements_are_not_answered() {
    let sweep = layout(&[1]);
    let mut announcement = iss(ROBOT, MacAddress::BROADCAST, &sweep, 0);
    announcement.body = SweepBody::Iss { cdown: 0, sector: TxSector::default(), total_sectors: 1, rx_antennas: 0 };
    for frame in [iss(ROBOT, OTHER, &sweep, 0), announcement, rss(OTHER, 0, TxSector::default(), Duration::ZERO)] {
        let mut sensor = Bench::new(ContentionConfig::Csma, &[]);
        sensor.hear(SSW, frame, 12.0);
        sensor.finish();
        assert!(sensor.reports.is_empty() && sensor.radio.timers == 0);
    }
}

#[test]
fn a_new_sweep_of_the_same_initiator_ends_the_answer_to_the_last() {
    let mut sensor = Bench::new(ContentionConfig::Csma, &[15, 2]);
    let sweep = layout(&[1]);
    sensor.hear(SSW, iss(ROBOT, MacAddress::BROADCAST, &sweep, 0), 12.0);
    sensor.hear(70_000, iss(OTHER, MacAddress::BROADCAST, &sweep, 0), 30.0);
    sensor.hear(90_000, iss(ROBOT, MacAddress::BROADCAST, &sweep, 0), 12.0);
    sensor.finish();
    assert_eq!(sensor.radio.starts()[0], 90_000 + 9_000 + 18_000 + 2 * 5_000);
    assert_eq!(sensor.radio.sent[0].1.to, ROBOT);
    assert_eq!(sensor.outcomes().len(), 1);
}
