//! The examples of channel access of one's own, against their closed forms.

use crate::examples::{aloha, tdma, x_mac};

/// Runs of the same setting with different seeds.
const RUNS: u64 = 20;

/// Four and a half standard errors of the mean of twenty runs, which follows Student's t with 19 degrees of freedom: a false
/// alarm in 4000 tests of a value.
const DEVIATIONS: f64 = 4.5;

/// Asserts that the mean of runs is `expected`.
fn assert_mean(what: &str, values: &[f64], expected: f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    assert!((mean - expected).abs() < DEVIATIONS * error, "{what}: {mean} +- {error}, not {expected}");
    // The test must be able to fail.
    assert!(error < 0.02 * expected, "{what}: {error} of {expected}");
}

fn runs<T>(of: impl Fn(u64) -> Result<T, Box<dyn std::error::Error>>) -> Vec<T> {
    (1..=RUNS).map(|seed| of(seed).expect("a good run")).collect()
}

#[test]
fn the_throughput_of_aloha_is_that_of_its_closed_form() {
    for load in [0.2, 0.5, 1.2] {
        let pause_s = 50.0 * 832e-6 / load - 1024e-6;
        for (name, aloha) in [
            ("pure", aloha::Aloha::Pure { pause_s }),
            ("slotted", aloha::Aloha::Slotted { probability: load / 50.0 }),
        ] {
            let expected = aloha.closed_form();
            assert!((aloha.load() - load).abs() < 1e-9);
            assert_mean(&format!("{name} {load}"), &runs(|seed| aloha.simulated(seed)), expected);
            // Fifty nodes are nearly as many as without end.
            let limit = load * libm::exp(-load * if name == "pure" { 2.0 } else { 1.0 });
            assert!((expected / limit - 1.0).abs() < 0.03, "{expected} and {limit}");
        }
    }
}

#[test]
fn tdma_delivers_all_after_the_wait_for_a_slot() {
    for load in [0.2, 0.7] {
        let (found, expected) = (runs(|seed| tdma::simulated(load, seed)), tdma::closed_form(load));
        assert!(found.iter().all(|found| found.delivery >= 1.0), "{load}: {found:?}");
        let delays: Vec<f64> = found.iter().map(|found| found.delay_s).collect();
        assert_mean(&format!("delay at {load}"), &delays, expected.delay_s);
        let duties: Vec<f64> = found.iter().map(|found| found.duty).collect();
        assert_mean(&format!("duty cycle at {load}"), &duties, expected.duty);
    }
}

/// Mean number of strobes of X-MAC, exactly: a packet comes at any time since the start of a window, and the first strobe that
/// begins in a window is heard. Windows of `window_s` begin at each `interval_s`, strobes at each `period_s`.
fn exact_strobes(interval_s: f64, window_s: f64, period_s: f64) -> f64 {
    let steps = 1_000_000;
    let strobes = |step: u32| {
        // Time since the start of the last window.
        let since_s = (f64::from(step) + 0.5) / f64::from(steps) * interval_s;
        let wait_s = if since_s < window_s { 0.0 } else { interval_s - since_s };
        1.0 + (wait_s / period_s).ceil()
    };
    (0..steps).map(strobes).sum::<f64>() / f64::from(steps)
}

#[test]
fn x_mac_needs_the_strobes_and_the_time_of_its_closed_form() {
    let period_s = 1312e-6;
    for interval_s in [0.125, 0.25] {
        let (found, closed) = (runs(|seed| x_mac::simulated(interval_s, seed)), x_mac::closed_form(interval_s));
        assert!(found.iter().all(|found| found.delivery >= 1.0), "{interval_s}: {found:?}");
        let strobes = exact_strobes(interval_s, period_s, period_s);
        let column = |of: fn(&x_mac::Measured) -> f64| found.iter().map(of).collect::<Vec<f64>>();
        assert_mean(&format!("strobes at {interval_s}"), &column(|found| found.strobes), strobes);
        // Strobes that come before the one that is heard delay the packet by a period each.
        let delay_s = closed.delay_s + (strobes - closed.strobes) * period_s;
        assert_mean(&format!("delay at {interval_s}"), &column(|found| found.delay_s), delay_s);
        for found in &found {
            assert!((found.idle_duty / closed.idle_duty - 1.0).abs() < 1e-3, "{interval_s}: {}", found.idle_duty);
        }
        // What the closed forms leave out: a packet may come during a window.
        assert!((strobes / closed.strobes - 1.0).abs() < 2.0 * period_s / interval_s);
    }
}
