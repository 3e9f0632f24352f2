//! Fading of links: laws of its depth, what it depends on, and its level crossings.

use std::time::Duration;

use sextant_channel::{
    Db, Fading, FadingBand, FadingConfig, FadingEnd, FadingLaw, FadingLawConfig, NakagamiConfig, Position,
    RicianConfig,
};
use sextant_kernel::{Purpose, Seed, SimTime, StationId};

/// A wavelength of 0.12287 m.
const BAND: FadingBand = FadingBand { reference_hz: 2.44e9, center_hz: 2.44e9 };
/// Number of waves of a field.
const WAVES: i32 = 16;

fn fading(config: FadingConfig, seed: u64) -> Fading {
    Fading::new(FadingLaw::try_from(config).expect("a good law"), BAND, Seed(seed))
}

fn end(station: u32, x_m: f64, y_m: f64) -> FadingEnd {
    FadingEnd { station: StationId(station), place: Position::new(x_m, y_m, 0.0) }
}

fn seconds(t_s: f64) -> SimTime {
    SimTime::ZERO + Duration::from_secs_f64(t_s)
}

fn rician(k_db: f64) -> FadingConfig {
    FadingConfig { law: FadingLawConfig::Rician(RicianConfig { k_db }), ..FadingConfig::default() }
}

fn nakagami(m: f64) -> FadingConfig {
    FadingConfig { law: FadingLawConfig::Nakagami(NakagamiConfig { m }), ..FadingConfig::default() }
}

/// Gains, as factors, of links at places that are far apart.
fn gains(config: FadingConfig, count: u32) -> Vec<f64> {
    let mut fading = fading(config, 11);
    (0..count)
        .map(|i| {
            let place = |axis| 50.0 * Seed(5).uniform(Purpose::new(9001), [i.into(), axis, 0]);
            let (a, b) = (end(2 * i, place(0), place(1)), end(2 * i + 1, place(2), place(3)));
            fading.gain(a, b, seconds(f64::from(i))).to_factor()
        })
        .collect()
}

/// The largest distance between the shares of `samples` below a value and `law`.
fn kolmogorov(samples: Vec<f64>, law: impl Fn(f64) -> f64) -> f64 {
    kolmogorov_at_most(samples, 1, law)
}

/// An upper bound of it from each `step`-th sample alone: between two of these, the share changes by `step - 1` samples.
fn kolmogorov_at_most(mut samples: Vec<f64>, step: usize, law: impl Fn(f64) -> f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let n = samples.len() as f64;
    let distance = |(i, &x): (usize, &f64)| {
        let of_law = law(x);
        (of_law - i as f64 / n).abs().max((of_law - (i as f64 + 1.0) / n).abs())
    };
    samples.iter().enumerate().step_by(step).map(distance).fold(0.0, f64::max) + (step - 1) as f64 / n
}

/// Probability that the sum of N unit vectors of random directions has a square below N x: `r ∫ J1(r t) J0(t)^N dt` with
/// r = √(N x) (Kluyver 1906), by Simpson's rule.
fn kluyver() -> impl Fn(f64) -> f64 {
    let (steps, last) = (4000, 30.0);
    let h = last / f64::from(steps);
    let weight = |i: i32| match i {
        _ if i == 0 || i == steps => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let points: Vec<(f64, f64)> = (0..=steps)
        .map(|i| (h * f64::from(i), weight(i)))
        .map(|(t, weight)| (t, weight * libm::j0(t).powi(WAVES)))
        .collect();
    move |x| {
        let r = (f64::from(WAVES) * x).sqrt();
        r * h / 3.0 * points.iter().map(|(t, factor)| factor * libm::j1(r * t)).sum::<f64>()
    }
}

#[test]
fn sixteen_waves_have_the_law_of_kluyver_and_nearly_that_of_rayleigh() {
    const COUNT: u32 = 20_000;
    let powers = gains(FadingConfig::default(), COUNT);
    // A false alarm in a million runs with other seeds: sqrt(ln(2e6) / 2 / n).
    let most = (2e6_f64.ln() / 2.0 / f64::from(COUNT)).sqrt();
    assert!(most < 0.0191);
    let kluyver = kluyver();
    let distance = kolmogorov_at_most(powers.clone(), 40, &kluyver);
    assert!(distance < most, "{distance}");
    let distance = kolmogorov(powers.clone(), |x| 1.0 - (-x).exp());
    assert!(distance < most, "{distance}");
    // Five standard errors each.
    let n = f64::from(COUNT);
    let mean = powers.iter().sum::<f64>() / n;
    let square = powers.iter().map(|x| x * x).sum::<f64>() / n;
    assert!((mean - 1.0).abs() < 5.0 * (1.0 / n).sqrt(), "{mean}");
    assert!((square - 1.9375).abs() < 5.0 * (16.0 / n).sqrt(), "{square}");
    for (level, share) in [(0.1, 0.0927), (0.01, 0.0097)] {
        assert!((kluyver(level) - share).abs() < 3e-4, "{}", kluyver(level));
        let found = powers.iter().filter(|&&x| x < level).count() as f64 / n;
        assert!((found - share).abs() < 5.0 * (share / n).sqrt(), "{level}: {found}");
    }
}

#[test]
fn rician_and_nakagami_gains_have_their_laws_as_fields_and_in_blocks() {
    const COUNT: u32 = 8000;
    // As above, and 0.004 because of the few waves.
    let most = (2e6_f64.ln() / 2.0 / f64::from(COUNT)).sqrt() + 0.004;
    for config in [rician(0.0), rician(6.0), rician(12.0), nakagami(0.5), nakagami(1.5), nakagami(2.0), nakagami(4.0)]
    {
        for config in [config, FadingConfig { block_s: Some(0.4), ..config }] {
            let law = FadingLaw::try_from(config).expect("a good law");
            let distance = kolmogorov(gains(config, COUNT), |x| law.share_below(Db::from_factor(x)));
            assert!(distance < most, "{config:?}: {distance}");
        }
    }
}

#[test]
fn a_link_is_alike_in_both_directions_and_whatever_was_asked_before() {
    for config in [
        FadingConfig { doppler_hz: 3.0, ..rician(3.0) },
        nakagami(2.5),
        FadingConfig { block_s: Some(0.1), ..rician(3.0) },
    ] {
        let (mut one, mut other) = (fading(config, 3), fading(config, 3));
        let links: Vec<_> = (0..3000_u32)
            .map(|i| (end(i % 70, f64::from(i), 2.0), end(70 + i % 50, 1.0, f64::from(i % 9))))
            .collect();
        let forth: Vec<_> = links.iter().map(|&(a, b)| one.gain(a, b, seconds(7.25)).0.to_bits()).collect();
        let back: Vec<_> = links.iter().rev().map(|&(a, b)| other.gain(b, a, seconds(7.25)).0.to_bits()).collect();
        assert!(forth.iter().eq(back.iter().rev()));
    }
}

#[test]
fn stations_that_stand_have_a_constant_fade_and_one_that_comes_back_finds_it_again() {
    let mut still = fading(rician(3.0), 8);
    let (here, there, sink) = (end(0, 3.0, 4.0), end(0, 3.2, 4.0), end(1, 0.0, 0.0));
    let first = still.gain(here, sink, seconds(0.0));
    assert_eq!(still.gain(here, sink, seconds(1000.0)), first);
    assert_ne!(still.gain(there, sink, seconds(1000.0)), first);
    assert_eq!(still.gain(here, sink, seconds(2000.0)), first);
    let mut walked = fading(FadingConfig { doppler_hz: 1.0, ..rician(3.0) }, 8);
    assert_ne!(walked.gain(here, sink, seconds(0.0)), walked.gain(here, sink, seconds(0.2)));
    // A block lasts for its time.
    let mut blocks = fading(FadingConfig { block_s: Some(0.5), ..FadingConfig::default() }, 8);
    assert_eq!(blocks.gain(here, sink, seconds(3.0)), blocks.gain(there, sink, seconds(3.49)));
    assert_ne!(blocks.gain(here, sink, seconds(3.0)), blocks.gain(here, sink, seconds(3.51)));
}

/// Rice (1945): sqrt(2π) f_d ρ exp(-ρ²) crossings a second, and (exp(ρ²) - 1) / (ρ f_d sqrt(2π)) seconds below.
#[test]
fn levels_are_crossed_as_often_and_for_as_long_as_rice_says() {
    let doppler_hz = 10.0;
    for (rho, crossings_per_s, fade_s) in [(0.1, 2.482, 0.004_01), (0.3162, 7.172, 0.0133), (1.0, 9.221, 0.0685)] {
        let root = std::f64::consts::TAU.sqrt();
        assert!((root * doppler_hz * rho * f64::exp(-rho * rho) / crossings_per_s - 1.0_f64).abs() < 0.001);
        assert!((((rho * rho).exp() - 1.0_f64) / (rho * doppler_hz * root) / fade_s - 1.0).abs() < 0.01);
        let mut walked = fading(FadingConfig { doppler_hz, ..FadingConfig::default() }, 41);
        let (mut crossings, mut below) = (0_u32, 0_u32);
        // 150 links for 2 s each, in steps of 0.5 ms: the shortest fades last for about 4 ms.
        for link in 0..150_u32 {
            let mut was_below = None;
            for step in 0..4000_u32 {
                let t_s = 5e-4 * f64::from(step);
                let gain = walked.gain(end(2 * link, 1.0, 0.0), end(2 * link + 1, 9.0, 3.0), seconds(t_s));
                let is_below = gain.to_factor() < rho * rho;
                crossings += u32::from(was_below == Some(true) && !is_below);
                below += u32::from(is_below);
                was_below = Some(is_below);
            }
        }
        let rate = f64::from(crossings) / 300.0;
        let mean_s = 5e-4 * f64::from(below) / f64::from(crossings);
        // 750 crossings at the lowest level, in clusters; with 16 waves they are up to 4 % more and shorter.
        assert!((rate / crossings_per_s - 1.0).abs() < 0.15, "{rho}: {rate}");
        assert!((mean_s / fade_s - 1.0).abs() < 0.15, "{rho}: {mean_s}");
    }
}

#[test]
fn what_is_remembered_of_many_standing_links_changes_no_gain() {
    let mut long = fading(nakagami(1.0), 3);
    let at = |station: u32, moved_m: f64| end(station, f64::from(station) + moved_m, 0.5 * f64::from(station));
    for round in 0..3 {
        // More links than are remembered at first; in the last round one end of each has moved.
        let moved_m = if round == 2 { 0.03 } else { 0.0 };
        for pair in 0..3000_u32 {
            let (a, b) = (at(pair % 60, 0.0), at(60 + pair / 60, moved_m));
            let gain = long.gain(a, b, seconds(f64::from(round)));
            if pair % 100 == 7 {
                assert_eq!(gain, fading(nakagami(1.0), 3).gain(b, a, seconds(50.0)), "{pair} in round {round}");
            }
        }
    }
}
