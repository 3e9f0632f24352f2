//! Tests of the machine with a scripted radio.

use std::time::Duration;

use super::super::port::Aim;
use super::super::script::{OTHER, ROBOT, SENSOR, Script, at, iss, layout, rss, us};
use super::super::{AbftConfig, ContentionConfig, CsmaFeedbackConfig, Responder, SnrReport, SweepConfig, TxSector};
use super::*;
use crate::Class;

const SSW: u64 = 14_909;
const FEEDBACK: u64 = 18_255;
/// A sweep of eight sectors.
const SWEEP: u64 = 126_272;
/// End of a sweep of 64 sectors.
const T0: u64 = 1_017_176;

mod reports;

struct Bench {
    machine: Initiator,
    radio: Script,
    reports: Vec<(u64, InitiatorReport)>,
}

impl Bench {
    /// A robot with these sectors.
    fn new(contention: ContentionConfig, sectors: &[u8]) -> Self {
        let config = SweepConfig { contention, ..SweepConfig::default() };
        let settings = SweepSettings::try_from(config).expect("good settings");
        let machine = Initiator::new(ROBOT, layout(sectors), settings);
        Self { machine, radio: Script::new(&[]), reports: Vec::new() }
    }

    /// A robot with 64 sectors that has started a sweep for all.
    fn gathering(contention: ContentionConfig) -> Self {
        let mut bench = Self::new(contention, &[64]);
        bench.start(SweepPurpose::Gather, Access::AtOnce);
        bench
    }

    fn start(&mut self, purpose: SweepPurpose, access: Access) {
        self.machine.start(self.radio.now, purpose, access, &mut self.radio);
    }

    fn run(&mut self, ns: u64, class: Class) {
        while let Some(event) = self.radio.next(at(ns), class) {
            let report = self.machine.handle(self.radio.now, event, &mut self.radio);
            self.note(report);
        }
        self.radio.now = at(ns);
    }

    fn note(&mut self, report: Option<InitiatorReport>) {
        self.reports.extend(report.map(|report| (self.radio.now.as_nanos(), report)));
    }

    fn event(&mut self, ns: u64, event: Event) {
        self.run(ns, event.class());
        let report = self.machine.handle(at(ns), event, &mut self.radio);
        self.note(report);
    }

    fn hear(&mut self, ns: u64, frame: SweepFrame, snr: f64) {
        self.run(ns, Class::EndOfSignal);
        let report = self.machine.receive(at(ns), &frame, Db(snr), &mut self.radio);
        self.note(report);
    }

    fn finish(&mut self) {
        self.run(1_000_000_000, Class::Timer);
    }

    fn ended(&self) -> (u64, InitiatorOutcome) {
        let [(ns, report)] = self.reports[..] else { panic!("one sweep: {:?}", self.reports) };
        (ns, report.outcome)
    }
}

const WITH_FEEDBACK: ContentionConfig =
    ContentionConfig::CsmaFeedback(CsmaFeedbackConfig { max_retries: 7, report_all_sectors: false });

#[test]
fn a_sweep_sends_one_frame_per_sector_sbifs_apart_and_lbifs_where_the_antenna_changes() {
    let sweep = layout(&[40, 24]);
    let mut robot = Bench::new(ContentionConfig::Csma, &[40, 24]);
    robot.start(SweepPurpose::Gather, Access::AtOnce);
    robot.finish();
    let start = |i: u64| i * (SSW + 1000) + if i < 40 { 0 } else { 17_000 };
    assert_eq!(robot.radio.starts(), (0..64).map(start).collect::<Vec<_>>());
    for (index, (_, frame, aim)) in (0..).zip(&robot.radio.sent) {
        assert_eq!(*frame, iss(ROBOT, MacAddress::BROADCAST, &sweep, index));
        assert_eq!(*aim, Aim::Sector(sweep.sector(index)));
    }
    assert_eq!(robot.radio.aim, Aim::QuasiOmni);
    assert_eq!(robot.radio.meter.span(RadioState::Transmit), Duration::from_nanos(64 * SSW));
    assert_eq!(robot.radio.meter.span(RadioState::Idle), us(62 + 18));
}

#[test]
fn the_first_of_64_frames_claims_the_medium_for_the_other_63() {
    let robot = Bench::gathering(ContentionConfig::Csma);
    assert_eq!(robot.radio.sent[0].1.duration_us, 1003);
}

#[test]
fn an_announcement_ends_with_its_last_frame() {
    let mut robot = Bench::new(ContentionConfig::Csma, &[64]);
    robot.start(SweepPurpose::Announce, Access::AtOnce);
    assert!(matches!(robot.radio.sent[0].1.body, SweepBody::Iss { rx_antennas: 0, .. }));
    robot.finish();
    assert_eq!((robot.ended(), robot.reports[0].1.frames), ((T0, InitiatorOutcome::Over), 64));
}

#[test]
fn a_sweep_may_contend_for_the_channel() {
    let mut robot = Bench::new(ContentionConfig::Csma, &[8]);
    robot.radio = Script::new(&[4]);
    robot.event(1000, Event::CarrierBusy);
    robot.start(SweepPurpose::Announce, Access::Contend);
    robot.event(50_000, Event::CarrierIdle);
    robot.finish();
    assert_eq!((robot.radio.windows[0], robot.radio.starts()[0]), (15, 50_000 + 18_000 + 20_000));
}

#[test]
fn without_answers_the_window_ends_when_no_station_can_still_contend() {
    // MBIFS, AIFS, 15 slots, and the time to notice a signal.
    let mut robot = Bench::gathering(ContentionConfig::Csma);
    robot.finish();
    assert_eq!(robot.ended(), (T0 + 9_000 + 18_000 + 75_000 + 3_000, InitiatorOutcome::Over));
    assert!(robot.machine.answers().is_empty());
}

#[test]
fn each_activity_extends_the_window() {
    let mut robot = Bench::gathering(ContentionConfig::Csma);
    let last = T0 + 9_000 + 18_000 + 75_000;
    for i in 0..8 {
        robot.event(last + i * (SSW + 1000), Event::CarrierBusy);
        robot.event(last + i * (SSW + 1000) + SSW, Event::CarrierIdle);
    }
    robot.finish();
    assert_eq!(robot.ended().0, last + SWEEP + 18_000 + 75_000 + 3_000);
}

#[test]
fn a_channel_that_stays_busy_does_not_extend_the_window_beyond_its_maximum() {
    let mut robot = Bench::gathering(ContentionConfig::Csma);
    robot.event(T0 + 10_000, Event::CarrierBusy);
    robot.finish();
    assert_eq!(robot.ended(), (T0 + 9_000 + 5_000_000, InitiatorOutcome::Over));
}

#[test]
fn each_station_is_one_answer_with_its_best_frame() {
    let mut robot = Bench::gathering(ContentionConfig::Csma);
    let select = |sector| TxSector { antenna: 0, sector };
    let mut end = T0 + 50_000;
    for (from, index, snr) in
        [(OTHER, 0, 4.0), (SENSOR, 2, 9.0), (SENSOR, 3, 14.5), (SENSOR, 4, 14.5), (OTHER, 7, 3.0)]
    {
        let chosen = if from == SENSOR { 37 } else { 5 };
        end += 1000;
        robot.hear(end, rss(from, index, select(chosen), Duration::ZERO), snr);
    }
    robot.finish();
    let select_snr = SnrReport(0);
    let answer = |responder, chosen, snr, sector, frames| Answer {
        responder,
        select: select(chosen),
        select_snr,
        snr: Db(snr),
        responder_sector: select(sector),
        frames,
    };
    assert_eq!(robot.machine.answers(), [answer(SENSOR, 37, 14.5, 3, 3), answer(OTHER, 5, 4.0, 0, 2)]);
    assert_eq!(robot.radio.sent.len(), 64);
    // The next sweep starts with no answers.
    robot.start(SweepPurpose::Gather, Access::AtOnce);
    assert!(robot.machine.answers().is_empty());
}

#[test]
fn feedback_follows_mbifs_after_the_end_of_the_sweep_on_the_sector_that_it_names() {
    let mut robot = Bench::gathering(WITH_FEEDBACK);
    let tail = Duration::from_nanos(9_000 + FEEDBACK);
    let select = TxSector::first_antenna(37);
    let start = T0 + 40_000;
    for index in [2, 5] {
        let end = start + u64::from(index) * (SSW + 1000) + SSW;
        robot.hear(end, rss(SENSOR, index, select, tail), f64::from(index));
    }
    robot.finish();
    let (ns, frame, aim) = robot.radio.sent[64];
    assert_eq!((ns, aim), (start + SWEEP + 9_000, Aim::Sector(select)));
    assert_eq!((frame.to, frame.duration_us), (SENSOR, 0));
    let SweepBody::Feedback { feedback, .. } = frame.body else { panic!("feedback") };
    assert_eq!((feedback.select, feedback.snr), (TxSector::first_antenna(5), SnrReport::of(Db(5.0))));
    assert_eq!(robot.radio.sent.len(), 65);
    // A station without feedback contends again with a larger backoff, so the window is not cut short.
    assert_eq!(robot.ended().0, T0 + 9_000 + 5_000_000);
}

#[test]
fn feedback_that_is_due_while_another_is_sent_is_not_sent() {
    let mut robot = Bench::gathering(WITH_FEEDBACK);
    let tail = Duration::from_nanos(9_000 + FEEDBACK);
    let start = T0 + 40_000;
    let end = |index: u64| start + index * (SSW + 1000) + SSW;
    robot.hear(end(2), rss(SENSOR, 2, TxSector::default(), tail), 9.0);
    robot.hear(end(2) + 8_000, rss(OTHER, 2, TxSector::default(), tail), 9.0);
    robot.finish();
    let told: Vec<_> = robot.radio.sent[64..].iter().map(|sent| sent.1.to).collect();
    assert_eq!((told, robot.machine.answers().len()), (vec![SENSOR], 2));
}

#[test]
fn in_an_abft_feedback_ends_the_slot_and_the_slots_end_the_window() {
    for (feedback, frames) in [(true, 2), (false, 0)] {
        let abft = AbftConfig { feedback, ..AbftConfig::default() };
        let mut robot = Bench::gathering(ContentionConfig::Abft(abft));
        let slot = |slot: u64| T0 + 9_000 + slot * 163_000;
        let end = |start, index: u64| start + index * (SSW + 1000) + SSW;
        robot.hear(end(slot(0), 1), rss(SENSOR, 1, TxSector::default(), Duration::ZERO), 9.0);
        // Two stations share the last slot: the one heard better gets the feedback.
        robot.hear(end(slot(7), 1), rss(SENSOR, 1, TxSector::default(), Duration::ZERO), 9.0);
        robot.hear(end(slot(7), 7), rss(OTHER, 7, TxSector::default(), Duration::ZERO), 11.0);
        robot.finish();
        let told: Vec<_> = robot.radio.sent[64..].iter().map(|&(ns, frame, _)| (ns, frame.to)).collect();
        let expected = [(slot(0) + SWEEP + 9_000, SENSOR), (slot(7) + SWEEP + 9_000, OTHER)];
        assert_eq!(told, expected[..frames]);
        assert_eq!(robot.ended().0, slot(8));
    }
}

/// The sweep for one station of which `silent` sweeps are not heard; then it answers, and `lost` of its
/// acknowledgements are lost. Number of sweeps and of feedback frames, and the end.
fn train(silent: usize, lost: usize) -> (usize, usize, (u64, InitiatorOutcome)) {
    let mut robot = Bench::new(ContentionConfig::Csma, &[1]);
    robot.start(SweepPurpose::Train { responder: SENSOR, layout: layout(&[8]) }, Access::AtOnce);
    let count = |robot: &Bench, is_feedback: bool| {
        let is = |sent: &&(u64, SweepFrame, Aim)| matches!(sent.1.body, SweepBody::Feedback { .. }) == is_feedback;
        robot.radio.sent.iter().filter(is).count()
    };
    while robot.reports.is_empty() {
        let (sweeps, feedbacks) = (count(&robot, false), count(&robot, true));
        let (ns, frame, _) = *robot.radio.sent.last().expect("a frame");
        let end = ns + u64::try_from(frame.airtime().as_nanos()).expect("a short time");
        if feedbacks > lost {
            let body = SweepBody::Ack { feedback: SectorFeedback::default(), refinement: BeamRefinement::default() };
            robot.hear(end + 9_000 + FEEDBACK, SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body }, 9.0);
        } else if feedbacks == 0 && sweeps > silent {
            robot.hear(end + 9_000 + SSW, rss(SENSOR, 0, TxSector::default(), Duration::ZERO), 9.0);
            robot.run(end + 9_000 + SWEEP + 9_000 + 1, Class::EndOfSignal);
        } else {
            robot.run(end + 150_000, Class::Timer);
        }
    }
    (count(&robot, false), count(&robot, true), robot.ended())
}

#[test]
fn a_sweep_for_one_station_is_repeated_ten_times_and_its_feedback_too() {
    assert!(matches!(train(0, 0), (1, 1, (_, InitiatorOutcome::Trained))));
    assert!(matches!(train(3, 2), (4, 3, (_, InitiatorOutcome::Trained))));
    let period = SSW + 9_000 + SWEEP + 200;
    assert_eq!(train(100, 0), (11, 0, (11 * period, InitiatorOutcome::NoAnswer)));
    let first_feedback = SSW + 9_000 + SWEEP + 9_000;
    let timeout = FEEDBACK + 2 * (FEEDBACK + 100 + 9_000);
    assert_eq!(train(0, 100), (1, 11, (first_feedback + 11 * timeout, InitiatorOutcome::NoAck)));
}

#[test]
fn the_full_procedure_of_64_and_8_sectors_takes_1206_958_us() {
    let mut robot = Bench::new(ContentionConfig::Csma, &[64]);
    let mut sensor = Responder::new(SENSOR, SweepSettings::default().answers(layout(&[8])).expect("no slots"));
    let mut radio = Script::new(&[]);
    robot.start(SweepPurpose::Train { responder: SENSOR, layout: layout(&[8]) }, Access::AtOnce);
    // Who sends and who receives is clear at every instant; everything is decoded.
    let mut ns = 0;
    let (mut mine, mut theirs) = (0, 0);
    while robot.reports.is_empty() {
        ns += 1;
        let frame_end =
            |sent: &(u64, SweepFrame, Aim)| sent.0 + u64::try_from(sent.1.airtime().as_nanos()).expect("short");
        if let Some(sent) = robot.radio.sent.get(mine).filter(|sent| frame_end(sent) == ns) {
            while let Some(event) = radio.next(at(ns), Class::EndOfSignal) {
                let now = radio.now;
                sensor.handle(now, event, &mut radio);
            }
            radio.now = at(ns);
            sensor.receive(at(ns), &sent.1, Db(f64::from(mine == 37)), &mut radio);
            mine += 1;
        }
        while let Some(event) = radio.next(at(ns), Class::Application) {
            let now = radio.now;
            sensor.handle(now, event, &mut radio);
        }
        if let Some(sent) = radio.sent.get(theirs).filter(|sent| frame_end(sent) == ns) {
            robot.hear(ns, sent.1, f64::from(theirs == 2));
            theirs += 1;
        } else {
            robot.run(ns, Class::Application);
        }
    }
    assert_eq!((ns, mine, theirs), (1_206_958, 65, 9));
    assert_eq!(robot.ended(), (1_206_958, InitiatorOutcome::Trained));
    assert_eq!(
        (robot.radio.sent[64].2, radio.sent[8].2),
        (Aim::Sector(TxSector::first_antenna(37)), Aim::Sector(TxSector::first_antenna(2)))
    );
}

#[test]
fn a_broadcast_sends_a_beacon_from_each_sector_and_announces_what_is_left_of_it() {
    let mut bench = Bench::new(ContentionConfig::Csma, &[2, 1]);
    bench.start(SweepPurpose::Broadcast { sequence: 7, payload_octets: 20 }, Access::Contend);
    bench.run(1_000_000, Class::Application);
    // AIFS; frames of 26.109 us; SBIFS, then LBIFS to the second antenna.
    let starts = [18_000, 45_109, 89_218];
    assert_eq!(bench.radio.starts(), starts);
    let frames: Vec<(u16, SweepBody)> =
        bench.radio.sent.iter().map(|sent| (sent.1.duration_us, sent.1.body)).collect();
    let body = |timestamp_us, cdown, antenna, sector| SweepBody::Beacon {
        timestamp_us,
        cdown,
        sector: TxSector { antenna, sector },
        sequence: 7,
        payload_octets: 20,
    };
    // 26.109 + 1 + 26.109 + 18, 26.109 + 18, and nothing.
    assert_eq!(frames, [(72, body(18, 2, 0, 0)), (45, body(45, 1, 0, 1)), (0, body(89, 0, 1, 0))]);
    let [(end, report)] = bench.reports[..] else { panic!("{:?}", bench.reports) };
    assert_eq!((end, report.outcome, report.frames), (115_327, InitiatorOutcome::Over, 3));
}

#[test]
fn a_broadcast_that_lasts_longer_than_a_duration_field_claims_the_medium_anew_in_each_frame() {
    let mut bench = Bench::new(ContentionConfig::Csma, &[64, 64]);
    bench.start(SweepPurpose::Broadcast { sequence: 0, payload_octets: MAX_BEACON_PAYLOAD_OCTETS }, Access::AtOnce);
    bench.run(50_000_000, Class::Application);
    let durations: Vec<u16> = bench.radio.sent.iter().map(|sent| sent.1.duration_us).collect();
    // 127 frames of 306.545 us, 126 gaps of 1 us and one of 18 us are 39 075.215 us.
    assert_eq!((durations[0], durations[127]), (32_767, 0));
    assert_eq!(durations[126], 308);
    assert!(durations.windows(2).all(|pair| pair[0] >= pair[1]));
}

#[test]
fn a_sweep_that_waits_for_the_channel_can_be_withdrawn_and_started_again() {
    let mut bench = Bench::new(ContentionConfig::Csma, &[1]);
    bench.start(SweepPurpose::Announce, Access::Contend);
    bench.run(10_000, Class::Application);
    assert!(bench.machine.is_contending());
    bench.machine.withdraw(&mut bench.radio);
    assert!(!bench.machine.is_busy());
    bench.run(100_000, Class::Application);
    assert!(bench.radio.starts().is_empty());
    // Another machine of the station knows that the medium is taken until 150 us.
    bench.machine.is_claimed_until(at(100_000), at(150_000));
    bench.start(SweepPurpose::Announce, Access::Contend);
    bench.run(300_000, Class::Application);
    assert_eq!(bench.radio.starts(), [168_000]);
}
