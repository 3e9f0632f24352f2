//! Measurements in several formats give the same code book. The MATLAB files were written by SciPy (`fixtures/make.py`).

use std::path::{Path, PathBuf};

use super::*;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/antenna/convert/fixtures").join(name)
}

/// The gains of the fixtures.
fn gain(sector: u8, azimuth: i32, elevation: i32) -> f64 {
    f64::from(sector) + f64::from(azimuth) / 100.0 + f64::from(elevation) / 10.0
}

/// The rows of a code book: sector, azimuth, elevation, gain.
fn rows_of(book: &ConvertedBook) -> Vec<(String, i32, i32, f64)> {
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let whole = |text: &str| format!("{:.0}", number(text)).parse::<i32>().expect("a whole number");
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        (fields[0].to_owned(), whole(fields[1]), whole(fields[2]), number(fields[3]))
    };
    book.text.lines().skip(1).map(row).collect()
}

/// Whether a code book has the gains of the fixtures, but for the gaps.
fn check(book: &ConvertedBook, column: &str, gaps: usize) {
    assert_eq!(book.text.lines().next(), Some(format!("sector,azimuth_deg,elevation_deg,{column}").as_str()));
    assert_eq!((book.sectors, book.directions, book.gaps), (3, 16, gaps), "{book:?}");
    let rows = rows_of(book);
    assert_eq!(rows.len(), 48 - gaps);
    for (sector, azimuth, elevation, found) in rows {
        let expected = gain(sector.parse().expect("a sector"), azimuth, elevation);
        assert!((found - expected).abs() < 1e-4, "{sector} {azimuth} {elevation}: {found}, not {expected}");
    }
}

fn table(text: &str, names: &SourceNames, unit: Option<GainUnit>) -> Result<ConvertedBook, ConvertError> {
    table::rows(text, names)?.book(names, unit)
}

#[test]
fn an_array_in_a_structure_of_a_matlab_file_is_read() {
    let book = convert(&fixture("array.mat"), &SourceNames::default(), None).unwrap();
    check(&book, "gain_db", 1);
    assert!(!rows_of(&book).contains(&("5".into(), -45, 0, gain(5, -45, 0))), "the gap");
}

#[test]
fn vectors_of_a_matlab_file_are_measurements_of_which_the_mean_counts() {
    let book = convert(&fixture("sweeps.mat"), &SourceNames::default(), None).unwrap();
    check(&book, "gain_dbi", 0);
    assert_eq!(book.notes, ["48 directions had several gains: their means in decibels are used"]);
}

#[test]
fn a_long_and_a_wide_table_give_the_same_book() {
    let (sectors, azimuths, elevations) = ([0_u8, 5, 61], (-180..180).step_by(45), [0, 10]);
    let mut long = String::from("Azimuth (deg);Elevation (deg);Sector ID;SNR [dB];count\n");
    let mut wide = String::from("# a tool\naz\tel\tsector_0\tsector_5\tsector_61\n");
    for (azimuth, elevation) in azimuths.flat_map(|azimuth| elevations.map(|elevation| (azimuth, elevation))) {
        // Angles beyond half a circle, as tools write them.
        let written = (azimuth + 360) % 360;
        let gains = sectors.map(|sector| gain(sector, azimuth, elevation));
        wide += &format!("{written}\t{elevation}\t{}\t{}\t{}\n", gains[0], gains[1], gains[2]);
        for (sector, gain) in sectors.iter().zip(gains) {
            long += &format!("{written};{elevation};{sector};{gain};7\n");
        }
    }
    let [long, wide] = [long, wide].map(|text| table(&text, &SourceNames::default(), None).unwrap());
    check(&long, "gain_db", 0);
    check(&wide, "gain_db", 0);
    assert_eq!(long.text, wide.text);
    assert_eq!(long.notes, ["not used: the columns `count`"]);
}

#[test]
fn the_zenith_the_listening_pattern_and_factors_are_understood() {
    let names = SourceNames { from_zenith: true, quasi_omni: Some(0), ..SourceNames::default() };
    let text = "sector,phi,theta,gain_linear\n0,0,90,1\n0,90,90,0.5\n7,0,90,100\n7,90,60,10\n";
    let book = table(text, &names, None).unwrap();
    assert_eq!(
        book.text,
        "sector,azimuth_deg,elevation_deg,gain_linear\n7,0,0,100\n7,90,30,10\nquasi_omni,0,0,1\nquasi_omni,90,0,0.5\n"
    );
    assert_eq!((book.sectors, book.directions, book.gaps), (1, 3, 2));
}

#[test]
fn flaws_say_what_was_found_and_what_is_allowed() {
    let wide: String = (0..40).map(|i| format!("{},{}\n", 9 * i, if i == 0 { 30.0 } else { 0.1 })).collect();
    for (text, unit, words) in [
        (
            "sector,elevation,gain\n1,2,3\n",
            None,
            "no column of azimuths: found the columns `sector`, `elevation`, `gain`",
        ),
        ("azimuth,count of\n1,2\n", None, "no column of sectors, and no column for each sector"),
        ("sector,azimuth,gain\n64,2,3\n", None, "line 2: sector 64; allowed: whole numbers from 0 to 63"),
        ("sector,azimuth,gain\n1,2,loud\n", None, "line 2, column `gain`: `loud`"),
        ("sector,azimuth,theta,gain\n1,2,120,3\n", None, "elevation 120"),
        ("sector,azimuth,gain\n1,2,-3\n", Some(GainUnit::Linear), "a factor of -3"),
        (&format!("azimuth,sector_3\n{wide}"), None, "the unit of the gains is not known"),
    ] {
        let error = table(text, &SourceNames::default(), unit).expect_err(words).to_string();
        assert!(error.contains(words), "{error}\nshould say: {words}");
    }
    assert!(table(&format!("azimuth,sector_3\n{wide}"), &SourceNames::default(), Some(GainUnit::Relative)).is_ok());
    let names = SourceNames { gain: Some("power".into()), ..SourceNames::default() };
    let error = convert(&fixture("array.mat"), &names, None).unwrap_err().to_string();
    assert!(error.contains("no gains: found the variables `book.SNR_dB`, `book.Sector_ID`"), "{error}");
}

#[test]
fn axes_of_equal_length_need_their_order() {
    let array = |dimensions: &[usize]| {
        let count = dimensions.iter().product::<usize>();
        mat::Array { dimensions: dimensions.to_vec(), values: (0..count).map(|i| i as f64).collect() }
    };
    let mut variables = std::collections::BTreeMap::new();
    variables.insert("gain_db".to_owned(), array(&[2, 2, 3]));
    variables.insert("sector".to_owned(), array(&[1, 2]));
    variables.insert("azimuth".to_owned(), array(&[1, 2]));
    variables.insert("elevation".to_owned(), array(&[3, 1]));
    let error = arrays::rows(&variables, &SourceNames::default()).err().expect("two orders fit").to_string();
    assert!(error.contains("2 by 2 by 3, with 2 sectors, 2 azimuths and 3 elevations"), "{error}");
    let names = SourceNames { order: "azimuth,sector,elevation".parse().ok(), ..SourceNames::default() };
    let book = arrays::rows(&variables, &names).and_then(|source| source.book(&names, None)).unwrap();
    // The first axis runs fastest: azimuth 1, sector 0, elevation 2 is place 1 + 2 * (0 + 2 * 2).
    assert!(rows_of(&book).contains(&("0".into(), 1, 2, 9.0)), "{}", book.text);
    variables.insert("gain_db".to_owned(), array(&[2, 5]));
    assert!(matches!(arrays::rows(&variables, &names), Err(ConvertError::Shape { .. })));
}

#[test]
fn a_matlab_file_that_is_cut_or_changed_is_refused_or_read_without_panic() {
    for name in ["array.mat", "sweeps.mat"] {
        let whole = std::fs::read(fixture(name)).unwrap();
        for length in (0..whole.len()).step_by(7) {
            let _ = mat::read(&whole[..length]);
        }
        for place in 0..whole.len().min(1500) {
            let mut changed = whole.clone();
            changed[place] ^= 0x5A;
            if let Ok(variables) = mat::read(&changed) {
                let _ = arrays::rows(&variables, &SourceNames::default());
            }
        }
    }
    let error = mat::read(b"MATLAB 7.3 MAT-file, Platform: GLNXA64").unwrap_err().to_string();
    assert!(error.contains("7.3; allowed: versions 5 to 7.2"), "{error}");
}
