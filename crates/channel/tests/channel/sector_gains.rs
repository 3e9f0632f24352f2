//! Gains of a listener's sectors: read again from their settings, and turned.

use std::sync::Arc;

use sextant_channel::{
    Antenna, AntennaConfig, CodeBookConfig, ListenerAntennaConfig, Orientation, Position, SectorConfig, SectorGains,
    SectorTable,
};
use sextant_kernel::Files;

use crate::antenna::{antenna, towards};
use crate::code_book::{read_with, rows, whole};

/// Directions all around, on no grid of an antenna.
fn directions() -> impl Iterator<Item = Position> {
    (0..36).flat_map(|azimuth| {
        (-8..=8).map(move |elevation| towards(f64::from(azimuth) * 10.3, f64::from(elevation) * 11.1))
    })
}

/// Antennas of all kinds.
fn antennas() -> Vec<Antenna> {
    let with_listening = {
        let text = rows(&[2, 40], (-180..180).step_by(10), &[-30, 0, 30]);
        let heard = |azimuth: i32, elevation: i32| {
            format!("quasi_omni,{azimuth},{elevation},{}\n", 1.3 - f64::from(azimuth * elevation) * 1e-4)
        };
        let heard = (-180..180).step_by(10).flat_map(|azimuth| [-30, 0, 30].map(|row| heard(azimuth, row)));
        format!("{text}{}", heard.collect::<String>())
    };
    let cut = CodeBookConfig {
        vertical_width_deg: Some(31.3),
        outside_gain_dbi: Some(f64::NEG_INFINITY),
        boresight_gain_dbi: Some(17.1),
        quasi_omni_gain_dbi: Some(-2.5),
        gain_ripple_db: 1.5,
        ..CodeBookConfig::default()
    };
    let scaled = CodeBookConfig { boresight_gain_dbi: Some(20.3), ..CodeBookConfig::default() };
    vec![
        whole(),
        read_with(&with_listening, scaled).expect("a code book"),
        read_with(&rows(&[0, 9], (-91..90).step_by(7), &[3]), cut).expect("a planar cut"),
        antenna("omnidirectional.gain_dbi = 2.5").expect("an antenna"),
        antenna("sectors = { azimuth_sectors = 7, first_azimuth_deg = 11.1, elevations_deg = [-20, 25.5] }")
            .expect("an antenna"),
        antenna("sectors = { azimuth_sectors = 4, pattern.elliptical = {}, gain_ripple_db = 2.5 }")
            .expect("an antenna"),
    ]
}

#[test]
fn an_antenna_is_read_again_from_the_text_of_its_settings() {
    for antenna in antennas() {
        let text = toml::to_string(&antenna.config()).expect("a text");
        let written: AntennaConfig = toml::from_str(&text).expect("settings");
        let again = Antenna::try_from(written).expect("an antenna");
        assert_eq!(again.config(), antenna.config());
        assert_eq!(again.sectors(), antenna.sectors());
        let same = |one: f64, other: f64| assert_eq!(one.to_bits(), other.to_bits(), "{one} {other}");
        same(again.quasi_omni().0, antenna.quasi_omni().0);
        same(again.greatest_gain().0, antenna.greatest_gain().0);
        for direction in directions() {
            for sector in 0..antenna.sector_count() {
                assert_eq!(again.identity(sector), antenna.identity(sector));
                same(again.gain(sector, direction).0, antenna.gain(sector, direction).0);
            }
            assert_eq!(again.measured_quasi_omni(direction), antenna.measured_quasi_omni(direction));
        }
    }
}

#[test]
fn gains_are_equal_if_their_antennas_have_the_same_settings_and_are_turned_alike() {
    let orientation = |yaw_deg: f64| Orientation::new(yaw_deg.to_radians(), 0.25, -12.3_f64.to_radians());
    let turned = |yaw_deg| SectorGains::new(Arc::new(whole()), orientation(yaw_deg));
    assert_eq!(turned(0.3), turned(0.3));
    assert_ne!(turned(0.3), turned(0.4));
    let other = CodeBookConfig { boresight_gain_dbi: Some(3.0), ..CodeBookConfig::default() };
    let other = read_with(&rows(&[1, 5, 63], (-180..180).step_by(10), &[-30, 0, 30, 60]), other).expect("a book");
    assert_ne!(turned(0.3), SectorGains::new(Arc::new(other), orientation(0.3)));
    let text = toml::to_string(&turned(0.3).config().expect("sectors")).expect("a text");
    let config: ListenerAntennaConfig = toml::from_str(&text).expect("settings");
    assert_eq!(SectorGains::read(&config, &Files::default()).expect("gains"), turned(0.3));
}

#[test]
fn a_file_has_one_antenna_with_sectors() {
    let read = |text: &str| {
        let config: ListenerAntennaConfig = toml::from_str(text).expect("settings");
        SectorGains::read(&config, &Files::default()).map(|gains| SectorTable::from(gains).identities())
    };
    assert_eq!(read("sectors.azimuth_sectors = 5"), Ok("0 to 4".to_owned()));
    assert_eq!(read("orientation.yaw_deg = 5").unwrap_err().key, "sectors");
    let both = "sectors.azimuth_sectors = 5\ncode_book.file = 'a.csv'";
    assert_eq!(read(both).unwrap_err().key, "code_book");
    assert_eq!(read("code_book.file = 'missing.csv'").unwrap_err().key, "code_book.file");
    let turned = "sectors.azimuth_sectors = 5\norientation.roll_deg = nan";
    assert_eq!(read(turned).unwrap_err().key, "orientation.roll_deg");
}

#[test]
fn a_turn_about_the_vertical_moves_the_azimuths_of_the_wedges() {
    let rings = antenna("sectors = { azimuth_sectors = 8, elevations_deg = [-30, 20] }").expect("an antenna");
    for antenna in [rings, whole()].map(Arc::new) {
        for yaw_deg in [0.0, 77.0, -300.0] {
            let orientation = Orientation::heading(f64::to_radians(yaw_deg));
            let table = SectorTable::from(SectorGains::new(Arc::clone(&antenna), orientation));
            assert_eq!(table.len(), antenna.sectors().len());
            for (turned, level) in table.iter().zip(antenna.sectors().iter()) {
                let expected = [level.azimuth_from_deg + yaw_deg, level.azimuth_to_deg + yaw_deg];
                assert!((turned.azimuth_from_deg - expected[0]).abs() < 1e-9);
                assert!((turned.azimuth_to_deg - expected[1]).abs() < 1e-9);
                let of = |sector: &SectorConfig| (sector.sector, sector.wedge().expect("a wedge").elevation_rad);
                assert_eq!(of(turned), of(level));
            }
        }
    }
}

#[test]
fn the_wedges_of_a_tilted_antenna_have_the_directions_where_each_sector_is_the_best() {
    let rings = antenna("sectors = { azimuth_sectors = 8, elevations_deg = [-30, 20] }").expect("an antenna");
    for antenna in [rings, whole()].map(Arc::new) {
        for angles_deg in [[-20.0, 15.0, 0.0], [10.0, -40.0, 130.0], [30.0, 0.0, 90.0]] {
            let [yaw, pitch, roll] = angles_deg.map(f64::to_radians);
            let orientation = Orientation::new(yaw, pitch, roll);
            let table = SectorTable::from(SectorGains::new(Arc::clone(&antenna), orientation));
            let wedges: Vec<_> = table.iter().map(|sector| sector.wedge().expect("a wedge")).collect();
            for direction in directions() {
                let best = usize::from(antenna.best_sector(orientation.to_antenna_frame(direction)));
                let wedge = wedges[best];
                let azimuth = direction.y_m.atan2(direction.x_m) - wedge.azimuth_from_rad;
                let inside = azimuth.rem_euclid(std::f64::consts::TAU) <= wedge.azimuth_width_rad + 1e-9;
                let elevation = direction.z_m.asin();
                let [low, high] = wedge.elevation_rad;
                let is_high_enough = low - 1e-9 <= elevation && elevation <= high + 1e-9;
                assert!(inside && is_high_enough, "{angles_deg:?} {direction} {best}");
            }
        }
    }
}
