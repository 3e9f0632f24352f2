//! Slotted CSMA-CA of stations that hear each other, against reference values: exact ones, those of a slot simulation
//! that shares no code with this crate, and the fixed point of independent stations.

mod medium;

use medium::{Accounts, Fate, Medium};
use rand::RngExt;
use sextant_kernel::{Purpose, Seed};
use sextant_mac::csma::Outcome;

use crate::enumeration;

/// MPDU octets of a frame of whole backoff periods: 20 symbols of half an octet each, less the header of 6 octets.
fn octets(periods: u8) -> u8 {
    10 * periods - 6
}

/// The probability over all sequences of draws, without rounding, that the frame of a station is received, and that the
/// station gives it up.
fn exact(medium: Medium) -> [f64; 2] {
    let counts = enumeration::enumerate(|draw| {
        let fates = medium.one_shot(|_, max| draw(max));
        let count = |is: &dyn Fn(&Fate) -> bool| {
            u32::try_from(fates.iter().filter(|fate| is(fate)).count()).expect("few stations")
        };
        [count(&|fate| fate.received), count(&|fate| fate.report.outcome == Outcome::ChannelAccessFailure)]
    });
    counts.map(|count| count / medium.stations as f64)
}

/// A mean over rounds, and its standard error.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

impl Estimate {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        Self { mean, error: (variance / count).sqrt() }
    }

    /// Within 4.5 standard errors of both sides together, one false alarm in 150 000 comparisons, and the rounding of
    /// the reference.
    #[track_caller]
    fn assert_is(self, reference: f64, reference_error: f64, digit: f64, what: &str) {
        let allowed = 4.5 * self.error.hypot(reference_error) + digit / 2.0;
        let Self { mean, .. } = self;
        assert!((mean - reference).abs() <= allowed, "{what}: {mean:.5}, not {reference} within {allowed:.5}");
    }
}

#[test]
fn two_stations_collide_exactly_if_their_first_draws_are_equal() {
    for periods in [2, 3, 5, 7, 12] {
        let [received, failed] = exact(Medium { stations: 2, mpdu_octets: octets(periods) });
        assert!((received + failed - 0.875).abs() < 1e-15, "{periods} periods: {received} + {failed}");
        // Failing takes five busy CCAs while the frame is on air: a frame of five periods or more.
        let bound = [(2, 0.0), (3, 0.0), (5, 1e-5), (7, 1e-3), (12, 1e-2)];
        let (_, bound) = bound.into_iter().find(|entry| entry.0 == periods).expect("in the table");
        assert!(failed <= bound, "{periods} periods: {failed}");
        assert_eq!(failed > 0.0, periods >= 5, "{periods} periods: {failed}");
    }
}

#[test]
fn a_lone_station_takes_the_mean_of_its_backoff_two_assessments_and_its_frame() {
    for periods in [5, 7, 12] {
        let medium = Medium { stations: 1, mpdu_octets: octets(periods) };
        let ends: Vec<f64> = (0..8).map(|draw| medium.one_shot(|_, _| draw)[0].end_ms).collect();
        let mean = ends.iter().sum::<f64>() / 8.0;
        assert!((mean - 0.32 * (3.5 + 2.0 + f64::from(periods))).abs() < 1e-9);
    }
}

#[test]
fn one_frame_each_agrees_with_a_slot_simulation() {
    // Stations; received, collided, channel access failure, mean end of the received frames [ms]; 5 periods.
    let table = [
        (2, [0.8755, 0.1245, 0.0000, 5.188]),
        (3, [0.8382, 0.1617, 0.0001, 6.845]),
        (5, [0.7631, 0.2329, 0.0040, 9.296]),
        (10, [0.5712, 0.3718, 0.0570, 13.323]),
        (20, [0.3286, 0.4947, 0.1768, 17.060]),
        (50, [0.1130, 0.5720, 0.3151, 21.533]),
    ];
    let mut draws = Seed(20_261).stream(Purpose::new(3), 0);
    for (stations, expected) in table {
        let medium = Medium { stations, mpdu_octets: octets(5) };
        let rounds = 120_000 / stations;
        let fates: Vec<Vec<Fate>> =
            (0..rounds).map(|_| medium.one_shot(|_, max| draws.random_range(0..=max))).collect();
        let share = |is: fn(&Fate) -> bool| {
            let of_round = |fates: &Vec<Fate>| fates.iter().filter(|&fate| is(fate)).count() as f64 / stations as f64;
            Estimate::of(&fates.iter().map(of_round).collect::<Vec<_>>())
        };
        let received = share(|fate| fate.received);
        let collided = share(|fate| !fate.received && fate.report.outcome == Outcome::Sent);
        let failed = share(|fate| fate.report.outcome == Outcome::ChannelAccessFailure);
        let ends: Vec<f64> = fates.iter().flatten().filter(|fate| fate.received).map(|fate| fate.end_ms).collect();
        let ends = Estimate::of(&ends);
        println!(
            "{stations} stations: {:.4} {:.4} {:.4} {:.3}, expected {expected:?}",
            received.mean, collided.mean, failed.mean, ends.mean
        );
        for (estimate, reference, what) in [
            (received, expected[0], "received"),
            (collided, expected[1], "collided"),
            (failed, expected[2], "failed"),
        ] {
            estimate.assert_is(reference, 7e-4, 1e-4, &format!("{stations} stations: {what}"));
        }
        // Frames of a round depend on each other; a few per cent more than the error allow for this.
        let allowed = 0.01 * expected[3];
        assert!((ends.mean - expected[3]).abs() < allowed, "{stations} stations: {} ms", ends.mean);
    }
}

/// Batches of a saturated run; their means are practically independent.
fn saturated(stations: usize, periods: u8) -> Vec<Accounts> {
    const BATCHES: usize = 40;
    let mut draws = Seed(stations as u64).stream(Purpose::new(3), periods.into());
    let medium = Medium { stations, mpdu_octets: octets(periods) };
    let slots = 2_500_000 / (4 + stations as u64) / BATCHES as u64 * 4;
    medium.saturated(BATCHES, slots, |_, max| draws.random_range(0..=max))
}

#[test]
fn saturated_stations_agree_with_a_slot_simulation() {
    // Stations, periods; throughput, first CCAs per station and slot, share of busy first and second CCAs, share of
    // collided frames, share of frames given up. Printed to three or four digits.
    let table = [
        (1, 7, [0.5600, f64::NAN, 0.0, 0.0, 0.0, 0.0]),
        (1, 12, [0.6857, f64::NAN, 0.0, 0.0, 0.0, 0.0]),
        (2, 7, [0.5570, 0.0794, 0.362, 0.103, 0.125, 0.049]),
        (5, 7, [0.5386, 0.0787, 0.609, 0.244, 0.339, 0.195]),
        (10, 7, [0.4617, 0.0786, 0.703, 0.350, 0.565, 0.351]),
        (20, 7, [0.2851, 0.0786, 0.748, 0.436, 0.818, 0.469]),
        (50, 7, [0.0444, 0.0786, 0.766, 0.484, 0.987, 0.529]),
        (2, 12, [0.6688, 0.0665, 0.460, 0.107, 0.132, 0.095]),
        (5, 12, [0.6230, 0.0725, 0.710, 0.248, 0.344, 0.321]),
        (10, 12, [0.5217, 0.0749, 0.795, 0.351, 0.564, 0.499]),
        (20, 12, [0.3260, 0.0761, 0.834, 0.436, 0.809, 0.616]),
        (50, 12, [0.0538, 0.0766, 0.849, 0.484, 0.985, 0.670]),
    ];
    for (stations, periods, expected) in table {
        let batches = saturated(stations, periods);
        let estimate = |value: fn(&Accounts, f64) -> f64, factor: f64| {
            Estimate::of(&batches.iter().map(|batch| value(batch, factor)).collect::<Vec<_>>())
        };
        let n = stations as f64;
        let found = [
            estimate(|batch, l| batch.received * l / batch.slots, f64::from(periods)),
            estimate(|batch, n| batch.first_ccas / batch.slots / n, n),
            estimate(|batch, _| batch.first_busy / batch.first_ccas, n),
            estimate(|batch, _| batch.second_busy / batch.second_ccas, n),
            estimate(|batch, _| batch.collided / (batch.collided + batch.received), n),
            estimate(|batch, _| batch.failed / (batch.failed + batch.collided + batch.received), n),
        ];
        let means: Vec<String> = found.iter().map(|estimate| format!("{:.4}", estimate.mean)).collect();
        println!("{stations} stations, {periods} periods: {}, expected {expected:?}", means.join(" "));
        let names = ["throughput", "first CCAs", "alpha", "beta", "collided", "given up"];
        let digits = [1e-4, 1e-4, 1e-3, 1e-3, 1e-3, 1e-3];
        for (i, (estimate, reference)) in found.iter().zip(expected).enumerate().filter(|(_, (_, r))| r.is_finite()) {
            // The error of the reference is not stated; its run is as long as this one, so the error is taken as
            // equal.
            let case = format!("{stations} stations, {periods} periods: {}", names[i]);
            estimate.assert_is(reference, estimate.error, digits[i], &case);
        }
    }
}

#[test]
fn first_assessments_agree_with_the_fixed_point_of_independent_stations() {
    // Pollin et al. 2008: phi is the number of first CCAs per station and slot, alpha and beta are the probabilities
    // that the first and the second CCA find the channel busy; solved by damped iteration. The model assumes
    // independent stations, so phi and alpha are accurate to a few per cent, and only for many stations.
    for (stations, periods) in [(5, 7), (10, 7), (20, 7), (50, 7), (5, 12), (10, 12), (20, 12), (50, 12)] {
        let (n, l) = (stations as f64, f64::from(periods));
        let (mut phi, mut alpha) = (0.05_f64, 0.5_f64);
        for _ in 0..10_000 {
            let q = 1.0 - (1.0 - phi).powf(n - 1.0);
            let beta = q / (2.0 - (1.0 - phi).powf(n));
            let x = alpha + (1.0 - alpha) * beta;
            let backoff = |i: i32| f64::from((1 << (3 + i).min(5)) - 1) / 2.0;
            let visits: f64 = (0..5).map(|i| x.powi(i)).sum();
            let spent: f64 = (0..5).map(|i| x.powi(i) * (backoff(i) + 1.0 + (1.0 - alpha))).sum();
            phi += 0.1 * (visits / (spent + (1.0 - x.powi(5)) * l) - phi);
            alpha += 0.1 * (l * q * (1.0 - alpha) * (1.0 - beta) - alpha);
        }
        let batches = saturated(stations, periods);
        let sum = |value: fn(&Accounts) -> f64| batches.iter().map(value).sum::<f64>();
        let first = sum(|batch| batch.first_ccas);
        let found = [first / sum(|batch| batch.slots) / n, sum(|batch| batch.first_busy) / first];
        println!(
            "{stations} stations, {periods} periods: phi {:.4} / {phi:.4}, alpha {:.4} / {alpha:.4}",
            found[0], found[1]
        );
        for (found, model) in found.into_iter().zip([phi, alpha]) {
            assert!(
                (found / model - 1.0).abs() < 0.04,
                "{stations} stations, {periods} periods: {found} and {model}"
            );
        }
    }
}
