//! Code books: they give back their grid, interpolate in between, and refuse flaws with their line.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;
use sextant_channel::{Antenna, AntennaConfig, CodeBookConfig};
use sextant_kernel::{Files, SettingError};

use crate::antenna::{antenna, towards};

/// A gain without symmetry (dBi).
fn gain_dbi(sector: u8, azimuth_deg: i32, elevation_deg: i32) -> f64 {
    let angle = f64::from(azimuth_deg - 60 * i32::from(sector)).to_radians();
    5.0 + 6.0 * angle.cos() - 0.05 * f64::from(elevation_deg) + 0.3 * (3.0 * angle).sin()
}

fn rows(sectors: &[u8], azimuths: impl Iterator<Item = i32> + Clone, elevations: &[i32]) -> String {
    let mut text = "sector,azimuth_deg,elevation_deg,gain_dbi\n".to_owned();
    for &sector in sectors {
        for azimuth in azimuths.clone() {
            for &elevation in elevations {
                writeln!(text, "{sector},{azimuth},{elevation},{}", gain_dbi(sector, azimuth, elevation))
                    .expect("a string grows");
            }
        }
    }
    text
}

fn read(text: &str, outside_gain_dbi: Option<f64>) -> Result<Antenna, SettingError> {
    let folder = std::env::temp_dir().join(format!("sextant-code-book-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for files");
    let name = format!("{:?}.csv", std::thread::current().id());
    std::fs::write(folder.join(&name), text).expect("a file");
    let config = CodeBookConfig { file: Some(name.into()), outside_gain_dbi, ..CodeBookConfig::default() };
    Antenna::read(&AntennaConfig::CodeBook(config), &Files::of_folder(&folder))
}

fn whole() -> Antenna {
    read(&rows(&[1, 5, 63], (-180..180).step_by(10), &[-30, 0, 30, 60]), None).expect("a whole grid")
}

#[test]
fn a_code_book_gives_back_its_grid() {
    let book = whole();
    assert_eq!(book.sector_count(), 3);
    let identities: Vec<_> = (0..3).map(|sector| book.address(sector).sector).collect();
    assert_eq!(identities, [1, 5, 63]);
    for (sector, identity) in [(0, 1), (1, 5), (2, 63)] {
        for azimuth in (-180..180).step_by(10) {
            for elevation in [-30, 0, 30, 60] {
                let found = book.gain(sector, towards(azimuth.into(), elevation.into())).0;
                let expected = gain_dbi(identity, azimuth, elevation);
                assert!((found - expected).abs() < 1e-9, "{identity} {azimuth} {elevation}: {found} {expected}");
            }
        }
    }
    // Half way between four places of the grid, across the seam of the azimuth.
    let mean = (gain_dbi(5, 170, 0) + gain_dbi(5, -180, 0) + gain_dbi(5, 170, 30) + gain_dbi(5, -180, 30)) / 4.0;
    assert!((book.gain(1, towards(175.0, 15.0)).0 - mean).abs() < 1e-9);
    // Above and below the grid its border holds.
    assert!((book.gain(0, towards(20.0, 85.0)).0 - gain_dbi(1, 20, 60)).abs() < 1e-9);
    assert!((book.gain(0, towards(20.0, -90.0)).0 - 0.0).is_finite());
}

#[test]
fn the_table_has_the_directions_where_each_sector_is_the_best() {
    let book = read(&rows(&[0, 2, 4], (0..360).step_by(5), &[0]), None).unwrap();
    let table = book.sectors();
    assert_eq!(table.len(), 3);
    for azimuth in 0..360 {
        let best = book.best_sector(towards(azimuth.into(), 0.0));
        let wedge = table.iter().nth(best.into()).unwrap();
        let into = (f64::from(azimuth) - wedge.azimuth_from_deg).rem_euclid(360.0);
        assert!(into <= wedge.azimuth_to_deg - wedge.azimuth_from_deg + 1e-9, "{azimuth}: {wedge:?}");
        assert_eq!((wedge.elevation_from_deg, wedge.elevation_to_deg), (-90.0, 90.0));
    }
    // Each sector is the best in a third of the circle; no interval is wider than that by more than three steps.
    assert!(table.iter().all(|wedge| wedge.azimuth_to_deg - wedge.azimuth_from_deg <= 120.0 + 15.0));
}

#[test]
fn a_measurement_of_one_side_needs_the_gain_of_the_other() {
    let text = rows(&[0, 1], (-90..=90).step_by(5), &[0, 10, 20]);
    let error = read(&text, None).unwrap_err();
    assert_eq!(error.key, "code_book.outside_gain_dbi");
    assert!(error.found().contains("from -90 to 90"), "{error}");
    let book = read(&text, Some(-20.0)).unwrap();
    let gain = |azimuth, elevation| book.gain(1, towards(azimuth, elevation)).0;
    assert!(
        (gain(90.0, 0.0) - gain_dbi(1, 90, 0)).abs() < 1e-9
            && (gain(-90.0, 20.0) - gain_dbi(1, -90, 20)).abs() < 1e-9
    );
    for (azimuth, elevation) in [(90.1, 0.0), (-91.0, 5.0), (180.0, 0.0), (0.0, 20.1), (0.0, -0.1)] {
        assert!((gain(azimuth, elevation) + 20.0).abs() < 1e-12, "{azimuth} {elevation}");
    }
}

#[test]
fn a_code_book_stands_in_a_scenario_too() {
    let text = "code_book = { azimuths_deg = [0, 90, 180, 270], elevations_deg = [0], \
                sectors = [{ sector = 0, gain_dbi = [[9, 3, -3, 3]] }, { sector = 7, gain_dbi = [[-3, 3, 9, 3]] }]";
    let book = antenna(&format!("{text} }}")).unwrap();
    assert!((book.gain(0, towards(45.0, 0.0)).0 - 6.0).abs() < 1e-9 && book.address(1).sector == 7);
    assert!((book.greatest_gain().0 - 9.0).abs() < 1e-12);
    let shifted = antenna(&format!("{text}, boresight_gain_dbi = 14 }}")).unwrap();
    assert!((shifted.gain(1, towards(0.0, 0.0)).0 - 2.0).abs() < 1e-9);
    for (text, key) in [
        ("code_book = {}", "code_book.azimuths_deg"),
        ("code_book = { azimuths_deg = [0, 180] }", "code_book.elevations_deg"),
        ("code_book = { azimuths_deg = [0, 180], elevations_deg = [0] }", "code_book.sectors"),
        ("code_book = { azimuths_deg = [0, 180], elevations_deg = [0], sectors = [] }", "code_book.sectors"),
        ("code_book = { azimuths_deg = [0, 50, 90], elevations_deg = [0], sectors = [] }", "code_book.azimuths_deg"),
        (
            "code_book = { azimuths_deg = [0, 180], elevations_deg = [0], sectors = [{ sector = 1, gain_dbi = [[1]] }] }",
            "code_book.sectors[0].gain_dbi",
        ),
        (
            "code_book = { azimuths_deg = [0, 180], elevations_deg = [0], \
             sectors = [{ sector = 1, gain_dbi = [[1, nan]] }] }",
            "code_book.sectors[0].gain_dbi",
        ),
        (
            "code_book = { azimuths_deg = [0, 180], elevations_deg = [0], \
             sectors = [{ sector = 1, gain_dbi = [[1, 2]] }, { sector = 1, gain_dbi = [[1, 2]] }] }",
            "code_book.sectors[1].sector",
        ),
        (
            "code_book = { azimuths_deg = [0, 180], elevations_deg = [0], sectors = [{ sector = 64, gain_dbi = [[1, 2]] }] }",
            "code_book.sectors",
        ),
        ("code_book = { file = \"x.csv\", azimuths_deg = [0, 180] }", "code_book.file"),
        ("code_book.file = \"missing.csv\"", "code_book.file"),
    ] {
        assert_eq!(antenna(text).expect_err(text).key, key, "{text}");
    }
}

#[test]
fn flaws_of_a_file_are_named_with_their_line() {
    let good = rows(&[0, 1], (0..360).step_by(90), &[0, 10]);
    assert!(read(&good, None).is_ok());
    assert!(read(&format!("# measured in a chamber\n\n{good}"), None).is_ok());
    let header = "sector,azimuth_deg,elevation_deg,gain_dbi\n";
    for (text, words) in [
        (String::new(), "which is empty"),
        (header.to_owned(), "which has a header only"),
        (good.replacen("gain_dbi", "gain", 1), "line 1: no column `gain_dbi`"),
        (good.replacen("gain_dbi", "gain_dbi,sector", 1), "line 1: two columns `sector`"),
        (good.replacen("gain_dbi", "gain_dbi,snr", 1), "line 1: an unknown column `snr`"),
        (format!("{good}0,90,10,3\n"), "line 18: sector 0 at azimuth 90, elevation 10 again, as in line 5"),
        (format!("{good}0,95,10\n"), "line 18: 3 fields"),
        (format!("{good}64,95,10,1\n"), "line 18: sector `64`"),
        (format!("{good}left,95,10,1\n"), "line 18: sector `left`"),
        (format!("{good}2,0,0,nan\n"), "line 18: gain_dbi `nan`"),
        (format!("{good}2,0,100,1\n"), "line 18: elevation_deg `100`"),
        (format!("{good}2,0,0,1\n"), "a gap: sector 2 (lines 18 to 18) has no row at azimuth 90, elevation 0"),
        (format!("{header}0,0,0,1\n0,90,0,1\n0,270,0,1\n"), "azimuths: a gap: 270 after 90"),
        (good.replace("0,90,", "0,80,"), "azimuths: a gap"),
        (format!("{header}0,-180,0,1\n0,0,0,1\n0,180,0,1\n"), "azimuths from -180 to 180"),
    ] {
        let error = read(&text, None).expect_err(words);
        assert_eq!(error.key, "code_book.file");
        assert!(error.found().contains(words), "{error}\nshould say: {words}");
    }
    let missing = CodeBookConfig { file: Some("missing.csv".into()), ..CodeBookConfig::default() };
    assert!(Antenna::read(&AntennaConfig::CodeBook(missing), &Files::of_folder(Path::new("/none"))).is_err());
}

proptest! {
    #[test]
    fn a_code_book_is_continuous(azimuth in -200.0..200.0_f64, elevation in -89.0..89.0_f64, sector in 0..3_u8) {
        let book = whole();
        let gain = |azimuth, elevation| book.gain(sector, towards(azimuth, elevation)).0;
        let here = gain(azimuth, elevation);
        // The grid never rises by more than 0.2 dB per degree.
        prop_assert!((gain(azimuth + 0.01, elevation) - here).abs() < 0.003);
        prop_assert!((gain(azimuth, elevation + 0.01) - here).abs() < 0.003);
        prop_assert!(here <= book.greatest_gain().0);
    }
}
