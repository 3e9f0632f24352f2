//! Files of other simulators and planning programs, written by hand in their documented formats.

use super::*;

/// An antenna of a code book of ns-3 from its orientation on: listening at 1, and two sectors with a beam of 10 degrees at 40
/// and at 350 degrees.
fn antenna(orientation: i32, scale: fn(f64) -> f64) -> String {
    let mut lines = vec![orientation.to_string()];
    lines.extend((0..=360).map(|_| scale(1.0).to_string()));
    lines.push("2".to_owned());
    for (sector, peak) in [(3, 40_i32), (17, 350)] {
        lines.extend([sector.to_string(), "2".to_owned(), "2".to_owned()]);
        lines.extend((0..=360).map(|degree: i32| {
            let apart = (degree - peak).rem_euclid(360).min((peak - degree).rem_euclid(360));
            let gain = match apart {
                0 => 200.0,
                1..=5 => 100.0,
                _ => 0.1,
            };
            scale(gain).to_string()
        }));
    }
    lines.join("\n") + "\n"
}

/// A code book of ns-3 with one antenna, behind these lines.
fn ns3(header: &str, orientation: i32, scale: fn(f64) -> f64) -> String {
    format!("{header}\n{}", antenna(orientation, scale))
}

fn is_near(found: (f64, f64), expected: (f64, f64)) -> bool {
    (found.0 - expected.0).abs() < 1e-9 && (found.1 - expected.1).abs() < 1e-3
}

/// The azimuth of the greatest gain of a pattern, and that gain.
fn peak_of(book: &ConvertedBook, name: &str) -> (f64, f64) {
    let rows = book.text.lines().skip(1).filter(|line| line.split(',').next() == Some(name));
    let row = |line: &str| {
        let fields: Vec<f64> = line.split(',').skip(1).map(|field| field.parse().expect("a number")).collect();
        (fields[0], fields[2])
    };
    rows.map(row).max_by(|a, b| a.1.total_cmp(&b.1)).expect("rows of the pattern")
}

fn read(name: &str, text: &str, names: &SourceNames, unit: Option<GainUnit>) -> Result<ConvertedBook, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("a file");
    convert(&path, names, unit).map_err(|error| error.to_string())
}

#[test]
fn code_books_of_ns3_have_their_sectors_at_their_azimuths_in_the_unit_that_is_given() {
    let none = SourceNames::default();
    // With and without a line for the radio-frequency chains.
    for header in ["1\n1\n1\n1", "1\n1"] {
        let book = read("book.txt", &ns3(header, 0, |factor| factor), &none, Some(GainUnit::Linear)).unwrap();
        assert_eq!((book.sectors, book.directions, book.gaps), (2, 360, 0));
        assert!(is_near(peak_of(&book, "3"), (40.0, 200.0)) && is_near(peak_of(&book, "17"), (-10.0, 200.0)));
        assert!((peak_of(&book, "quasi_omni").1 - 1.0).abs() < 1e-9);
        let decibels = read("book.txt", &ns3(header, 0, |factor| 10.0 * factor.log10()), &none, Some(GainUnit::Dbi));
        assert!(is_near(peak_of(&decibels.unwrap(), "3"), (40.0, 23.0103)));
    }
    // An antenna that is turned.
    let turned = read("book.txt", &ns3("1\n1\n1\n1", 30, |factor| factor), &none, Some(GainUnit::Linear)).unwrap();
    assert!(is_near(peak_of(&turned, "3"), (10.0, 200.0)));
    assert!(turned.notes.iter().any(|note| note.contains("30 degrees")), "{:?}", turned.notes);
    // ns-3 turns by whole degrees.
    for (from, to, words) in [("\n30\n", "\n30.5\n", Some("turned by 30 degrees")), ("\n0\n", "\n0.5\n", None)] {
        let orientation = if words.is_some() { 30 } else { 0 };
        let text = ns3("1\n1\n1\n1", orientation, |factor| factor).replacen(from, to, 1);
        let notes = read("book.txt", &text, &none, Some(GainUnit::Linear)).unwrap().notes.join("\n");
        assert_eq!(notes.contains("turned by"), words.is_some(), "{notes}");
        assert!(words.is_none_or(|words| notes.contains(words)), "{notes}");
    }
    // Nothing in the file says the unit, and a book has one antenna.
    let problem = read("book.txt", &ns3("1\n1\n1\n1", 0, |factor| factor), &none, None).unwrap_err();
    assert!(problem.contains("the unit of the gains `directivity` is not known"), "{problem}");
    let one = antenna(0, |factor| factor);
    let two = format!("2\n1\n{one}2\n{one}");
    let problem = read("book.txt", &two, &none, Some(GainUnit::Linear)).unwrap_err();
    assert!(problem.contains("2 antennas") && problem.contains("allowed: 1"), "{problem}");
    // One number fewer is no code book.
    let short = ns3("1\n1", 0, |factor| factor).trim_end().rsplit_once('\n').expect("lines").0.to_owned();
    assert!(read("book.txt", &short, &none, Some(GainUnit::Linear)).is_err());
}

/// A pattern of Planet whose horizontal cut has its loss from `loss` of the angle.
fn planet(gain: &str, loss: impl Fn(i32) -> f64) -> String {
    let mut text = format!("NAME a panel\nMAKE us\nFREQUENCY 60000\n{gain}\nTILT ELECTRICAL\nHORIZONTAL 360\n");
    (0..360).for_each(|angle| text += &format!("{angle} {:.2}\n", loss(angle)));
    text += "VERTICAL 360\n";
    (0..360).for_each(|angle: i32| {
        text += &format!("{angle}\t{:.2}\n", if angle.min(360 - angle) <= 5 { 1.0 } else { 20.0 })
    });
    text
}

#[test]
fn patterns_of_planet_have_their_gain_less_the_loss_and_ask_which_way_azimuths_turn() {
    let none = SourceNames::default();
    let symmetric = |angle: i32| f64::from(angle.min(360 - angle)) / 10.0;
    for (gain, expected) in [("GAIN 12.0 dBi", 12.0), ("GAIN 12.0 dBd", 14.15), ("GAIN\t12.0", 14.15)] {
        let book = read("a.msi", &planet(gain, symmetric), &none, None).unwrap();
        assert_eq!((book.sectors, book.directions, book.unit), (1, 360, GainUnit::Dbi));
        let (azimuth, greatest) = peak_of(&book, "0");
        assert!(azimuth.abs() < 1e-9 && (greatest - expected).abs() < 1e-4, "{gain}: {azimuth} {greatest}");
        assert!(book.text.contains(&format!("0,90,0,{}\n", expected - 9.0)), "{gain}");
        // From 1 dB at 5 degrees to 20 dB at 6, 3 dB below the least loss are at 5.158.
        assert!(book.notes.iter().any(|note| note.contains("half-power width is 10.3 degrees")), "{:?}", book.notes);
    }
    // What the head says of widths and tilt is held against the cuts.
    let text = planet("GAIN 12.0 dBi\nH_WIDTH 60\nV_WIDTH 25", symmetric).replace("0\t1.00", "0\t1.50");
    let text = text.replace("\n4\t1.00", "\n4\t0.00").replace("TILT ELECTRICAL", "TILT ELECTRICAL 4");
    let notes = read("a.msi", &text, &none, None).unwrap().notes.join("\n");
    for words in ["`V_WIDTH` says 25: the cut counts", "strongest at 4 degrees (`TILT ELECTRICAL 4`)"] {
        assert!(notes.contains(words), "{notes}");
    }
    assert!(!notes.contains("H_WIDTH"), "{notes}");
    let problem = read("a.msi", &planet("GAIN 12.0 dBi\nH_WIDTH wide", symmetric), &none, None).unwrap_err();
    assert!(problem.contains("`H_WIDTH wide`") && problem.contains("above 0, at most 360"), "{problem}");
    // A beam at 40 degrees, to one side or to the other.
    let aside = |angle: i32| f64::from((angle - 40).rem_euclid(360).min((40 - angle).rem_euclid(360))) / 10.0;
    let text = planet("GAIN 12 dBi", aside);
    let problem = read("a.pln", &text, &none, None).unwrap_err();
    assert!(problem.contains("clockwise") && problem.contains("allowed"), "{problem}");
    for (turning, azimuth) in [(Turning::Clockwise, -40.0), (Turning::Counterclockwise, 40.0)] {
        let names = SourceNames { turning: Some(turning), ..SourceNames::default() };
        assert!(is_near(peak_of(&read("a.pln", &text, &names, None).unwrap(), "0"), (azimuth, 12.0)));
    }
}

#[test]
fn flaws_of_such_files_say_what_was_found_and_what_is_allowed() {
    let good = planet("GAIN 12 dBi", |angle| f64::from(angle.min(360 - angle)) / 10.0);
    for (text, words) in [
        (good.replace("GAIN 12 dBi\n", ""), "no gain: found no line `GAIN`"),
        (good.replace("GAIN 12 dBi", "GAIN much dBi"), "the line `GAIN`: `much dBi`; allowed: a number"),
        (good.replace("GAIN 12 dBi", "GAIN nan dBi"), "the line `GAIN`: `nan dBi`; allowed: a number"),
        (good.replace("GAIN 12 dBi", "GAIN inf"), "the line `GAIN`: `inf`; allowed: a number"),
        (good.replace("\n7 0.70\n", "\n7 inf\n"), "line 14: `7 inf`; allowed: an angle and a loss in dB"),
        (
            good.replace("HORIZONTAL 360", "HORIZONTAL 359"),
            "line 366: `359 0.10`, more angles than `HORIZONTAL 359` says; allowed: the number of angles",
        ),
        (
            good.replace("HORIZONTAL 360", "HORIZONTAL many"),
            "line 6: `HORIZONTAL many`; allowed: the number of its angles",
        ),
        (good.replace("\n7 0.70\n", "\n7\n"), "line 14: `7`; allowed: an angle and a loss in dB"),
    ] {
        let problem = read("a.msi", &text, &SourceNames::default(), None).unwrap_err();
        assert!(problem.contains(words), "{problem}");
    }
}

#[test]
fn a_pattern_with_its_vertical_cut_first_is_the_same() {
    let text = planet("GAIN 12 dBi", |angle| f64::from(angle.min(360 - angle)) / 10.0);
    let (head, cuts) = text.split_once("HORIZONTAL").expect("a horizontal cut");
    let (horizontal, vertical) = cuts.split_once("VERTICAL").expect("a vertical cut");
    let turned = format!("{head}VERTICAL{vertical}HORIZONTAL{horizontal}");
    let [text, turned] = [text, turned].map(|text| read("a.msi", &text, &SourceNames::default(), None).unwrap());
    assert_eq!(text, turned);
}

#[test]
fn what_its_reader_would_refuse_is_not_written() {
    let none = SourceNames::default();
    let linear = Some(GainUnit::Linear);
    let problem = read("book.txt", &ns3("1\n1", 0, |_| f64::INFINITY), &none, linear).unwrap_err();
    assert!(problem.contains("value 1: a factor of inf; allowed: factors from 0 to 1e10"), "{problem}");
    let problem = read("a.csv", "azimuth,gain_dbi\n0,1\n90,300\n", &none, None).unwrap_err();
    assert!(problem.contains("value 2: a gain of 300; allowed: -200 to 200 dB"), "{problem}");
    let omni = SourceNames { quasi_omni: Some(0), ..SourceNames::default() };
    let problem = read("a.csv", "azimuth,gain_dbi\n0,1\n90,3\n", &omni, None).unwrap_err();
    assert!(problem.contains("the gains: no sector; allowed: a gain of at least one sector"), "{problem}");
}

#[test]
fn options_that_have_no_effect_are_refused() {
    let pattern = planet("GAIN 12 dBi", |angle| f64::from(angle.min(360 - angle)) / 10.0);
    let book = ns3("1\n1", 0, |factor| factor);
    let table = "azimuth,gain_dbi\n0,1\n90,2\n".to_owned();
    let none = SourceNames::default;
    let turned = SourceNames { turning: Some(Turning::Clockwise), ..none() };
    let ordered = SourceNames { order: "sector,azimuth,elevation".parse().ok(), ..none() };
    let named = SourceNames { gain: Some("loss".to_owned()), ..none() };
    let in_radians = SourceNames { angles: Some(AngleUnit::Radians), ..none() };
    let (dbi, linear) = (Some(GainUnit::Dbi), Some(GainUnit::Linear));
    for (text, names, unit, words) in [
        (&table, &turned, None, "option `azimuths` is given; allowed: only with a pattern of MSI and Planet"),
        (&book, &turned, linear, "option `azimuths` is given"),
        (&table, &ordered, None, "option `order` is given; allowed: only with a MATLAB file"),
        (&pattern, &ordered, None, "option `order` is given"),
        (&pattern, &named, None, "option `gain` is given; allowed: only with a table or a MATLAB file"),
        (&book, &in_radians, linear, "option `radians` is given"),
        (&pattern, &none(), linear, "option `unit` is linear; allowed: `dbi`"),
    ] {
        let problem = read("a.txt", text, names, unit).unwrap_err();
        assert!(problem.contains(words), "{problem}");
    }
    assert!(read("a.txt", &pattern, &turned, dbi).is_ok());
}
