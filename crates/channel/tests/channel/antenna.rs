//! Antennas: gains against the formulas of their sources, energy, sectors and their names.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use sextant_channel::{Antenna, AntennaConfig, Orientation, Position, SectorAddress};
use sextant_kernel::{Seed, SettingError, StationId};

pub(crate) fn antenna(text: &str) -> Result<Antenna, SettingError> {
    toml::from_str::<AntennaConfig>(text).unwrap_or_else(|error| panic!("{error}")).try_into()
}

fn good(text: &str) -> Antenna {
    antenna(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The unit vector at an azimuth and an elevation.
pub(crate) fn towards(azimuth_deg: f64, elevation_deg: f64) -> Position {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    Position::new(azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos(), elevation.sin())
}

/// Mean of the gain factor of a sector over the sphere, by the midpoint rule: 1 for an antenna without losses.
fn radiated_share(antenna: &Antenna, sector: u8) -> f64 {
    const STEPS: u32 = 1500;
    let mut sum = 0.0;
    for i in 0..STEPS {
        // Equal steps of the sine of the elevation are equal areas.
        let z = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(STEPS);
        let across = (1.0 - z * z).sqrt();
        for j in 0..STEPS {
            let azimuth = TAU * (f64::from(j) + 0.5) / f64::from(STEPS);
            let direction = Position::new(across * azimuth.cos(), across * azimuth.sin(), z);
            sum += antenna.gain(sector, direction).to_factor();
        }
    }
    sum / f64::from(STEPS * STEPS)
}

#[track_caller]
fn assert_gain(antenna: &Antenna, direction: Position, dbi: f64, tolerance: f64) {
    let gain = antenna.gain(0, direction).0;
    assert!((gain - dbi).abs() <= tolerance, "{gain} dBi instead of {dbi}");
}

#[test]
fn the_reference_antenna_has_the_gains_of_its_formula() {
    // IEEE 802.15-06-0474: half-power width, gain at the boresight, gain of the side lobes, rounded.
    for (sectors, peak, side) in [
        (64, 30.35, -11.29),
        (32, 24.34, -11.57),
        (24, 21.86, -11.69),
        (16, 18.37, -11.86),
        (12, 15.91, -11.98),
        (8, 12.51, -12.14),
        (6, 10.19, -12.26),
        (4, 7.18, -12.43),
    ] {
        let antenna = good(&format!("sectors.azimuth_sectors = {sectors}"));
        let width = 360.0 / f64::from(sectors);
        assert_gain(&antenna, towards(0.0, 0.0), peak, 0.006);
        assert_gain(&antenna, towards(180.0, 0.0), side, 0.006);
        // Half the power at the edge, in azimuth and in elevation: the beam is round.
        for direction in [towards(width / 2.0, 0.0), towards(0.0, -width / 2.0)] {
            let drop = antenna.gain(0, towards(0.0, 0.0)).0 - antenna.gain(0, direction).0;
            assert!((drop - 3.01).abs() < 1e-9, "{drop}");
        }
        // The main lobe ends 1.3 widths away, 20.35 dB below the peak.
        assert_gain(&antenna, towards(1.2999 * width, 0.0), peak - 20.35, 0.02);
        assert_gain(&antenna, towards(1.3001 * width, 0.0), side, 0.006);
        assert!((antenna.greatest_gain().0 - peak).abs() < 0.006);
    }
}

#[test]
fn the_reference_antenna_may_be_continuous_or_end_at_the_edge_of_the_sector() {
    let continuous = good("sectors = { azimuth_sectors = 8, pattern.ieee802153c.lobe_edge = \"continuous\" }");
    let gain = |deg: f64| continuous.gain(0, towards(deg, 0.0)).0;
    let steepest = (0..18_000).map(|i| gain(f64::from(i) * 0.01) - gain(f64::from(i + 1) * 0.01)).fold(0.0, f64::max);
    assert!(steepest < 0.05, "a step of {steepest} dB");
    assert!((gain(180.0) + 12.14).abs() < 0.006);

    let narrow = good("sectors = { azimuth_sectors = 8, pattern.ieee802153c.sector_edge = \"main_lobe\" }");
    let peak = narrow.gain(0, towards(0.0, 0.0)).0;
    // The half-power width is 360 / (2.6 · 8) = 17.31 degrees.
    assert!((peak - 20.0 * (1.6162 / (180.0 / 20.8_f64).to_radians().sin()).log10()).abs() < 1e-9);
    assert_gain(&narrow, towards(22.499, 0.0), peak - 20.35, 0.01);
    assert!(narrow.gain(0, towards(22.51, 0.0)).0 < -11.0);
}

#[test]
fn elliptical_beams_and_elements_fall_by_their_own_widths() {
    let text =
        "sectors = { azimuth_sectors = 64, vertical_width_deg = 45, elevations_deg = [30], pattern.elliptical = {} }";
    let elliptical = good(text);
    assert_gain(&elliptical, towards(0.0, 30.0), 22.1, 0.06);
    assert_gain(&elliptical, towards(0.0, 52.5), 22.1 - 3.0, 0.06);
    assert_gain(&elliptical, towards(0.0, 7.5), 22.1 - 3.0, 0.06);
    assert_gain(&elliptical, towards(180.0, 0.0), 22.1 - 30.0, 0.06);
    assert_gain(&good("sectors = { azimuth_sectors = 8, pattern.elliptical = {} }"), towards(0.0, 0.0), 13.1, 0.01);
    let element = good("sectors = { azimuth_sectors = 3, pattern.tr38901 = {} }");
    assert_gain(&element, towards(0.0, 0.0), 8.0, 1e-12);
    assert_gain(&element, towards(32.5, 0.0), 5.0, 1e-9);
    assert_gain(&element, towards(0.0, 32.5), 5.0, 1e-9);
    assert_gain(&element, towards(32.5, 32.5), 2.0, 1e-9);
    assert_gain(&element, towards(-102.7, 0.0), 8.0 - 12.0 * (102.7_f64 / 65.0).powi(2), 1e-9);
    assert_gain(&element, towards(-103.0, 0.0), -22.0, 1e-9);
}

#[test]
fn a_flat_top_radiates_all_its_power() {
    // Gains inside by the closed forms: 8.63 dB (wedge) and 13.76 dB (cone) at 45 degrees, -10 dBi outside.
    for (beam, peak) in [("wedge", 8.63), ("cone", 13.76)] {
        let antenna = good(&format!("sectors = {{ azimuth_sectors = 8, pattern.flat_top.beam = \"{beam}\" }}"));
        assert_gain(&antenna, towards(0.0, 0.0), peak, 0.006);
        assert_gain(&antenna, towards(22.4, 0.0), peak, 0.006);
        assert_gain(&antenna, towards(22.6, 0.0), -10.0, 1e-12);
        let share = radiated_share(&antenna, 3);
        assert!((share - 1.0).abs() < 0.01, "{beam}: {share}");
    }
    let tall = good(
        "sectors = { azimuth_sectors = 8, elevations_deg = [0, 60], vertical_width_deg = 45, \
         pattern.flat_top = { outside_gain_dbi = -inf } }",
    );
    for sector in [2, 9] {
        let share = radiated_share(&tall, sector);
        assert!((share - 1.0).abs() < 0.01, "{share}");
    }
    assert!(tall.gain(0, towards(0.0, 30.0)).0 == f64::NEG_INFINITY && tall.gain(0, towards(0.0, 20.0)).0 > 13.0);
    assert!(tall.gain(8, towards(0.0, 80.0)).0 > 13.0 && tall.gain(8, towards(0.0, 30.0)).0 == f64::NEG_INFINITY);
}

#[test]
fn a_given_gain_at_the_boresight_moves_the_whole_pattern() {
    for pattern in ["ieee802153c = {}", "elliptical = {}", "tr38901 = {}", "flat_top = {}"] {
        let of = |more: &str| good(&format!("sectors = {{ azimuth_sectors = 8{more}, pattern.{pattern} }}"));
        let (own, given) = (of(""), of(", boresight_gain_dbi = 4.1"));
        assert_gain(&given, towards(0.0, 0.0), 4.1, 1e-12);
        let shift = 4.1 - own.gain(0, towards(0.0, 0.0)).0;
        for deg in [10.0, 40.0, 100.0, 180.0] {
            let direction = towards(deg, 5.0);
            assert!((given.gain(0, direction) - own.gain(0, direction)).0 - shift < 1e-12);
        }
    }
}

#[test]
fn each_direction_of_the_circle_has_the_sector_that_its_wedge_says() {
    for sectors in [1, 2, 3, 8, 64] {
        for pattern in ["ieee802153c", "elliptical", "tr38901", "flat_top"] {
            let text = format!("first_azimuth_deg = 10, azimuth_sectors = {sectors}, pattern.{pattern} = {{}}");
            let antenna = good(&format!("sectors = {{ {text} }}"));
            let width = 360.0 / f64::from(sectors);
            for step in 0..720_u32 {
                let azimuth = f64::from(step) * 0.5 + 0.123;
                let expected = (((azimuth - 10.0 + width / 2.0).rem_euclid(360.0)) / width).floor();
                let from_edge = ((azimuth - 10.0 + width / 2.0).rem_euclid(width)).min(width);
                if from_edge < 1e-6 || sectors == 1 {
                    continue;
                }
                let best = antenna.best_sector(towards(azimuth, 0.0));
                assert!((f64::from(best) - expected).abs() < 0.5, "{sectors} {pattern} {azimuth}: {best}");
                let wedges = antenna.sectors();
                let wedge = wedges.iter().nth(usize::from(best)).unwrap();
                assert!((azimuth - wedge.azimuth_from_deg).rem_euclid(360.0) < width + 1e-9, "{azimuth} {wedge:?}");
            }
        }
    }
}

#[test]
fn rings_are_antennas_of_an_array_or_tilts_of_one() {
    let address = |dmg_antenna, sector| SectorAddress { dmg_antenna, sector };
    let array = good("sectors = { azimuth_sectors = 8, elevations_deg = [0, 45] }");
    assert_eq!((array.sector_count(), array.rings(), array.sweeps()), (16, 2, 1));
    assert_eq!((array.address(7), array.address(8)), (address(0, 7), address(1, 0)));
    assert_eq!(array.address(11), address(1, 3));
    assert!((0..16).all(|sector| array.address(sector) != address(2, 3)));
    let steered = good("sectors = { azimuth_sectors = 8, elevations_deg = [0, 30, 60], vertical = \"steered\" }");
    assert_eq!((steered.sweeps(), steered.sectors_of_sweep(2)), (3, 16..24));
    assert_eq!((steered.address(1), steered.address(17)), (address(0, 1), address(0, 1)));
    let elevations: Vec<_> = (0..16).map(|i| (-75 + i * 10).to_string()).collect();
    let many = good(&format!("sectors = {{ azimuth_sectors = 8, elevations_deg = [{}] }}", elevations.join(", ")));
    assert_eq!((many.sector_count(), many.address(31), many.address(127)), (128, address(0, 31), address(3, 31)));
    let interval = |antenna: &Antenna, sector: usize| {
        let table = antenna.sectors();
        let found = table.iter().nth(sector).unwrap();
        (found.elevation_from_deg, found.elevation_to_deg)
    };
    assert_eq!((interval(&array, 0), interval(&array, 8)), ((-90.0, 22.5), (22.5, 90.0)));
    let narrow = good("sectors = { azimuth_sectors = 8, elevations_deg = [0, 80], vertical_width_deg = 30 }");
    assert_eq!((interval(&narrow, 0), interval(&narrow, 8)), ((-15.0, 15.0), (65.0, 90.0)));
}

#[test]
fn ripple_is_drawn_for_each_station_and_sector_and_is_bounded() {
    let antenna = good("sectors = { azimuth_sectors = 64, gain_ripple_db = 1 }");
    let ripple = antenna.ripple(Seed(1), StationId(3));
    assert_eq!(ripple, antenna.ripple(Seed(1), StationId(3)));
    assert_ne!(ripple, antenna.ripple(Seed(1), StationId(4)));
    assert_ne!(ripple, antenna.ripple(Seed(2), StationId(3)));
    let all: Vec<f64> = (0..200).flat_map(|id| antenna.ripple(Seed(1), StationId(id))).map(|db| db.0).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let variance = all.iter().map(|db| db * db).sum::<f64>() / all.len() as f64;
    // Five standard errors of 12 800 draws.
    assert!(mean.abs() < 5.0 / 113.1 && (variance - 1.0).abs() < 5.0 * 2_f64.sqrt() / 113.1, "{mean} {variance}");
    let peak = antenna.gain(0, towards(0.0, 0.0)).0;
    assert!(all.iter().all(|db| peak + db <= antenna.greatest_gain().0));
    assert!(good("sectors.azimuth_sectors = 8").ripple(Seed(1), StationId(0)).is_empty());
}

#[test]
fn an_omnidirectional_antenna_has_one_gain() {
    let antenna = good("omnidirectional.gain_dbi = 2.15");
    assert!(antenna.is_omnidirectional() && antenna.sectors().is_empty() && antenna.sector_count() == 1);
    assert_gain(&antenna, towards(33.0, 44.0), 2.15, 1e-12);
    assert!((antenna.quasi_omni().0 - 2.15).abs() < 1e-12);
    assert!(Antenna::default().gain(0, towards(1.0, 2.0)).0.abs() < 1e-12);
    assert!((good("sectors = { azimuth_sectors = 8, quasi_omni_gain_dbi = 5 }").quasi_omni().0 - 5.0).abs() < 1e-12);
}

#[test]
fn invalid_antennas_are_rejected_with_their_key() {
    for (text, key) in [
        ("sectors.azimuth_sectors = 0", "sectors.azimuth_sectors"),
        ("sectors.azimuth_sectors = 65", "sectors.azimuth_sectors"),
        ("sectors = { azimuth_sectors = 64, elevations_deg = [-30, 0, 30] }", "sectors.elevations_deg"),
        (
            "sectors = { azimuth_sectors = 64, elevations_deg = [-30, 0, 30, 60], vertical = \"steered\" }",
            "sectors.elevations_deg",
        ),
        ("sectors = { azimuth_sectors = 8, elevations_deg = [] }", "sectors.elevations_deg"),
        ("sectors = { azimuth_sectors = 8, elevations_deg = [30, 0] }", "sectors.elevations_deg"),
        ("sectors = { azimuth_sectors = 8, elevations_deg = [nan] }", "sectors.elevations_deg"),
        ("sectors = { azimuth_sectors = 8, elevations_deg = [91] }", "sectors.elevations_deg"),
        ("sectors = { azimuth_sectors = 8, first_azimuth_deg = nan }", "sectors.first_azimuth_deg"),
        ("sectors = { azimuth_sectors = 8, beam_width_deg = 0 }", "sectors.beam_width_deg"),
        ("sectors = { azimuth_sectors = 8, beam_width_deg = 181 }", "sectors.beam_width_deg"),
        (
            "sectors = { azimuth_sectors = 8, beam_width_deg = 20, pattern.ieee802153c.sector_edge = \"main_lobe\" }",
            "sectors.beam_width_deg",
        ),
        ("sectors = { azimuth_sectors = 8, vertical_width_deg = -1 }", "sectors.vertical_width_deg"),
        ("sectors = { azimuth_sectors = 8, boresight_gain_dbi = nan }", "sectors.boresight_gain_dbi"),
        ("sectors = { azimuth_sectors = 8, quasi_omni_gain_dbi = inf }", "sectors.quasi_omni_gain_dbi"),
        ("sectors = { azimuth_sectors = 8, gain_ripple_db = -1 }", "sectors.gain_ripple_db"),
        (
            "sectors = { azimuth_sectors = 8, pattern.flat_top.outside_gain_dbi = 1 }",
            "sectors.pattern.flat_top.outside_gain_dbi",
        ),
        (
            "sectors = { azimuth_sectors = 8, pattern.tr38901.azimuth_width_deg = 0 }",
            "sectors.pattern.tr38901.azimuth_width_deg",
        ),
        ("omnidirectional.gain_dbi = nan", "omnidirectional.gain_dbi"),
    ] {
        assert_eq!(antenna(text).expect_err(text).key, key, "{text}");
    }
    assert!(antenna("sectors = { azimuth_sectors = 64, elevations_deg = [0, 30] }").is_ok());
    assert!(
        antenna("sectors = { azimuth_sectors = 64, elevations_deg = [0, 3, 6], vertical = \"steered\" }").is_ok()
    );
}

proptest! {
    #[test]
    fn turning_antenna_and_direction_together_changes_nothing(
        yaw in -PI..PI, azimuth in -180.0..180.0_f64, elevation in -90.0..90.0_f64, sector in 0..8_u8,
    ) {
        let antenna = good("sectors = { azimuth_sectors = 8, elevations_deg = [20], pattern.elliptical = {} }");
        let direction = towards(azimuth, elevation);
        let turned = towards(azimuth + yaw.to_degrees(), elevation);
        let seen = Orientation::heading(yaw).to_antenna_frame(turned);
        prop_assert!((antenna.gain(sector, seen) - antenna.gain(sector, direction)).0.abs() < 1e-9);
        prop_assert!(antenna.gain(sector, direction) <= antenna.greatest_gain());
    }
}
