//! Reports of all sectors.

use super::*;

/// Airtime of a report of 64 sectors in 172 octets, and of one of 2 sectors in 48.
const LARGEST: u64 = 57_527;
const SMALL: u64 = 21_164;

/// A robot with 64 sectors that has started a sweep and asks for all of them.
fn asking() -> Bench {
    let config = CsmaFeedbackConfig { max_retries: 7, report_all_sectors: true };
    Bench::gathering(ContentionConfig::CsmaFeedback(config))
}

/// What an answer claims after its last frame: MBIFS, feedback, SIFS, the largest report.
fn tail() -> Duration {
    Duration::from_nanos(9_000 + FEEDBACK + 3_000 + LARGEST)
}

fn report(from: MacAddress, measurements: u8) -> SweepFrame {
    SweepFrame { duration_us: 0, to: ROBOT, from, body: SweepBody::Brp { measurements } }
}

/// Hears the frame `index` of an answer of `from` that begins at `start`; when its feedback is due.
fn hear_answer(robot: &mut Bench, from: MacAddress, start: u64, index: u8) -> u64 {
    let end = start + u64::from(index) * (SSW + 1000) + SSW;
    robot.hear(end, rss(from, index, TxSector::first_antenna(37), tail()), 9.0);
    start + SWEEP + 9_000
}

fn told(robot: &Bench) -> Vec<(u64, MacAddress)> {
    robot.radio.sent[64..].iter().map(|sent| (sent.0, sent.1.to)).collect()
}

#[test]
fn airtimes_of_reports_are_those_of_their_octets() {
    let airtime = |count| u64::try_from(report(SENSOR, count).airtime().as_nanos()).expect("short");
    assert_eq!([airtime(64), airtime(2)], [LARGEST, SMALL]);
}

#[test]
fn feedback_asks_for_a_report_and_claims_the_medium_for_it() {
    let mut robot = asking();
    let due = hear_answer(&mut robot, SENSOR, T0 + 40_000, 5);
    let feedback = due + FEEDBACK;
    robot.run(feedback + 1, Class::EndOfSignal);
    assert!(robot.machine.awaits_report_of(SENSOR) && !robot.machine.awaits_report_of(OTHER));
    robot.hear(feedback + 3_000 + SMALL, report(SENSOR, 2), 9.0);
    assert!(!robot.machine.awaits_report_of(SENSOR));
    robot.finish();
    let (ns, frame, _) = robot.radio.sent[64];
    let SweepBody::Feedback { refinement, .. } = frame.body else { panic!("feedback") };
    assert_eq!((ns, refinement), (due, BeamRefinement::of_all_sectors()));
    assert_eq!(u64::from(frame.duration_us), (3_000 + LARGEST).div_ceil(1000));
    assert_eq!(robot.ended(), (T0 + 9_000 + 5_000_000, InitiatorOutcome::Over));
    let report = robot.reports[0].1;
    assert_eq!((report.asked, report.reported, robot.machine.answers().len()), (1, 1, 1));
}

#[test]
fn a_report_that_is_lost_is_no_report_and_the_window_goes_on() {
    let mut robot = asking();
    let due = hear_answer(&mut robot, SENSOR, T0 + 40_000, 5);
    // Frames of others and for others are no report.
    robot.hear(due + FEEDBACK + 3_000 + SMALL, report(OTHER, 2), 9.0);
    robot.hear(due + FEEDBACK + 3_001 + SMALL, SweepFrame { to: OTHER, ..report(SENSOR, 2) }, 9.0);
    let late = due + FEEDBACK + 3_000 + LARGEST + 200;
    robot.run(late, Class::Timer);
    assert!(robot.machine.awaits_report_of(SENSOR));
    robot.run(late + 1, Class::Timer);
    assert!(!robot.machine.awaits_report_of(SENSOR));
    // One that comes later is ignored; the next station is asked as ever.
    robot.hear(late + 10, report(SENSOR, 2), 9.0);
    let next = hear_answer(&mut robot, OTHER, late + 1_000, 2);
    robot.hear(next + FEEDBACK + 3_000 + SMALL, report(OTHER, 2), 9.0);
    robot.finish();
    assert_eq!(told(&robot), [(due, SENSOR), (next, OTHER)]);
    let report = robot.reports[0].1;
    assert_eq!((report.asked, report.reported, robot.machine.answers().len()), (2, 1, 2));
}

#[test]
fn feedback_that_is_due_while_a_report_is_awaited_is_not_sent() {
    let mut robot = asking();
    let start = T0 + 40_000;
    let due = hear_answer(&mut robot, SENSOR, start, 0);
    // Its last frame ends while the report of the first one is on the air.
    let other = hear_answer(&mut robot, OTHER, start + FEEDBACK + 20_000, 7);
    assert!((due + FEEDBACK..due + FEEDBACK + LARGEST).contains(&other));
    robot.finish();
    assert_eq!(told(&robot), [(due, SENSOR)]);
    assert_eq!(robot.machine.answers().len(), 2);
}

#[test]
fn a_report_that_ends_after_the_window_is_awaited() {
    let mut robot = asking();
    let closes = T0 + 9_000 + 5_000_000;
    let due = hear_answer(&mut robot, SENSOR, closes - SWEEP, 7);
    robot.hear(due + FEEDBACK + 3_000 + SMALL, report(SENSOR, 2), 9.0);
    let [(end, report)] = robot.reports[..] else { panic!("{:?}", robot.reports) };
    assert_eq!((end, report.reported), (closes + 9_000 + FEEDBACK + 3_000 + SMALL, 1));
}

#[test]
fn other_sweeps_ask_for_nothing() {
    let mut robot = Bench::gathering(WITH_FEEDBACK);
    let end = T0 + 40_000 + SSW;
    robot.hear(end, rss(SENSOR, 0, TxSector::default(), Duration::from_nanos(9_000 + FEEDBACK)), 9.0);
    robot.finish();
    let frame = robot.radio.sent[64].1;
    let SweepBody::Feedback { refinement, .. } = frame.body else { panic!("feedback") };
    assert_eq!((refinement, frame.duration_us, robot.reports[0].1.asked), (BeamRefinement::default(), 0, 0));
}
