//! Code books of the module for IEEE 802.11ad of ns-3 in numbers (Assasa and Widmer 2016; `CodebookNumerical`): one number a
//! line.
//!
//! The number of radio-frequency chains, which older files lack; that of antennas; for each antenna its identity, its
//! chain (unless the file lacks chains), its orientation in azimuth in degrees, the 361 gains with which it listens, and
//! its number of sectors; for each sector its identity, its type, its usage and its 361 gains. The gains are those at 0 to
//! 360 degrees of azimuth. The module takes the logarithm of them, so that they are factors there; but files with decibels
//! are about, and nothing in a file says so.

use super::book::{Owner, Rows, TableRow};
use super::{ConvertError, Source};

/// Gains of a pattern: one a degree from 0 to 360.
const GAINS: usize = 361;

/// What the numbers of a file say, if they are such a code book.
struct Layout {
    has_chains: bool,
}

/// The numbers of a file with one a line; `None` if it is another file.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.map(|line| line.parse().ok()).collect()
}

/// Whether a text is such a code book.
pub(super) fn is_book(text: &str) -> bool {
    numbers(text).is_some_and(|numbers| layout(&numbers).is_some())
}

/// The layout whose counts give the length of the file.
fn layout(numbers: &[f64]) -> Option<Layout> {
    let fits = |has_chains: bool| {
        let mut left = numbers.iter().copied();
        if has_chains {
            left.next()?;
        }
        let antennas = count(left.next()?)?;
        for _ in 0..antennas {
            let skipped = 2 + usize::from(has_chains) + GAINS;
            let sectors = count(left.nth(skipped)?)?;
            for _ in 0..sectors {
                left.nth(3 + GAINS - 1)?;
            }
        }
        left.next().is_none().then_some(antennas > 0)
    };
    [true, false]
        .into_iter()
        .find(|&has_chains| fits(has_chains) == Some(true))
        .map(|has_chains| Layout { has_chains })
}

fn count(number: f64) -> Option<usize> {
    let is_count = number.fract().abs() <= 0.0 && (0.0..=255.0).contains(&number);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number up to 255")]
    is_count.then_some(number as usize)
}

/// The gains of the only antenna of a code book.
///
/// # Errors
/// If there are several antennas, or a sector has an identity beyond 63.
pub(super) fn rows(text: &str) -> Result<Source, ConvertError> {
    let invalid = |place: &str, found: String, allowed: &str| ConvertError::Invalid {
        place: place.to_owned(),
        found,
        allowed: allowed.to_owned(),
    };
    let known = numbers(text).and_then(|numbers| layout(&numbers).zip(Some(numbers)));
    let Some((Layout { has_chains }, numbers)) = known else {
        return Err(invalid("the file", "numbers that are no code book".to_owned(), "a code book of ns-3"));
    };
    let mut left = numbers.into_iter().skip(usize::from(has_chains));
    let mut next = || left.next().expect("the layout has been checked");
    let antennas = next();
    if antennas > 1.0 {
        let found = format!("{antennas} antennas");
        return Err(invalid("the number of antennas", found, "1: write the antennas into files of their own"));
    }
    let _identity = next();
    if has_chains {
        let _chain = next();
    }
    let orientation_deg = next();
    let mut rows = Vec::new();
    let mut pattern = |owner: Owner, next: &mut dyn FnMut() -> f64| {
        for degree in 0_u16..=360 {
            let gain = next();
            // 360 degrees are 0 degrees again.
            if degree < 360 {
                // The module shifts its tables to lower angles.
                let azimuth_deg = f64::from(degree) - orientation_deg.floor();
                rows.push(TableRow { owner, azimuth_deg, elevation_deg: 0.0, gain });
            }
        }
    };
    pattern(Owner::QuasiOmni, &mut next);
    let sectors = count(next()).expect("the layout has been checked");
    for i in 0..sectors {
        let owner = Owner::of(next(), || format!("sector {} of the file", i + 1))?;
        let (_type, _usage) = (next(), next());
        pattern(owner, &mut next);
    }
    let mut notes = vec![
        "a code book of ns-3: gains at 0 to 359 degrees of azimuth, counterclockwise; a planar cut at elevation 0"
            .to_owned(),
        "types and usages of sectors are not used: each sector is swept".to_owned(),
    ];
    let turned_deg = orientation_deg.floor();
    if turned_deg.abs() > 0.0 {
        notes.push(format!("the antenna is turned by {turned_deg} degrees to lower azimuths, as ns-3 does"));
    }
    Ok(Source { rows: Rows(rows), named_unit: None, gains: "directivity".to_owned(), notes })
}
