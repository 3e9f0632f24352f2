//! Many sensors that answer one sweep at once, against closed forms and another simulation.
//!
//! Frames that overlap are lost, everybody hears everybody, all sensors are ready at the end of the sweep. The times of
//! CSMA/CA are means of a simulation that shares no code with this crate, printed to three digits.

mod medium;

use medium::{Medium, Round};
use rand::RngExt;
use sextant_kernel::{Purpose, Seed};
use sextant_mac::dmg::{AbftConfig, ContentionConfig, CsmaFeedbackConfig, SweepConfig, SweepSettings};

/// Seed of the draws.
const SEED: Seed = Seed(60_480);

fn settings(contention: ContentionConfig) -> SweepSettings {
    SweepSettings::try_from(SweepConfig { contention, window_ms: 1000.0, ..SweepConfig::default() })
        .expect("good settings")
}

const WITH_FEEDBACK: ContentionConfig =
    ContentionConfig::CsmaFeedback(CsmaFeedbackConfig { max_retries: 7, report_all_sectors: false });
const ABFT: ContentionConfig = ContentionConfig::Abft(AbftConfig { slots: 8, frames_per_slot: 8, feedback: true });

/// A mean over rounds, and its standard error.
#[derive(Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

impl Estimate {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            count += 1.0;
            sum += value;
            squares += value * value;
        }
        let mean: f64 = sum / count;
        Self { mean, error: ((squares / count - mean * mean) / count).sqrt() }
    }

    /// Four standard errors, of the estimate and of the reference together: a false alarm once in 16 000.
    #[track_caller]
    fn assert_is(&self, reference: f64, reference_error: f64) {
        let tolerance = 4.0 * self.error.hypot(reference_error);
        assert!((self.mean - reference).abs() <= tolerance, "{self:?}, not {reference} within {tolerance}");
    }
}

/// `rounds` first sweeps with `sensors` sensors.
fn rounds(sensors: usize, contention: ContentionConfig, rounds: usize) -> Vec<Round> {
    let mut draws = SEED.stream(Purpose::new(3), u64::try_from(sensors).expect("few"));
    let mut draw = |max| draws.random_range(0..=max);
    let settings = settings(contention);
    (0..rounds).map(|_| Medium::new(sensors, settings).round(&vec![true; sensors], &mut draw)).collect()
}

fn answered(rounds: &[Round], sensors: usize) -> Estimate {
    Estimate::of(rounds.iter().map(|round| round.answered as f64 / sensors as f64))
}

fn span_ms(rounds: &[Round]) -> Estimate {
    Estimate::of(rounds.iter().map(|round| 1e3 * round.span.as_secs_f64()))
}

#[test]
fn an_answer_is_received_if_no_other_sensor_drew_the_same_backoff() {
    for (sensors, count) in [(1, 100), (2, 8000), (3, 5000), (4, 4000), (8, 2000), (16, 600)] {
        let expected = (15.0_f64 / 16.0).powi(sensors - 1);
        let sensors = usize::try_from(sensors).expect("positive");
        answered(&rounds(sensors, ContentionConfig::Csma, count), sensors).assert_is(expected, 0.0);
    }
}

#[test]
fn a_sensor_that_is_alone_starts_after_55_5_us() {
    let rounds = rounds(1, ContentionConfig::Csma, 20_000);
    let start = Estimate::of(rounds.iter().map(|round| 1e6 * round.first_start.expect("it answers").as_secs_f64()));
    start.assert_is(18.0 + 7.5 * 5.0, 0.0);
    // The sweep of eight sectors takes 126.272 us.
    let end = span_ms(&rounds);
    end.assert_is(0.001 * (55.5 + 126.272), 0.0);
}

/// Rounding of a reference to a step, as a standard error.
fn rounding(step: f64) -> f64 {
    step / 12.0_f64.sqrt()
}

#[test]
fn the_last_of_several_sensors_has_sent_after_the_time_of_another_simulation() {
    let table = [
        (1, 4000, 0.182, 0.001),
        (2, 4000, 0.330, 0.001),
        (3, 3000, 0.462, 0.001),
        (4, 3000, 0.589, 0.001),
        (8, 1500, 1.00, 0.01),
        (16, 400, 1.56, 0.01),
        (32, 100, 2.09, 0.01),
    ];
    for (sensors, count, ms, step) in table {
        span_ms(&rounds(sensors, ContentionConfig::Csma, count)).assert_is(ms, rounding(step));
    }
}

#[test]
fn with_feedback_a_few_sensors_all_succeed_after_the_time_of_another_simulation() {
    // With 8 and 16 sensors, that simulation prints 1.85 and 4.29 ms, these machines 1.82 and 4.10 ms: after a collision
    // the stations that were not in it wait for AIFS only, not for a feedback that cannot come.
    for (sensors, count, ms) in [(1, 4000, 0.209), (2, 4000, 0.412), (3, 3000, 0.621), (4, 3000, 0.849)] {
        let rounds = rounds(sensors, WITH_FEEDBACK, count);
        assert!(rounds.iter().all(|round| round.trained.len() == sensors && round.answered == sensors));
        span_ms(&rounds).assert_is(ms, rounding(0.001));
    }
}

#[test]
fn in_an_abft_an_answer_is_received_if_no_other_sensor_drew_the_same_slot() {
    for (sensors, count) in [(1, 100), (2, 8000), (3, 5000), (4, 4000), (8, 2000), (16, 600)] {
        let expected = (7.0_f64 / 8.0).powi(sensors - 1);
        let sensors = usize::try_from(sensors).expect("positive");
        answered(&rounds(sensors, ABFT, count), sensors).assert_is(expected, 0.0);
    }
}

/// Mean number of A-BFTs of eight slots until each of 0 to `most` sensors was alone in its slot once: an absorbing Markov
/// chain whose state is how many are left.
fn mean_abfts(most: usize) -> Vec<f64> {
    let mut means = vec![0.0];
    for left in 1..=most {
        // shares[balls][alone]: the probability that, of the sensors left, so many are in the slots counted so far, and so
        // many of them alone. A slot further gets each remaining sensor with probability 1 / (slots that remain).
        let mut shares = vec![vec![0.0; left + 1]; left + 1];
        shares[0][0] = 1.0;
        for slot in 0..8 {
            let mut next = vec![vec![0.0; left + 1]; left + 1];
            let p = 1.0 / f64::from(8 - slot);
            for placed in 0..=left {
                for alone in 0..=placed {
                    let mut share =
                        shares[placed][alone] * (1.0 - p).powi(i32::try_from(left - placed).expect("few"));
                    if slot == 7 {
                        share = if placed == left { shares[placed][alone] } else { 0.0 };
                    }
                    for here in 0..=left - placed {
                        if slot == 7 {
                            share = if here == left - placed { shares[placed][alone] } else { 0.0 };
                        }
                        next[placed + here][alone + usize::from(here == 1)] += share;
                        share *= (left - placed - here) as f64 / (here + 1) as f64 * p / (1.0 - p);
                    }
                }
            }
            shares = next;
        }
        let alone = &shares[left];
        let later: f64 = (1..=left).map(|k| alone[k] * means[left - k]).sum();
        means.push((1.0 + later) / (1.0 - alone[0]));
    }
    means
}

#[test]
fn the_number_of_abfts_until_all_sensors_succeed_is_that_of_the_markov_chain() {
    let exact = mean_abfts(8);
    // Printed by another simulation: 1.00, 1.16, 1.72 and 3.00.
    for (sensors, printed) in [(1, 1.00), (2, 1.16), (4, 1.72), (8, 3.00)] {
        assert!((exact[sensors] - printed).abs() < 0.02, "{sensors}: {}", exact[sensors]);
    }
    assert!((exact[2] - 8.0 / 7.0).abs() < 1e-12);
    let mut draws = SEED.stream(Purpose::new(3), 99);
    let mut draw = |max| draws.random_range(0..=max);
    for (sensors, count) in [(2, 2000), (4, 1000), (8, 500)] {
        let mut needed = Vec::new();
        for _ in 0..count {
            let mut medium = Medium::new(sensors, settings(ABFT));
            let mut ready = vec![true; sensors];
            let mut abfts = 0.0;
            while ready.contains(&true) {
                for sensor in medium.round(&ready, &mut draw).trained {
                    ready[sensor] = false;
                }
                abfts += 1.0;
            }
            needed.push(abfts);
        }
        Estimate::of(needed.into_iter()).assert_is(exact[sensors], 0.0);
    }
}
