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

/// What `text` becomes, or the error.
fn converted(text: &str, names: &SourceNames) -> Result<String, String> {
    table(text, names, Some(GainUnit::Dbi)).map(|book| book.text).map_err(|error| error.to_string())
}

/// A table with these names of columns, and a beam at an azimuth of 90 degrees on the horizon; `angle` makes what is written of
/// degrees of azimuth and of elevation.
fn beam(header: &str, angle: impl Fn(i32, i32) -> (f64, f64)) -> String {
    let mut text = format!("{header}\n");
    for azimuth in (-180..180).step_by(30) {
        for elevation in (-90..=90).step_by(30) {
            let (written_azimuth, written_elevation) = angle(azimuth, elevation);
            let gain = if (azimuth, elevation) == (90, 0) { 12.0 } else { -3.0 };
            text += &format!("{written_azimuth},{written_elevation},{gain}\n");
        }
    }
    text
}

/// The direction of the greatest gain (degrees).
fn peak(book: &str) -> (f64, f64) {
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let rows = book.lines().skip(1).map(|line| line.split(',').skip(1).map(number).collect::<Vec<_>>());
    let best = rows.max_by(|a, b| a[2].total_cmp(&b[2])).expect("rows");
    (best[0], best[1])
}

#[test]
fn theta_is_the_angle_from_the_zenith_where_it_can_be_nothing_else_and_asked_for_otherwise() {
    let spherical = |azimuth: i32, elevation: i32| (f64::from(azimuth), f64::from(90 - elevation));
    let level = |azimuth: i32, elevation: i32| (f64::from(azimuth), f64::from(elevation));
    let none = SourceNames::default();
    for header in
        ["phi,theta,gain", "Phi [deg.],Theta [deg.],gain", "φ,θ,gain", "azimuth,zenith,gain", "phi,polar angle,gain"]
    {
        let book = converted(&beam(header, spherical), &none).unwrap();
        assert_eq!(peak(&book), (90.0, 0.0), "{header}");
    }
    for header in ["azimuth,elevation,gain", "az_deg,el_deg,gain"] {
        assert_eq!(peak(&converted(&beam(header, level), &none).unwrap()), (90.0, 0.0), "{header}");
    }
    // From 0 to 90 it may be either; so may angles with a sign.
    let half = "phi,theta,gain\n0,0,-3\n90,0,-3\n0,45,-3\n90,45,-3\n0,90,-3\n90,90,12\n";
    for text in [half.to_owned(), beam("phi,theta,gain", level)] {
        let problem = converted(&text, &none).unwrap_err();
        assert!(problem.contains("the angles `theta` may be measured from the zenith"), "{problem}");
        assert!(problem.contains("different angles from"), "{problem}");
    }
    let zenith = SourceNames { from_zenith: true, ..none.clone() };
    assert_eq!(peak(&converted(half, &zenith).unwrap()), (90.0, 0.0));
    let elevation = SourceNames { elevation: Some("theta".into()), ..none };
    assert_eq!(peak(&converted(half, &elevation).unwrap()), (90.0, 90.0));
    let problem = converted(&beam("phi,theta,gain", level), &zenith).unwrap_err();
    assert!(problem.contains("an angle of -90 from the zenith"), "{problem}");
}

#[test]
fn angles_that_cannot_be_degrees_are_asked_for() {
    let radians =
        |azimuth: i32, elevation: i32| (f64::from(azimuth).to_radians(), f64::from(90 - elevation).to_radians());
    let none = SourceNames::default();
    let of = |unit| SourceNames { angles: Some(unit), ..SourceNames::default() };
    let around = |azimuth: i32, elevation: i32| (f64::from(azimuth + 180).to_radians(), f64::from(elevation));
    for (text, name) in [
        (beam("phi,theta,gain", radians), "phi"),
        (beam("azimuth,elevation,gain", around), "azimuth"),
        (
            beam("azimuth,theta,gain", |azimuth, elevation| {
                (f64::from(azimuth), f64::from(90 - elevation).to_radians())
            }),
            "theta",
        ),
        (
            beam("azimuth,elevation,gain", |azimuth, elevation| {
                (f64::from(azimuth), f64::from(elevation).to_radians())
            }),
            "elevation",
        ),
        // The name says degrees, but they go once around.
        (beam("phi_deg,el,gain", around), "phi_deg"),
        ("phi,gain\n0,1\n1.5708,2\n3.1416,3\n4.7124,2\n".to_owned(), "phi"),
    ] {
        let problem = converted(&text, &none).unwrap_err();
        assert!(problem.contains(&format!("the unit of the angles `{name}` is not known: found")), "{problem}");
        assert!(problem.contains("as angles in radians are; allowed: a given unit, radians or degrees"), "{problem}");
    }
    let given = converted(&beam("phi,theta,gain", radians), &of(AngleUnit::Radians)).unwrap();
    assert_eq!(peak(&given), (90.0, 0.0));
    let named = converted(&beam("Phi[rad],theta (rad.),gain", radians), &none).unwrap();
    assert_eq!(given, named);
    // Few degrees are possible, if the user says so, or all are whole.
    let narrow = "azimuth,gain\n-1.5,1\n0,2\n1.5,1\n";
    assert!(converted(narrow, &none).is_err());
    assert!(converted(narrow, &of(AngleUnit::Degrees)).unwrap().contains("0,-1.5,0,1\n"));
    assert!(converted("azimuth,gain\n-1,1\n0,2\n1,1\n", &none).is_ok());
    assert!(converted("azimuth_deg,gain\n-1.5,1\n0,2\n1.5,1\n", &none).is_ok());
    let problem = converted("phi_deg,gain\n0,1\n90,2\n", &of(AngleUnit::Radians)).unwrap_err();
    assert!(
        problem.contains("the angles `phi_deg` are in degrees by their name, but radians are given"),
        "{problem}"
    );
}

#[test]
fn the_unit_of_gains_follows_from_their_name_or_is_asked_for() {
    let unit_of = |name: &str| {
        let text = format!("azimuth,{name}\n0,1\n90,2\n180,-3\n");
        table(&text, &SourceNames::default(), None).map(|book| book.unit).map_err(|error| error.to_string())
    };
    for (name, unit) in [
        ("gain_dbi", GainUnit::Dbi),
        ("Abs(Realized Gain)[dBi  ]", GainUnit::Dbi),
        ("dB(GainTotal) []", GainUnit::Dbi),
        ("gain [dB]", GainUnit::Relative),
        ("snr", GainUnit::Relative),
    ] {
        assert_eq!(unit_of(name), Ok(unit), "{name}");
    }
    for name in ["gain", "power", "Directivity(Total)"] {
        let problem = unit_of(name).unwrap_err();
        assert!(
            problem.contains(&format!("the unit of the gains `{name}` is not known: found values from -3 to 2"))
                && problem.contains("allowed: a given unit, `linear`, `db` or `dbi`"),
            "{problem}"
        );
    }
    let problem = table("azimuth,s1,s2\n0,1,2\n90,2,3\n", &SourceNames::default(), None).unwrap_err().to_string();
    assert!(problem.contains("`s1` to `s2`"), "{problem}");
    let several = "azimuth,sector,snr,rssi\n0,1,2,3\n";
    let problem = table(several, &SourceNames::default(), None).unwrap_err().to_string();
    assert!(problem.contains("several columns may be the gains: `snr`, `rssi`"), "{problem}");
    let volts = "phi,Abs(E)[V/m]\n0,1\n90,2\n";
    let names = SourceNames { gain: Some("Abs(E)[V/m]".into()), ..SourceNames::default() };
    let problem = table(volts, &names, None).unwrap_err().to_string();
    assert!(problem.contains("column `Abs(E)[V/m]`: the unit `vm`; allowed: gains in dBi or dB"), "{problem}");
}

#[test]
fn patterns_of_antenna_programs_are_read_as_they_write_them() {
    // CST: names with blanks, a line that is drawn, and columns of components.
    let cst = "Theta [deg.]  Phi   [deg.]  Abs(Realized Gain)[dBi   ]   Abs(Theta)[dBi   ]  Phase(Theta)[deg.]\n\
               ------------------------------------------------------------\n";
    let rows = [(0, 0, -5.0), (90, 0, 7.5), (180, 0, -9.0), (0, 180, -5.0), (90, 180, 1.0), (180, 180, -9.0)];
    let cst = rows.iter().fold(cst.to_owned(), |text, (theta, phi, gain)| {
        text + &format!("  {theta}.000   {phi}.000   {gain:.3e}   -1.0e+01  3.0\n")
    });
    // HFSS: CSV with quotes, and what else varies in the name.
    let hfss = rows.iter().fold(
        "\"Freq [GHz]\",\"Phi [deg]\",\"Theta [deg]\",\"dB(RealizedGainTotal) [] - Freq='2.4GHz'\"\n".to_owned(),
        |text, (theta, phi, gain)| text + &format!("2.4,{phi},{theta},{gain}\n"),
    );
    // FEKO: the names are in the last comment.
    let feko = rows.iter().fold(
        "##File Type: Far field\n#No. of Theta Samples: 3\n#   \"Theta\"  \"Phi\"  \"Re(Etheta)\"  \"Gain(Total)\"\n"
            .to_owned(),
        |text, (theta, phi, gain)| text + &format!("   {theta}.0E+00 {phi}.0E+00 1.0E-02 {gain}\n"),
    );
    let none = SourceNames::default();
    let [cst, hfss, feko] = [(cst, None), (hfss, None), (feko, Some(GainUnit::Dbi))].map(|(text, unit)| {
        let book = table(&text, &none, unit).unwrap();
        assert_eq!((book.sectors, book.directions, book.unit), (1, 6, GainUnit::Dbi), "{text}");
        assert!(
            book.notes.iter().any(|note| note.contains("the table is one pattern, that of sector 0")),
            "{:?}",
            book.notes
        );
        book.text
    });
    assert_eq!((&cst, &cst), (&hfss, &feko));
    assert_eq!(peak(&cst), (0.0, 0.0));
    assert!(cst.contains("0,-180,0,1\n") && cst.contains("0,0,90,-5\n"), "{cst}");
}

#[test]
fn files_that_are_no_tables_of_gains_are_named() {
    let folder = std::env::temp_dir().join(format!("sextant-convert-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, octets, expected) in [
        ("a.out", &b"   - - - RADIATION PATTERNS - - -\n  THETA PHI VERT. HOR. TOTAL\n"[..], "an output of NEC"),
        ("a.ffs", b"// CST Farfield Source File \n\n// Version:\n3.0\n", "a far field of CST (.ffs)"),
        ("a.ffd", b"0 180 19\n-180 180 37\nFrequencies 1\nFrequency 2.4e9\n", "a far field of HFSS (.ffd)"),
        ("a.xlsx", b"PK\x03\x04\x14\0[Content_Types].xml xl/workbook.xml", "a table of a spreadsheet program"),
        ("a.gz", b"\x1f\x8b\x08\0", "compressed with gzip"),
        ("a.bin", b"\x00\x01\x02\x03", "binary data that begin with the octets 00 01 02 03"),
        ("a.csv", b"", "empty"),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, octets).unwrap();
        let problem = convert(&path, &SourceNames::default(), None).unwrap_err().to_string();
        assert!(problem.contains("nor a table in text, but") && problem.contains(expected), "{problem}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn an_array_in_a_structure_of_a_matlab_file_is_read() {
    // Its angles called theta go from 0 to 10: that may be either.
    let refused = convert(&fixture("array.mat"), &SourceNames::default(), None).unwrap_err();
    assert!(matches!(refused, ConvertError::UnknownOrigin { .. }), "{refused}");
    let names = SourceNames { elevation: Some("book.theta".into()), ..SourceNames::default() };
    let book = convert(&fixture("array.mat"), &names, None).unwrap();
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
    let unit = Some(GainUnit::Relative);
    let [long, wide] =
        [(long, None), (wide, unit)].map(|(text, unit)| table(&text, &SourceNames::default(), unit).unwrap());
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
    let unknown = table(text, &SourceNames { quasi_omni: Some(5), ..names }, None).unwrap_err().to_string();
    assert_eq!(unknown, "the listening pattern: sector 5, which has no gains; allowed: a sector of the file: 0, 7");
}

#[test]
fn flaws_say_what_was_found_and_what_is_allowed() {
    let wide: String = (0..40).map(|i| format!("{},{}\n", 9 * i, if i == 0 { 30.0 } else { 0.1 })).collect();
    for (text, unit, words) in [
        (
            "sector,elevation,gain_db\n1,2,3\n",
            None,
            "no column of azimuths: found the columns `sector`, `elevation`, `gain_db`",
        ),
        ("azimuth,count of\n1,2\n", None, "no column of gains, and no column for each sector"),
        ("sector,azimuth,gain\n64,2,3\n", None, "line 2: sector 64; allowed: whole numbers from 0 to 63"),
        ("sector,azimuth,gain\n1,2,loud\n", None, "line 2, column `gain`: `loud`"),
        ("sector,azimuth,elevation,gain_db\n1,2,120,3\n", None, "elevation 120"),
        ("sector,azimuth,gain\n1,2,-3\n", Some(GainUnit::Linear), "a factor of -3"),
        (&format!("azimuth,sector_3\n{wide}"), None, "the unit of the gains `sector_3` is not known"),
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
