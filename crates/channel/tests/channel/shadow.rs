//! The statistics of shadowing. Each bound is five standard errors: a false alarm in 1.7 million runs of each.

use sextant_channel::{CorrelationConfig, Position, Shadowing, ShadowingConfig, SpatialConfig};
use sextant_kernel::{Seed, StationId};

use crate::solids::{at, random_place};

const SIGMA_DB: f64 = 9.6;

fn shadowing(correlation: CorrelationConfig, seed: u64) -> Shadowing {
    let law = ShadowingConfig { sigma_db: Some(SIGMA_DB), correlation }.try_into().expect("good shadowing");
    Shadowing::new(law, Seed(seed))
}

/// Means of x, x² and x y over pairs of draws of unit variance.
fn moments(pairs: impl Iterator<Item = (f64, f64)>) -> (f64, f64, f64, f64) {
    let (mut n, mut x1, mut x2, mut xy) = (0.0, 0.0, 0.0, 0.0);
    for (x, y) in pairs {
        let (x, y) = (x / SIGMA_DB, y / SIGMA_DB);
        n += 1.0;
        x1 += x;
        x2 += x * x;
        xy += x * y;
    }
    (n, x1 / n, x2 / n, xy / n)
}

fn assert_standard_and_correlated(pairs: impl Iterator<Item = (f64, f64)>, correlation: f64) {
    let (n, mean, square, product) = moments(pairs);
    let error = 5.0 / n.sqrt();
    assert!(mean.abs() < error, "mean {mean}");
    assert!((square - 1.0).abs() < error * 2_f64.sqrt(), "variance {square}");
    // The product of two normals of correlation r has variance 1 + r².
    let bound = error * (1.0 + correlation * correlation).sqrt();
    assert!((product - correlation).abs() < bound, "correlation {product}, not {correlation}");
}

const HERE: Position = Position::new(3.0, -4.0, 0.5);
const THERE: Position = Position::new(60.0, 25.0, 0.0);

#[test]
fn each_packet_of_each_pair_has_its_own_draw() {
    let shadowing = shadowing(CorrelationConfig::PerPacket, 11);
    let gain = |a, b, packet| shadowing.gain(StationId(a), HERE, StationId(b), THERE, packet).0;
    assert_standard_and_correlated((0..100_000).map(|k| (gain(1, 2, k), gain(1, 2, k + 1))), 0.0);
    assert_standard_and_correlated((0..100_000).map(|k| (gain(1, 2, k), gain(1, 3, k))), 0.0);
    assert_standard_and_correlated((0..100_000).map(|k| (gain(k, k + 1, 5), gain(k + 1, k + 2, 5))), 0.0);
    assert_eq!(gain(4, 9, 7).to_bits(), gain(9, 4, 7).to_bits());
}

#[test]
fn a_link_keeps_its_draw_while_both_ends_stay() {
    let shadowing = shadowing(CorrelationConfig::PerLink, 12);
    let gain = |a, pa, b, pb, packet| shadowing.gain(StationId(a), pa, StationId(b), pb, packet).0;
    let kept = gain(1, HERE, 2, THERE, 0);
    assert_eq!(kept.to_bits(), gain(1, HERE, 2, THERE, 99).to_bits());
    assert_eq!(kept.to_bits(), gain(2, THERE, 1, HERE, 5).to_bits());
    assert_eq!(kept.to_bits(), gain(1, HERE + at(1e-4, 0.0, 0.0), 2, THERE, 0).to_bits());
    for other in [
        gain(1, HERE + at(0.001, 0.0, 0.0), 2, THERE, 0),
        gain(1, HERE, 2, THERE + at(0.0, 0.0, -0.001), 0),
        gain(3, HERE, 2, THERE, 0),
        gain(1, THERE, 2, HERE, 0),
    ] {
        assert!((kept - other).abs() > 1e-6);
    }
    let step = |k: u32| gain(1, HERE + at(f64::from(k), 0.0, 0.0), 2, THERE, 0);
    assert_standard_and_correlated((0..100_000).map(|k| (step(k), step(k + 1))), 0.0);
}

#[test]
fn a_field_has_unit_variance_at_every_separation_and_the_correlation_of_gudmundson() {
    const DISTANCE_M: f64 = 5.0;
    let spatial = CorrelationConfig::Spatial(SpatialConfig { distance_m: DISTANCE_M });
    let pairs = |a: Position, b: Position, a2: Position, b2: Position| {
        (0..20_000).map(move |seed| {
            let field = shadowing(spatial, seed);
            let gain = |a, b| field.gain(StationId(1), a, StationId(2), b, 0).0;
            (gain(a, b), gain(a2, b2))
        })
    };
    let right = |x| at(x, 0.0, 0.0);
    let up = |y| at(0.0, y, 0.0);
    // One end moves by x.
    for x in [0.0, 1.0, 5.0, 15.0, 1000.0] {
        assert_standard_and_correlated(pairs(HERE, THERE, HERE + up(x), THERE), (-x / DISTANCE_M).exp());
    }
    // Both ends move.
    let both = (-7.0 / DISTANCE_M).exp();
    assert_standard_and_correlated(pairs(HERE, THERE, HERE + right(3.0), THERE + up(4.0)), both);
    // Near ends: still of unit variance.
    for x in [0.0, 0.5, 5.0, 20.0] {
        assert_standard_and_correlated(pairs(HERE, HERE + right(x), HERE + right(x), HERE), 1.0);
    }
}

#[test]
fn one_field_fluctuates_about_zero_with_its_standard_deviation() {
    // 400 places 40 decorrelation distances apart are nearly independent; the waves of one seed are not quite, so the
    // bound on the variance is wide: 25 %.
    let field = shadowing(CorrelationConfig::Spatial(SpatialConfig { distance_m: 1.0 }), 21);
    let draws = (0..2000).map(|k| {
        let gain =
            field.gain(StationId(1), random_place(2 * k, 500.0), StationId(2), random_place(2 * k + 1, 500.0), 0).0;
        (gain, gain)
    });
    let (_, mean, square, _) = moments(draws);
    assert!(mean.abs() < 0.12 && (square - 1.0).abs() < 0.25, "mean {mean}, variance {square}");
}

#[test]
fn equal_seeds_give_equal_bits_and_different_seeds_do_not() {
    for correlation in [
        CorrelationConfig::PerPacket,
        CorrelationConfig::PerLink,
        CorrelationConfig::Spatial(SpatialConfig { distance_m: 2.0 }),
    ] {
        let gain = |seed| shadowing(correlation, seed).gain(StationId(1), HERE, StationId(2), THERE, 3).0;
        assert_eq!(gain(1).to_bits(), gain(1).to_bits());
        assert!((gain(1) - gain(2)).abs() > 1e-9);
    }
}
