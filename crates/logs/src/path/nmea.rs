//! Paths in NMEA 0183: the sentences of a satellite receiver.
//!
//! GGA and GNS have the place with its height and the time of the day, RMC the place and the date, GLL the place and the time of
//! the day, ZDA the date. So the places are those of GGA, if the file has any, else of GNS, RMC or GLL, and the day is that of
//! the nearest RMC or ZDA before.

use std::path::Path as FilePath;

use sextant_kernel::SimTime;

use super::fix::{Fix, FixTrack};
use super::paths::Paths;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;

const SECOND_NS: i64 = 1_000_000_000;
const DAY_NS: i64 = 86_400 * SECOND_NS;

/// Where the receiver was at a time of the day.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    lat_deg: f64,
    lon_deg: f64,
    height_m: Option<f64>,
}

/// A sentence that is of use.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sentence {
    line: usize,
    kind: SentenceKind,
    /// Time of the day (ns).
    of_day_ns: i64,
    /// Days since 1970, if it has the date.
    day: Option<i64>,
    /// `None` if there is no fix.
    place: Option<Place>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SentenceKind {
    Gga,
    /// Of several systems of satellites together.
    Gns,
    Rmc,
    Gll,
    Zda,
}

/// What gives places, the best first.
const PLACES: [SentenceKind; 4] = [SentenceKind::Gga, SentenceKind::Gns, SentenceKind::Rmc, SentenceKind::Gll];

/// Reads the path in the file `path`. Sentences with a wrong checksum, and those without a fix, are skipped; those at
/// 0, 0 only if `skips_no_fix`, because their receiver says that it has one.
pub(crate) fn read(path: &FilePath, skips_no_fix: bool, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let octets = sextant_kernel::read_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| RobotLogError::read(path, why))?;
    let wrong = |line: usize, problem: String| RobotLogError::line(path, line, problem);
    let mut sentences = Vec::new();
    let mut damaged = 0_u64;
    for (line, text) in (1..).zip(octets.split(|&octet| octet == b'\n')) {
        match sentence(line, &String::from_utf8_lossy(text)) {
            Ok(found) => sentences.extend(found),
            Err(Damaged) => damaged += 1,
        }
    }
    let has = |kind: &SentenceKind| sentences.iter().any(|at| at.kind == *kind);
    let kind = PLACES.into_iter().find(|kind| has(kind)).unwrap_or(SentenceKind::Rmc);
    let (mut track, mut lost) = (FixTrack::new(skips_no_fix), 0_u64);
    let first = sentences.iter().find_map(Sentence::date);
    if !PLACES.iter().any(has) {
        let problem =
            format!("no sentence has a place (GGA, GNS, RMC or GLL); {damaged} sentences have a wrong checksum");
        return Err(wrong(1, problem));
    }
    let Some(mut date_ns) = first else {
        let problem = format!(
            "no sentence has a date (RMC or ZDA), so the times of the packets cannot be told; {damaged} sentences have a wrong \
             checksum"
        );
        return Err(wrong(1, problem));
    };
    for at in &sentences {
        date_ns = at.date().unwrap_or(date_ns);
        if at.kind != kind {
            continue;
        }
        let Some(Place { lat_deg, lon_deg, height_m }) = at.place else {
            lost += 1;
            continue;
        };
        // The day that is nearest to the last date: midnight may be between them.
        let days = (date_ns - at.of_day_ns + DAY_NS / 2).div_euclid(DAY_NS);
        let Ok(time_ns) = u64::try_from(days * DAY_NS + at.of_day_ns) else {
            track.refuse(at.line, "its date is before 1970".to_owned());
            continue;
        };
        track.add(Fix { time: SimTime::from_nanos(time_ns), lat_deg, lon_deg, height_m }, at.line);
    }
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if damaged > 0 {
        notes.push(format!("{file}: {damaged} sentences with a wrong checksum are skipped"));
    }
    if lost > 0 {
        notes.push(format!("{file}: {lost} sentences without a fix are skipped"));
    }
    track.finish(path, notes)
}

impl Sentence {
    /// Its date and time of the day (ns since 1970).
    fn date(&self) -> Option<i64> {
        Some(self.day? * DAY_NS + self.of_day_ns)
    }
}

/// The sentence is not as it was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Damaged;

/// Whether `line` holds a sentence, whatever it gives: two letters of the talker, three of its kind, and fields.
pub(crate) fn is_sentence(line: &str) -> bool {
    let is_name = |name: &str| {
        name.len() == 5
            && name.starts_with(['G', 'B', 'Q', 'N'])
            && name.bytes().all(|octet| octet.is_ascii_uppercase())
    };
    let has_name = |body: &str| body.split_once(',').is_some_and(|(name, _)| is_name(name));
    body(line).is_ok_and(|body| body.is_some_and(has_name))
}

/// What stands between `$` and the checksum; `None` if there is no sentence in the line.
fn body(line: &str) -> Result<Option<&str>, Damaged> {
    // Some loggers write the time of the computer before each sentence.
    let Some(at) = line.find('$') else { return Ok(None) };
    let text = line[at + 1..].trim_end();
    let Some((body, checksum)) = text.rsplit_once('*') else { return Ok(Some(text)) };
    let stated = u8::from_str_radix(checksum.get(..2).unwrap_or(checksum), 16).map_err(|_| Damaged)?;
    let found = body.bytes().fold(0, |sum, octet| sum ^ octet);
    if found == stated { Ok(Some(body)) } else { Err(Damaged) }
}

/// The kind of a sentence, whatever system of satellites it is from: `GPGGA`, `GNGGA`.
fn kind(body: &str) -> Option<SentenceKind> {
    match body.split(',').next()?.get(2..)? {
        "GGA" => Some(SentenceKind::Gga),
        "GNS" => Some(SentenceKind::Gns),
        "GLL" => Some(SentenceKind::Gll),
        "RMC" => Some(SentenceKind::Rmc),
        "ZDA" => Some(SentenceKind::Zda),
        _ => None,
    }
}

/// The sentence in a line, if it is one of use.
fn sentence(line: usize, text: &str) -> Result<Option<Sentence>, Damaged> {
    let Some(body) = body(text)? else { return Ok(None) };
    let Some(kind) = kind(body) else { return Ok(None) };
    let fields: Vec<&str> = body.split(',').collect();
    let field = |at: usize| fields.get(at).copied().unwrap_or("");
    // A receiver that has no time yet leaves it out.
    let time = if kind == SentenceKind::Gll { 5 } else { 1 };
    let Some(of_day_ns) = time_of_day(field(time)) else { return Ok(None) };
    let place = |at: usize, height_m: Option<f64>| {
        let lat_deg = angle(field(at), field(at + 1), ["N", "S"])?;
        let lon_deg = angle(field(at + 2), field(at + 3), ["E", "W"])?;
        Some(Place { lat_deg, lon_deg, height_m })
    };
    let (day, place) = match kind {
        SentenceKind::Gga => (None, place(2, field(9).parse().ok()).filter(|_| !["", "0"].contains(&field(6)))),
        // A letter for each system of satellites: N if it gives no fix.
        SentenceKind::Gns => {
            (None, place(2, field(9).parse().ok()).filter(|_| field(6).contains(|mode| mode != 'N')))
        }
        SentenceKind::Gll => (None, place(1, None).filter(|_| field(6) == "A")),
        SentenceKind::Rmc => (date(field(9)), place(3, None).filter(|_| field(2) == "A")),
        SentenceKind::Zda => (date_of(field(2), field(3), field(4).parse().ok()), None),
    };
    Ok(Some(Sentence { line, kind, of_day_ns, day, place }))
}

/// `hhmmss.sss` in nanoseconds.
fn time_of_day(text: &str) -> Option<i64> {
    let [hours, minutes] = [text.get(..2)?, text.get(2..4)?];
    let seconds = i64::try_from(instant::parse(text.get(4..)?)?.as_nanos()).ok().filter(|&ns| ns < 61 * SECOND_NS)?;
    Some((3600 * instant::two_digits(hours, 23)? + 60 * instant::two_digits(minutes, 59)?) * SECOND_NS + seconds)
}

/// `ddmmyy` in days since 1970. Years are from 1980 to 2079.
fn date(text: &str) -> Option<i64> {
    let year = instant::two_digits(text.get(4..)?, 99)?;
    date_of(text.get(..2)?, text.get(2..4)?, Some(if year < 80 { 2000 + year } else { 1900 + year }))
}

fn date_of(day: &str, month: &str, year: Option<i64>) -> Option<i64> {
    let (day, month) = (instant::two_digits(day, 31)?, instant::two_digits(month, 12)?);
    let year = year.filter(|year| (1970..=2200).contains(year))?;
    (day > 0 && month > 0).then(|| instant::days_since_1970(year, month, day))
}

/// `ddmm.mmm` or `dddmm.mmm` in degrees, negative on the second of the two sides.
fn angle(text: &str, side: &str, sides: [&str; 2]) -> Option<f64> {
    let whole = text.find('.').unwrap_or(text.len());
    let (degrees, minutes) = text.split_at_checked(whole.checked_sub(2)?)?;
    let degrees: f64 = degrees.parse::<u32>().ok()?.into();
    let minutes: f64 = minutes.parse().ok().filter(|minutes| (0.0..60.0).contains(minutes))?;
    let angle_deg = degrees + minutes / 60.0;
    match side {
        _ if side == sides[0] => Some(angle_deg),
        _ if side == sides[1] => Some(-angle_deg),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GGA: &str = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47";

    #[test]
    fn the_example_of_the_standard_is_read() {
        let found = sentence(1, GGA).unwrap().unwrap();
        assert_eq!((found.of_day_ns, found.day), (((12 * 60 + 35) * 60 + 19) * SECOND_NS, None));
        let place = found.place.unwrap();
        assert!((place.lat_deg - 48.1173).abs() < 1e-9 && (place.lon_deg - (11.0 + 31.0 / 60.0)).abs() < 1e-9);
        assert_eq!(place.height_m, Some(545.4));
        let rmc = "$GPRMC,123519,A,4807.038,N,01131.000,W,022.4,084.4,230394,003.1,W*78";
        let found = sentence(1, rmc).unwrap().unwrap();
        assert_eq!(found.day, Some(instant::days_since_1970(1994, 3, 23)));
        assert!((found.place.unwrap().lon_deg + 11.516_666).abs() < 1e-5);
    }

    #[test]
    fn a_wrong_checksum_is_noticed() {
        assert_eq!(sentence(1, &GGA.replace("545", "546")), Err(Damaged));
        assert_eq!(sentence(1, &GGA.replace("*47", "*zz")), Err(Damaged));
        assert!(sentence(1, GGA.trim_end_matches("*47")).unwrap().is_some());
        assert_eq!(sentence(1, "hello"), Ok(None));
        // The example of a receiver of two systems, and one of them without a fix.
        let gns = "$GNGNS,014035.00,4332.69262,S,17235.48549,E,RR,13,0.9,25.63,11.24,,*70";
        let found = sentence(1, gns).unwrap().unwrap();
        let place = found.place.unwrap();
        assert!((place.lat_deg + 43.544_877).abs() < 1e-6 && (place.lon_deg - 172.591_424_8).abs() < 1e-6);
        assert_eq!((place.height_m, found.of_day_ns), (Some(25.63), ((60 + 40) * 60 + 35) * SECOND_NS));
        for (mode, has_place) in [("AN", true), ("NN", false), ("", false)] {
            let text = gns.split('*').next().unwrap().replace("RR", mode);
            assert_eq!(sentence(1, &text).unwrap().unwrap().place.is_some(), has_place, "{mode}");
        }
        let gll = sentence(1, "$GNGLL,4807.038,N,01131.000,E,123519,A,A").unwrap().unwrap();
        assert_eq!(gll.of_day_ns, ((12 * 60 + 35) * 60 + 19) * SECOND_NS);
        assert!((gll.place.unwrap().lat_deg - 48.1173).abs() < 1e-9);
        // Without a fix there is no place.
        let lost = "$GPGGA,123519,,,,,0,00,,,M,,M,,";
        assert_eq!(sentence(1, lost).unwrap().unwrap().place, None);
    }
}
