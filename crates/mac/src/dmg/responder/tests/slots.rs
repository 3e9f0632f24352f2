//! Answers in the slots of an A-BFT.

use super::*;

#[test]
fn in_an_abft_the_sweep_starts_with_the_slot_that_was_drawn() {
    let abft = |feedback| ContentionConfig::Abft(AbftConfig { feedback, ..AbftConfig::default() });
    let mut sensor = Bench::new(abft(false), &[5]);
    sensor.hear_sweep();
    // A busy channel does not matter.
    sensor.busy(T0 + 1000, T0 + 900_000);
    sensor.finish();
    let start = T0 + 9_000 + 5 * 163_000;
    assert_eq!((sensor.radio.windows[0], sensor.radio.starts()[0]), (7, start));
    assert_eq!(sensor.outcomes(), [(start + SWEEP, ResponderOutcome::Sent, 1)]);
    let mut sensor = Bench::new(abft(true), &[5]);
    sensor.hear_sweep();
    sensor.hear(start + SWEEP + 9_000 + 18_255, feedback_frame(SENSOR, 1), 20.0);
    assert!(matches!(sensor.outcomes()[..], [(_, ResponderOutcome::Trained(_), 1)]));
}

#[test]
fn after_nine_abfts_without_feedback_a_station_lets_some_pass() {
    let mut draws = [0; 10];
    draws[9] = 2;
    let mut sensor = Bench::new(ContentionConfig::Abft(AbftConfig::default()), &draws);
    let sweep = layout(&[1]);
    let mut answered = Vec::new();
    for round in 0..14 {
        let before = sensor.radio.sent.len();
        sensor.hear(round * 2_000_000 + SSW, iss(ROBOT, MacAddress::BROADCAST, &sweep, 0), 5.0);
        sensor.run((round + 1) * 2_000_000, Class::EndOfSignal);
        answered.push(sensor.radio.sent.len() > before);
    }
    let expected: Vec<_> = (0..14).map(|round| !(9..11).contains(&round)).collect();
    assert_eq!(answered, expected);
    assert_eq!(sensor.outcomes()[0].0, SSW + 9_000 + 163_000);
}

/// A sensor with eight sectors that has heard a sweep, and slots of three frames: it needs three of them.
fn three_slots(slots: u8, feedback: bool, draws: &[u32]) -> Bench {
    let abft = AbftConfig { slots, frames_per_slot: 3, feedback };
    let config = SweepConfig { contention: ContentionConfig::Abft(abft), ..SweepConfig::default() };
    let mut sensor = Bench::of(8, config, draws);
    sensor.hear_sweep();
    sensor
}

/// Length of a slot of three frames: 0.1 + 3 * 14.909 + 2 + 9 + 18.255 + 9 us, rounded up.
const SLOT: u64 = 84_000;

/// Start of frame `index` of a sweep that began in slot number `slot` of the A-BFT after T0.
fn start_of(slot: u64, index: u64) -> u64 {
    T0 + 9_000 + (slot + index / 3) * SLOT + index % 3 * (SSW + 1000)
}

#[test]
fn a_sensor_with_more_sectors_than_a_slot_has_frames_goes_on_in_the_next_slots() {
    for feedback in [false, true] {
        let mut sensor = three_slots(4, feedback, &[1]);
        sensor.finish();
        assert_eq!(sensor.radio.windows, [3]);
        assert_eq!(sensor.radio.starts(), (0..8).map(|i| start_of(1, i)).collect::<Vec<_>>());
        let told: Vec<_> = sensor.radio.sent.iter().map(|sent| (sent.1.body, sent.1.duration_us)).collect();
        for (index, (body, duration_us)) in (0_u16..).zip(told) {
            let SweepBody::Rss { cdown, sector, .. } = body else { panic!("frames of the answer") };
            assert_eq!((cdown, u16::from(sector.sector)), (7 - index, index));
            // The medium is taken to the end of the slot's last frame.
            assert_eq!(duration_us, [32, 16, 0, 32, 16, 0, 16, 0][usize::from(index)], "frame {index}");
        }
        let (end, outcome) = match feedback {
            true => (T0 + 9_000 + 4 * SLOT, ResponderOutcome::NoFeedback),
            false => (start_of(1, 7) + SSW, ResponderOutcome::Sent),
        };
        assert_eq!(sensor.outcomes(), [(end, outcome, 1)]);
        assert_eq!(sensor.radio.aim, Aim::QuasiOmni);
    }
}

#[test]
fn of_the_feedback_in_several_slots_the_best_counts() {
    let mut sensor = three_slots(4, true, &[0]);
    let answered = |slot: u64, sector: u8, snr: i8| {
        let mut frame = feedback_frame(SENSOR, sector);
        let SweepBody::Feedback { feedback, .. } = &mut frame.body else { panic!("feedback") };
        feedback.snr = SnrReport(snr);
        (start_of(slot, 2) + SSW + 9_000 + 18_255, frame)
    };
    for (at, frame) in [answered(0, 1, 8), answered(1, 4, 40)] {
        sensor.hear(at, frame, 20.0);
    }
    sensor.finish();
    assert_eq!(sensor.radio.sent.len(), 8);
    let [(_, ResponderOutcome::Trained(feedback), 1)] = sensor.outcomes()[..] else { panic!("trained once") };
    assert_eq!((feedback.select.sector, feedback.snr), (4, SnrReport(40)));
}

#[test]
fn what_is_left_at_the_end_of_an_abft_is_swept_in_the_next_one() {
    // The sensor draws the last of two slots, and then the first.
    let mut sensor = three_slots(2, false, &[1, 0]);
    sensor.run(T0 + 9_000 + 2 * SLOT, Class::Timer);
    let sectors = |sensor: &Bench| -> Vec<u8> {
        let sent = sensor.radio.sent.iter();
        sent.map(|sent| if let Aim::Sector(sector) = sent.2 { sector.sector } else { u8::MAX }).collect()
    };
    assert_eq!(sectors(&sensor), [0, 1, 2]);
    assert!(!sensor.machine.is_busy());
    let again = 10_000_000;
    sensor.hear(again, iss(ROBOT, MacAddress::BROADCAST, &layout(&[1]), 0), 5.0);
    sensor.finish();
    assert_eq!(sectors(&sensor), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(sensor.radio.starts()[3], again + 9_000);
    assert!(sensor.outcomes().iter().all(|(_, outcome, sweeps)| (*outcome, *sweeps) == (ResponderOutcome::Sent, 1)));
    // Another initiator gets all sectors.
    let mut sensor = three_slots(2, false, &[1, 0]);
    sensor.run(T0 + 9_000 + 2 * SLOT, Class::Timer);
    sensor.hear(again, iss(OTHER, MacAddress::BROADCAST, &layout(&[1]), 0), 5.0);
    sensor.finish();
    assert_eq!(sectors(&sensor), [0, 1, 2, 0, 1, 2, 3, 4, 5]);
}
