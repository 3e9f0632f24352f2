//! Reports of all sectors.

use super::super::super::snr_report::MeasuredSnr;
use super::*;

/// A sensor that may be asked for all sectors.
fn sensor(draws: &[u32]) -> Bench {
    let config = CsmaFeedbackConfig { max_retries: 7, report_all_sectors: true };
    Bench::new(ContentionConfig::CsmaFeedback(config), draws)
}

/// Hears these frames of a sweep of the robot, with these SNRs (dB); the sweep begins at `start`. Its end.
fn hear_frames(bench: &mut Bench, start: u64, sweep: &SectorLayout, heard: &[(u16, f64)]) -> u64 {
    for &(index, snr) in heard {
        let frame = iss(ROBOT, MacAddress::BROADCAST, sweep, index);
        let left = sweep.remaining_after(index, SSW_AIRTIME);
        let end = start + u64::try_from((sweep.sweep_duration() - left).as_nanos()).expect("a short time");
        bench.hear(end, frame, snr);
    }
    start + u64::try_from(sweep.sweep_duration().as_nanos()).expect("a short time")
}

/// Feedback of the robot that asks for all sectors.
fn question() -> SweepFrame {
    let frame = feedback_frame(SENSOR, 3);
    let SweepBody::Feedback { feedback, .. } = frame.body else { unreachable!("it is feedback") };
    SweepFrame { body: SweepBody::Feedback { feedback, refinement: BeamRefinement::of_all_sectors() }, ..frame }
}

fn measured(sector: TxSector, snr: f64) -> SectorMeasurement {
    SectorMeasurement { sector, snr: MeasuredSnr::of(Db(snr)) }
}

#[test]
fn all_sectors_that_were_heard_are_reported_sifs_after_the_feedback_on_the_sector_that_it_selects() {
    let sweep = layout(&[10, 20]);
    let mut bench = sensor(&[0]);
    let end = hear_frames(&mut bench, 0, &sweep, &[(2, -3.1), (9, 12.4), (12, 40.0), (29, -90.0)]);
    // MBIFS, AIFS; then the answer, the feedback and the report of up to 30 sectors.
    let answered = end + 27_000 + SWEEP;
    let asked = answered + 9_000 + 18_255;
    bench.hear(asked, question(), 9.0);
    bench.finish();
    let &(start, frame, aim) = bench.radio.sent.last().expect("frames");
    assert_eq!((start, aim), (asked + 3_000, Aim::Sector(TxSector::first_antenna(3))));
    assert_eq!(
        frame,
        SweepFrame { duration_us: 0, to: ROBOT, from: SENSOR, body: SweepBody::Brp { measurements: 4 } }
    );
    let sector = |index| sweep.sector(index);
    let expected = [(12, 40.0), (9, 12.5), (2, -3.0), (29, -8.0)].map(|(index, snr)| measured(sector(index), snr));
    assert_eq!(bench.machine.measurements(), expected);
    // The answer is over with the report, and the medium was claimed until then: MBIFS, the feedback of 18.255 us, SIFS and
    // the largest report, of 30 sectors in 104 octets.
    let report = u64::try_from(super::super::super::timing::control_airtime(52).as_nanos()).expect("a short time");
    let trained = ResponderOutcome::Trained(SectorFeedback {
        select: TxSector::first_antenna(3),
        snr: SnrReport(10),
        poll_required: false,
    });
    assert_eq!(bench.outcomes(), [(asked + 3_000 + report, trained, 1)]);
    let claimed = 9_000 + 18_255 + 3_000 + super::super::super::timing::control_airtime(104).as_nanos();
    let last = bench.radio.sent[7].1;
    assert_eq!(u128::from(last.duration_us), claimed.div_ceil(1000));
    assert_eq!(bench.radio.aim, Aim::QuasiOmni);
    assert_eq!(bench.radio.meter.state(), RadioState::Receive);
}

#[test]
fn a_report_is_of_the_last_sweep_and_of_127_sectors_at_most() {
    let sweep = layout(&[64, 64]);
    let mut bench = sensor(&[0, 0]);
    hear_frames(&mut bench, 0, &sweep, &[(0, 20.0)]);
    bench.finish();
    let snr = |index: u16| if index == 77 { -5.0 } else { 5.0 + f64::from(index) / 4.0 };
    let heard: Vec<(u16, f64)> = (0..128).map(|index| (index, snr(index))).collect();
    let end = hear_frames(&mut bench, 2_000_000_000, &sweep, &heard);
    bench.hear(end + 27_000 + SWEEP + 9_000 + 18_255, question(), 9.0);
    bench.run(end + 10_000_000, Class::Timer);
    let expected = (0..128).rev().filter(|&index| index != 77).map(|index| measured(sweep.sector(index), snr(index)));
    assert_eq!(bench.machine.measurements(), expected.collect::<Vec<_>>());
    assert_eq!(bench.radio.sent.last().expect("frames").1.body, SweepBody::Brp { measurements: 127 });
}

#[test]
fn feedback_that_asks_for_nothing_ends_the_answer_at_once() {
    let mut bench = sensor(&[0]);
    bench.hear_sweep();
    let end = FIRST + SWEEP + 9_000 + 18_255;
    bench.hear(end, feedback_frame(SENSOR, 3), 9.0);
    bench.finish();
    assert!(matches!(bench.outcomes()[..], [(ns, ResponderOutcome::Trained(_), 1)] if ns == end));
    assert_eq!(bench.radio.sent.len(), 8);
}

#[test]
fn a_station_that_is_never_asked_keeps_nothing() {
    let mut bench = Bench::new(feedback(7), &[0]);
    bench.hear_sweep();
    assert_eq!(bench.machine.measurements.capacity(), 0);
    // Nor does one that is named by a sweep.
    let mut bench = sensor(&[]);
    bench.hear(1_000, iss(ROBOT, SENSOR, &layout(&[1]), 0), 12.0);
    assert_eq!(bench.machine.measurements.capacity(), 0);
}
