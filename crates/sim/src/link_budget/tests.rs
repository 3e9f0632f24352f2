//! Shares of frames against sums over all draws.

use sextant_channel::{
    ChannelConfig, CorrelationConfig, FadingConfig, FadingLawConfig, NakagamiConfig, RicianConfig, ShadowingConfig,
};
use sextant_mac::oqpsk::bit_error_rate;

use super::*;

const AIRTIME: Duration = Duration::from_micros(1_600);

fn law(sigma_db: f64) -> ChannelLaw {
    let shadowing = Some(ShadowingConfig { sigma_db: Some(sigma_db), correlation: CorrelationConfig::PerPacket });
    ChannelConfig { shadowing, ..ChannelConfig::default() }.try_into().expect("a good channel")
}

fn rules() -> ReceptionRules {
    ReceptionRules {
        model: ReceptionModel::Ber,
        sensitivity: Dbm(-97.0).to_milliwatts(),
        noise: Dbm(-95.0).to_milliwatts(),
        preamble: Duration::from_micros(160),
        lock: 0.0,
        carrier: None,
        bit_rate_hz: 250_000.0,
        bit_error_rate,
    }
}

#[test]
fn shares_are_the_sum_over_all_draws_and_what_is_left_out_as_below_is_below() {
    let rules = rules();
    let alone = |dbm: f64| rules.reception_alone(Dbm(dbm).to_milliwatts(), AIRTIME);
    let mut left_out = 0;
    for sigma_db in [0.5, 4.0, 9.0] {
        for mean in (-130..-60).map(f64::from) {
            let (mut sum, mut weights) = (0.0, 0.0);
            for step in -240..=240 {
                let z = f64::from(step) / 40.0;
                weights += libm::exp(-0.5 * z * z);
                sum += libm::exp(-0.5 * z * z) * alone(mean + sigma_db * z);
            }
            let share = over_shadowing(&law(sigma_db), &rules, Dbm(mean), AIRTIME);
            assert!((share - sum / weights).abs() < 1e-15, "{share} {}", sum / weights);
            for least in [0.1, 0.5, 0.9] {
                let is_below = is_below(least, &law(sigma_db), &rules, Dbm(mean), AIRTIME);
                assert!(!is_below || share < least, "{share} {least}");
                left_out += u32::from(is_below);
            }
        }
    }
    assert!(left_out > 200, "{left_out}");
}

#[test]
fn what_is_left_out_as_below_is_below_with_fading_too() {
    let deep = FadingLawConfig::Nakagami(NakagamiConfig { m: 0.5 });
    let shallow = FadingLawConfig::Rician(RicianConfig { k_db: 6.0 });
    let mut left_out = 0;
    for depth in [deep, shallow] {
        let fading = Some(FadingConfig { law: depth, ..FadingConfig::default() });
        for sigma_db in [0.0, 4.0] {
            let shadowing =
                Some(ShadowingConfig { sigma_db: Some(sigma_db), correlation: CorrelationConfig::PerPacket });
            let config = ChannelConfig { shadowing, fading, ..ChannelConfig::default() };
            let law = config.try_into().expect("a good channel");
            for mean in (-130..-80).step_by(2).map(f64::from) {
                let share = over_shadowing(&law, &rules(), Dbm(mean), AIRTIME);
                for least in [0.1, 0.5] {
                    let is_below = is_below(least, &law, &rules(), Dbm(mean), AIRTIME);
                    assert!(!is_below || share < least, "{share} {least} at {mean} dBm");
                    left_out += u32::from(is_below);
                }
            }
        }
    }
    assert!(left_out > 40, "{left_out}");
}
