//! Stations that all have one frame at the same instant: exact values and closed forms.
//!
//! The exact values were enumerated by a program that shares no code with this crate; those of
//! acknowledged frames are means of another simulation, with their standard errors.

mod medium;

use medium::{Fate, Medium, Range, Tie};
use rand::RngExt;
use sextant_kernel::{Purpose, Seed};
use sextant_mac::csma::Outcome;

use crate::enumeration;

/// Probability that the frame of a station is received, and that the station gives it up.
#[derive(Debug, PartialEq)]
struct Exact {
    received: f64,
    failed: f64,
}

/// What happens over all sequences of draws: the mean over the stations, without rounding.
fn exact(medium: Medium) -> Exact {
    let [received, failed] = enumeration::enumerate(|draw| {
        let fates = medium.run(|_, max| draw(max));
        let count = |is: &dyn Fn(&Fate) -> bool| {
            u32::try_from(fates.iter().filter(|fate| is(fate)).count()).expect("few stations")
        };
        [count(&|fate| fate.delivered.is_some()), count(&|fate| fate.report.outcome == Outcome::ChannelAccessFailure)]
    });
    let stations = f64::from(medium.stations);
    Exact { received: received / stations, failed: failed / stations }
}

/// A mean over rounds, and its standard error.
#[derive(Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

/// The fates in each of `rounds` rounds with random draws.
fn simulate(medium: Medium, rounds: usize) -> Vec<Vec<Fate>> {
    let mut draws = Seed(20_260).stream(Purpose::new(3), 0);
    (0..rounds).map(|_| medium.run(|_, max| draws.random_range(0..=max))).collect()
}

/// The mean of `value` over stations and rounds. Its error counts a round as one number: the
/// stations of a round are not independent.
fn estimate(rounds: &[Vec<Fate>], value: impl Fn(&Fate) -> f64) -> Estimate {
    let (mut sum, mut squares) = (0.0, 0.0);
    for fates in rounds {
        let mean = fates.iter().map(&value).sum::<f64>() / fates.len() as f64;
        sum += mean;
        squares += mean * mean;
    }
    let count = rounds.len() as f64;
    let mean = sum / count;
    Estimate { mean, error: ((squares / count - mean * mean) / count).sqrt() }
}

fn received(rounds: &[Vec<Fate>]) -> Estimate {
    estimate(rounds, |fate| f64::from(u8::from(fate.delivered.is_some())))
}

fn ended(rounds: &[Vec<Fate>], outcome: Outcome) -> Estimate {
    estimate(rounds, |fate| f64::from(u8::from(fate.report.outcome == outcome)))
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected} within {tolerance}");
}

impl Estimate {
    /// Four standard errors, of the estimate and of the reference together: a false alarm once in 16 000.
    #[track_caller]
    fn assert_is(&self, reference: f64, reference_error: f64) {
        assert_close(self.mean, reference, 4.0 * self.error.hypot(reference_error));
    }
}

/// Rounds of each simulation.
const ROUNDS: usize = 200_000;

#[test]
fn two_stations_collide_exactly_if_their_first_draws_are_equal() {
    for (octets, failed) in [(9, 0.0), (20, 2.09e-7), (44, 1.085e-5), (45, 1.085e-5)] {
        let exact = exact(Medium::new(2, octets));
        assert_close(exact.received + exact.failed, 7.0 / 8.0, 0.0);
        assert_close(exact.failed, failed, 3e-3 * failed);
    }
}

#[test]
fn two_stations_have_the_exact_fractions_of_the_enumeration() {
    for (octets, numerator) in [(44, 7_339_941.0), (114, 7_336_021.0), (127, 7_334_369.0)] {
        assert_close(exact(Medium::new(2, octets)).received, numerator / 8_388_608.0, 0.0);
    }
}

#[test]
fn three_and_four_stations_have_the_probabilities_of_the_enumeration() {
    let table = [
        (3, 20, 0.798_362_6, 1.34e-5),
        (3, 114, 0.828_665_2, 9.616e-3),
        (4, 44, 0.770_527_5, 1.430e-3),
        (4, 45, 0.784_784_5, 1.511e-3),
        (4, 114, 0.757_874_5, 4.070_8e-2),
    ];
    for (stations, octets, delivered, failed) in table {
        let rounds = simulate(Medium::new(stations, octets), ROUNDS);
        received(&rounds).assert_is(delivered, 0.0);
        // The error is that of the reference: the event is so rare that it may not occur.
        let failures = ended(&rounds, Outcome::ChannelAccessFailure);
        assert_close(failures.mean, failed, 4.0 * (failed / (ROUNDS * stations as usize) as f64).sqrt());
    }
}

#[test]
fn a_cca_that_starts_when_a_frame_ends_reads_idle() {
    // Frames of 1600 us end on the grid of the backoffs: three stations tell the two rules apart.
    let medium = Medium::new(3, 44);
    let (idle, busy) = (0.824_819_2, 0.831_196_7);
    for (tie, expected, other) in [(Tie::Idle, idle, busy), (Tie::Busy, busy, idle)] {
        let estimate = received(&simulate(Medium { tie, ..medium }, ROUNDS));
        estimate.assert_is(expected, 0.0);
        assert!((estimate.mean - other).abs() > 6.0 * estimate.error, "{estimate:?}");
    }
}

#[test]
fn hidden_stations_collide_if_their_draws_are_closer_than_a_frame() {
    for (octets, overlap) in [(20, 34.0 / 64.0), (45, 58.0 / 64.0), (114, 1.0)] {
        let exact = exact(Medium { range: Range::RobotOnly, ..Medium::new(2, octets) });
        assert_eq!(exact, Exact { received: 1.0 - overlap, failed: 0.0 });
    }
}

#[test]
fn a_lone_station_waits_for_each_number_of_periods_equally_often() {
    const COUNT: usize = 80_000;
    let mut bins = [0_u32; 8];
    let rounds = simulate(Medium::new(1, 20), COUNT);
    for fate in rounds.iter().flatten() {
        let end = fate.delivered.expect("nobody is in the way").as_nanos() / 1000;
        let backoff = end - (128 + 192 + 832);
        assert_eq!(backoff % 320, 0);
        bins[usize::try_from(backoff / 320).expect("a few periods")] += 1;
    }
    let expected = COUNT as f64 / 8.0;
    let square = |&bin: &u32| (f64::from(bin) - expected).powi(2) / expected;
    let chi_square: f64 = bins.iter().map(square).sum();
    // Seven degrees of freedom: a false alarm once in a million.
    assert!(chi_square < 40.52, "{chi_square}: {bins:?}");
    let mean_ms = estimate(&rounds, |fate| delivered_ms(fate).expect("delivered"));
    mean_ms.assert_is(2.272, 0.0);
}

fn delivered_ms(fate: &Fate) -> Option<f64> {
    fate.delivered.map(|end| 1e3 * end.as_secs_f64())
}

#[test]
fn acknowledged_frames_agree_with_another_simulation() {
    // Stations, octets; received, channel access failures, no acknowledgement, transmissions per station.
    // Printed to 4 digits with a standard error of at most 0.0007.
    let table = [
        (2, 20, [0.9998, 0.0000, 0.0003, 1.145]),
        (2, 44, [0.9992, 0.0000, 0.0013, 1.229]),
        (5, 20, [0.9887, 0.0053, 0.0089, 1.478]),
        (5, 44, [0.9525, 0.0455, 0.0089, 1.554]),
        (10, 114, [0.4956, 0.5084, 0.0047, 0.971]),
    ];
    for (stations, octets, expected) in table {
        let rounds = simulate(Medium { ack_request: true, ..Medium::new(stations, octets) }, 20_000);
        let estimates = [
            received(&rounds),
            ended(&rounds, Outcome::ChannelAccessFailure),
            ended(&rounds, Outcome::NoAck),
            estimate(&rounds, |fate| f64::from(fate.report.transmissions)),
        ];
        for (estimate, reference) in estimates.iter().zip(expected) {
            estimate.assert_is(reference, 7e-4);
        }
    }
}

#[test]
fn a_third_station_that_senses_the_gap_before_an_acknowledgement_hits_it() {
    // Two stations, frames of 1600 us: without the gap 0.875 of the first copies would get through.
    let rounds = simulate(Medium { ack_request: true, ..Medium::new(2, 44) }, 20_000);
    let first = estimate(&rounds, |fate| f64::from(u8::from(fate.first_copy)));
    first.assert_is(0.842, 5e-4);
}
