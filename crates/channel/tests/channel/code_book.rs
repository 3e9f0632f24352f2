//! Code books: they give back their grid, interpolate in between, and refuse flaws with their line.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;
use sextant_channel::{Antenna, AntennaConfig, CodeBookConfig, Gaps};
use sextant_kernel::{Files, SettingError};

use crate::antenna::{antenna, towards};

/// A gain without symmetry (dBi).
fn gain_dbi(sector: u8, azimuth_deg: i32, elevation_deg: i32) -> f64 {
    let angle = f64::from(azimuth_deg - 60 * i32::from(sector)).to_radians();
    5.0 + 6.0 * angle.cos() - 0.05 * f64::from(elevation_deg) + 0.3 * (3.0 * angle).sin()
}

pub(crate) fn rows(sectors: &[u8], azimuths: impl Iterator<Item = i32> + Clone, elevations: &[i32]) -> String {
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
    read_with(text, CodeBookConfig { outside_gain_dbi, ..CodeBookConfig::default() })
}

/// The code book in the file `text`, with the other settings of `config`.
pub(crate) fn read_with(text: &str, config: CodeBookConfig) -> Result<Antenna, SettingError> {
    let folder = std::env::temp_dir().join(format!("sextant-code-book-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for files");
    let name = format!("{:?}.csv", std::thread::current().id());
    std::fs::write(folder.join(&name), text).expect("a file");
    let config = CodeBookConfig { file: Some(name.into()), ..config };
    Antenna::read(&AntennaConfig::CodeBook(config), &Files::of_folder(&folder))
}

pub(crate) fn whole() -> Antenna {
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
        (format!("{good}2,0,0,loud\n"), "line 18: gain `loud`"),
        (format!("{good}2,0,0,300\n"), "line 18: gain `300`"),
        (format!("{good}2,0,100,1\n"), "line 18: elevation_deg `100`"),
        (
            format!("{good}2,0,0,1\n"),
            "7 gaps in 24 gains of 3 patterns on a grid of 8 directions (azimuths 0 to 270 in steps of 90",
        ),
        (format!("{header}0,0,0,1\n0,90,0,1\n0,270,0,1\n"), "1 gap in 4 gains of 1 pattern on"),
        (good.replace("0,90,", "0,97,"), "azimuths: 97, which is not on steps of"),
        (format!("{header}0,0,0,1\n0,0,10,1\n"), "one azimuth, 0"),
        (format!("{good}2,0,0,\n2,90,0,nan\n"), "sector 2 without a gain in any direction"),
        (format!("{header}0,-180,0,1\n0,0,0,1\n0,180,0,1\n"), "azimuths from -180 to 180"),
    ] {
        let error = read(&text, None).expect_err(words);
        assert_eq!(error.key, "code_book.file");
        assert!(error.found().contains(words), "{error}\nshould say: {words}");
    }
    let missing = CodeBookConfig { file: Some("missing.csv".into()), ..CodeBookConfig::default() };
    assert!(Antenna::read(&AntennaConfig::CodeBook(missing), &Files::of_folder(Path::new("/none"))).is_err());
}

#[test]
fn sectors_have_the_identities_of_the_file_in_the_table_and_on_air() {
    let book = whole();
    assert_eq!(book.sectors().identities(), "1, 5, 63");
    for (number, identity) in [(0, 1), (1, 5), (2, 63)] {
        assert_eq!((book.identity(number), book.address(number).sector), (identity, identity));
    }
    let even = antenna("sectors = { azimuth_sectors = 8, elevations_deg = [0, 40] }").unwrap();
    assert_eq!((even.identity(11), even.address(11).sector, even.address(11).dmg_antenna), (11, 3, 1));
}

#[test]
fn a_planar_cut_holds_within_the_width_of_its_beams() {
    let text = rows(&[0, 3], (-90..=90).step_by(5), &[10]);
    let cut = |outside_gain_dbi, vertical_width_deg| {
        read_with(&text, CodeBookConfig { outside_gain_dbi, vertical_width_deg, ..CodeBookConfig::default() })
    };
    let gain = |book: &Antenna, elevation: f64| book.gain(1, towards(30.0, elevation)).0;
    let plane = gain_dbi(3, 30, 10);
    // Without a width the cut holds at all elevations, and the gain outside holds at other azimuths.
    let endless = cut(Some(-20.0), None).unwrap();
    for elevation in [-89.0, 0.0, 10.0, 10.6, 60.0] {
        assert!((gain(&endless, elevation) - plane).abs() < 1e-9, "{elevation}");
    }
    assert!((endless.gain(1, towards(120.0, 10.0)).0 + 20.0).abs() < 1e-12);
    assert_eq!(endless.endless_cut_deg().map(f64::round), Some(10.0));
    let wedge = |book: &Antenna| {
        let sectors = book.sectors().iter().map(|sector| [sector.elevation_from_deg, sector.elevation_to_deg]);
        sectors.collect::<Vec<_>>()
    };
    assert_eq!(wedge(&endless), [[-90.0, 90.0]; 2]);
    let beam = cut(Some(-20.0), Some(50.0)).unwrap();
    for (elevation, expected) in [(-15.1, -20.0), (-14.9, plane), (10.0, plane), (34.9, plane), (35.1, -20.0)] {
        assert!((gain(&beam, elevation) - expected).abs() < 1e-9, "{elevation}");
    }
    assert_eq!((wedge(&beam), beam.endless_cut_deg()), (vec![[-15.0, 35.0]; 2], None));
    let refused = |outside, width| cut(outside, Some(width)).unwrap_err().key;
    assert_eq!(refused(Some(-20.0), 0.0), "code_book.vertical_width_deg");
    assert_eq!(refused(Some(-20.0), 1e-20), "code_book.vertical_width_deg");
    assert_eq!(refused(Some(-20.0), 181.0), "code_book.vertical_width_deg");
    assert_eq!(refused(None, 50.0), "code_book.outside_gain_dbi");
    let grid = rows(&[0], (0..360).step_by(10), &[0, 10]);
    let config = CodeBookConfig { vertical_width_deg: Some(20.0), ..CodeBookConfig::default() };
    assert_eq!(read_with(&grid, config).unwrap_err().key, "code_book.vertical_width_deg");
}

#[test]
fn the_greatest_measured_gain_is_shifted_to_that_of_the_boresight() {
    // Relative units: the measurement reaches from about -35 to -33 dB, and the gain outside is far above it.
    let text = rows(&[0], (-10..=10).step_by(5), &[0]).replace("gain_dbi", "gain_db");
    let relative = text.lines().skip(1).map(|row| {
        let (place, gain) = row.rsplit_once(',').expect("four fields");
        format!("{place},{}\n", gain.parse::<f64>().expect("a number") - 44.0)
    });
    let text = format!("sector,azimuth_deg,elevation_deg,gain_db\n{}", relative.collect::<String>());
    let of = |boresight_gain_dbi| {
        read_with(
            &text,
            CodeBookConfig { outside_gain_dbi: Some(-3.0), boresight_gain_dbi, ..CodeBookConfig::default() },
        )
    };
    let book = of(Some(12.0)).unwrap();
    let greatest =
        (-10..=10).step_by(5).map(|azimuth| book.gain(0, towards(azimuth.into(), 0.0)).0).fold(-99.0, f64::max);
    assert!((greatest - 12.0).abs() < 1e-9, "{greatest}");
    assert!((book.gain(0, towards(90.0, 0.0)).0 + 3.0).abs() < 1e-12, "the gain outside stays");
    assert!((book.greatest_gain().0 - 12.0).abs() < 1e-9);
    let error = of(None).unwrap_err();
    assert_eq!(error.key, "code_book.boresight_gain_dbi");
}

#[test]
fn gaps_are_named_all_at_once_and_filled_on_request() {
    let mut text = String::from("sector,azimuth_deg,elevation_deg,gain_dbi\n");
    let is_gap = |sector: u8, azimuth: i32, elevation: i32| match elevation {
        0 => (sector == 5 && (20..=40).contains(&azimuth)) || (sector == 1 && azimuth == -180),
        30 => azimuth == 90,
        60 => sector == 5,
        _ => false,
    };
    for (sector, azimuth, elevation) in [1, 5].into_iter().flat_map(|sector| {
        (-180..180)
            .step_by(10)
            .flat_map(move |azimuth| [-30, 0, 30, 60].map(|elevation| (sector, azimuth, elevation)))
    }) {
        match (is_gap(sector, azimuth, elevation), elevation) {
            // A gap is a row that is missing, or one without a number.
            (true, 0) => {}
            (true, 30) => writeln!(text, "{sector},{azimuth},{elevation},nan").expect("a string grows"),
            (true, _) => writeln!(text, "{sector},{azimuth},{elevation},").expect("a string grows"),
            (false, _) => writeln!(text, "{sector},{azimuth},{elevation},{}", gain_dbi(sector, azimuth, elevation))
                .expect("a string grows"),
        }
    }
    let with = |gaps| read_with(&text, CodeBookConfig { gaps, ..CodeBookConfig::default() });
    let error = with(Gaps::Refuse).unwrap_err();
    for words in [
        "42 gaps in 288 gains of 2 patterns on a grid of 144 directions",
        "azimuth 20 to 40, elevation 0: sector 5",
        "azimuth -180, elevation 0: sector 1",
        "azimuth 90, elevation 30: all sectors",
        "azimuth -180 to 170, elevation 60: sector 5",
    ] {
        assert!(error.found().contains(words), "{error}\nshould say: {words}");
    }
    assert!(error.allowed().contains("`gaps = \"interpolate\"`"), "{error}");
    let gain = |book: &Antenna, number, azimuth: i32, elevation: i32| {
        book.gain(number, towards(azimuth.into(), elevation.into())).0
    };
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    let hold = with(Gaps::Hold).unwrap();
    close(gain(&hold, 1, 20, 0), gain_dbi(5, 10, 0));
    close(gain(&hold, 1, 40, 0), gain_dbi(5, 50, 0));
    close(gain(&hold, 0, -180, 0), gain_dbi(1, 170, 0));
    close(gain(&hold, 1, -40, 60), gain_dbi(5, -40, 30));
    let between = with(Gaps::Interpolate).unwrap();
    let (left, right) = (gain_dbi(5, 10, 0), gain_dbi(5, 50, 0));
    for (azimuth, share) in [(20, 0.25), (30, 0.5), (40, 0.75)] {
        close(gain(&between, 1, azimuth, 0), left + share * (right - left));
    }
    // Across the seam of the azimuth, and what was measured stays.
    close(gain(&between, 0, -180, 0), (gain_dbi(1, 170, 0) + gain_dbi(1, -170, 0)) / 2.0);
    close(gain(&between, 0, 50, 60), gain_dbi(1, 50, 60));
    close(gain(&between, 1, -40, 60), gain_dbi(5, -40, 30));
}

#[test]
fn a_few_gains_do_not_make_a_grid_of_millions_of_directions() {
    let mut text = String::from("sector,azimuth_deg,elevation_deg,gain_dbi\n");
    for (azimuth, elevation) in [(0.0, 0.0), (0.1, 0.1), (180.0, 80.0)] {
        writeln!(text, "1,{azimuth},{elevation},3").expect("a string grows");
    }
    let error = read_with(&text, CodeBookConfig { gaps: Gaps::Hold, ..CodeBookConfig::default() }).unwrap_err();
    assert!(error.found().ends_with("a grid of 1801 azimuths times 801 elevations for 3 gains"), "{error}");
    assert_eq!(error.allowed(), "a gain for at least one in 1000 directions of each sector");
}

#[test]
fn factors_are_told_from_decibels_by_their_column() {
    let good = rows(&[0, 1], (0..360).step_by(10), &[0, 10]);
    let factors = good.lines().skip(1).map(|row| {
        let (place, gain) = row.rsplit_once(',').expect("four fields");
        format!("{place},{}\n", 10.0_f64.powf((3.0 * gain.parse::<f64>().expect("a number") - 20.0) / 10.0))
    });
    let factors = factors.collect::<String>();
    let header = |column: &str| format!("sector,azimuth_deg,elevation_deg,{column}\n");
    let read_as = |column: &str| read(&format!("{}{factors}", header(column)), None);
    let (book, known) = (read_as("gain_linear").unwrap(), read(&good, None).unwrap());
    for azimuth in (0..360).step_by(10) {
        let direction = towards(azimuth.into(), 10.0);
        assert!((book.gain(1, direction).0 - (3.0 * known.gain(1, direction).0 - 20.0)).abs() < 1e-9, "{azimuth}");
    }
    let error = read_as("gain_dbi").unwrap_err();
    assert!(error.found().contains("look like factors"), "{error}");
    let error = read(&good.replace("gain_dbi", "gain_linear"), None).unwrap_err();
    assert!(error.found().contains("gain `-") && error.allowed().contains("`gain_dbi`"), "{error}");
    let error = read(&good.replace("gain_dbi", "gain_db,gain_dbi"), None).unwrap_err();
    assert!(error.found().contains("the columns `gain_dbi` and `gain_db`"), "{error}");
}

#[test]
fn a_measured_quasi_omnidirectional_pattern_is_that_of_its_rows() {
    let sectors = rows(&[0, 1], (0..360).step_by(30), &[0]);
    let heard = |azimuth: i32| -4.0 + 3.0 * f64::from(azimuth).to_radians().sin();
    let listening = (0..360)
        .step_by(30)
        .map(|azimuth| format!("quasi_omni,{azimuth},0,{}\n", heard(azimuth)))
        .collect::<String>();
    let of = |config| read_with(&format!("{sectors}{listening}"), config).unwrap();
    let book = of(CodeBookConfig::default());
    assert_eq!(book.sector_count(), 2);
    let gain = |book: &Antenna, azimuth: f64| book.measured_quasi_omni(towards(azimuth, 0.0)).expect("measured").0;
    for azimuth in (0..360).step_by(30) {
        assert!((gain(&book, azimuth.into()) - heard(azimuth)).abs() < 1e-9);
    }
    assert!((gain(&book, 15.0) - (heard(0) + heard(30)) / 2.0).abs() < 1e-9);
    assert!((book.quasi_omni().0 - heard(90)).abs() < 1e-9, "the greatest gain");
    // It moves with the sectors, unless its own greatest gain is given.
    let shift = 14.0 - (0..360).step_by(30).map(|azimuth| gain_dbi(0, azimuth, 0)).fold(-99.0, f64::max);
    let moved = of(CodeBookConfig { boresight_gain_dbi: Some(14.0), ..CodeBookConfig::default() });
    assert!((gain(&moved, 120.0) - heard(120) - shift).abs() < 0.2, "{shift}");
    let own = of(CodeBookConfig { quasi_omni_gain_dbi: Some(2.0), ..CodeBookConfig::default() });
    assert!((own.quasi_omni().0 - 2.0).abs() < 1e-9 && (gain(&own, 0.0) - 2.0 - heard(0) + heard(90)).abs() < 1e-9);
    assert!(whole().measured_quasi_omni(towards(0.0, 0.0)).is_none() && whole().quasi_omni().0.abs() < 1e-12);
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
