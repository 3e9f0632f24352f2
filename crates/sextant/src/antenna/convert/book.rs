//! The rows of a measurement, and the code book that they make.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use sextant_channel::look_like_factors;

use super::gain_unit::GainUnit;
use super::{ConvertError, SourceNames};

/// Which pattern a gain belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owner {
    Sector(u8),
    QuasiOmni,
}

/// Most sectors of a code book.
const SECTORS: f64 = 64.0;

impl Owner {
    /// The sector with this number.
    pub(super) fn of(number: f64, place: impl Fn() -> String) -> Result<Self, ConvertError> {
        if number.fract().abs() > 0.0 || !(0.0..SECTORS).contains(&number) {
            let (found, allowed) = (format!("sector {number}"), "whole numbers from 0 to 63".to_owned());
            return Err(ConvertError::Identity { place: place(), found, allowed });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number below 64")]
        let sector = number as u8;
        Ok(Self::Sector(sector))
    }
}

/// One gain of a measurement. Its angles are as written until [`settle`](super::angles::settle) makes degrees and elevations of
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableRow {
    pub(super) owner: Owner,
    pub(super) azimuth_deg: f64,
    pub(super) elevation_deg: f64,
    /// Not a number for a gap.
    pub(super) gain: f64,
}

/// The gains of a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Rows(pub(super) Vec<TableRow>);

/// A measurement as a code book.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedBook {
    /// The code book: the text of a CSV file.
    pub text: String,
    /// Number of sectors.
    pub sectors: usize,
    /// Number of directions with a gain of any sector.
    pub directions: usize,
    /// Directions without a gain, over all sectors and the quasi-omnidirectional pattern.
    pub gaps: usize,
    /// The unit of the gains.
    pub unit: GainUnit,
    /// What was changed or left out, in sentences.
    pub notes: Vec<String>,
}

/// An angle in thousandths of a degree.
type Angle = i64;

#[expect(clippy::cast_possible_truncation, reason = "angles are at most 360 degrees")]
fn angle(deg: f64) -> Angle {
    (deg * 1e3).round() as Angle
}

fn degrees(angle: Angle) -> f64 {
    angle as f64 / 1e3
}

impl Rows {
    /// The error that nothing says the unit of these gains, which are called `name`.
    pub(super) fn without_unit(&self, name: &str) -> ConvertError {
        let gains = || self.0.iter().map(|row| row.gain).filter(|gain| !gain.is_nan());
        let (least, greatest) = (gains().fold(f64::INFINITY, f64::min), gains().fold(f64::NEG_INFINITY, f64::max));
        let as_what = if look_like_factors(gains()) {
            ", most far below the greatest, as factors are"
        } else if least < 0.0 {
            ", as decibels are, over an isotropic antenna (`dbi`) or over something else (`db`)"
        } else {
            ""
        };
        ConvertError::UnknownUnit {
            name: name.to_owned(),
            found: format!("values from {least} to {greatest}{as_what}"),
        }
    }

    /// The code book of these gains, in this unit.
    pub(super) fn book(
        self,
        names: &SourceNames,
        unit: GainUnit,
        mut notes: Vec<String>,
    ) -> Result<ConvertedBook, ConvertError> {
        if let Some(sector) = names.quasi_omni
            && !self.0.iter().any(|row| row.owner == Owner::Sector(sector))
        {
            let known: BTreeSet<&Owner> = self.0.iter().map(|row| &row.owner).collect();
            let known = known.iter().filter_map(|owner| match owner {
                Owner::Sector(sector) => Some(sector.to_string()),
                Owner::QuasiOmni => None,
            });
            return Err(ConvertError::Invalid {
                place: "the listening pattern".to_owned(),
                found: format!("sector {sector}, which has no gains"),
                allowed: format!("a sector of the file: {}", known.collect::<Vec<_>>().join(", ")),
            });
        }
        let mut cells: BTreeMap<(Owner, Angle, Angle), (f64, u32)> = BTreeMap::new();
        let mut several = 0_u32;
        for (i, row) in self.0.iter().enumerate() {
            let place = || format!("value {}", i + 1);
            let owner = match row.owner {
                Owner::Sector(sector) if names.quasi_omni == Some(sector) => Owner::QuasiOmni,
                owner => owner,
            };
            let (azimuth, elevation) = directed(row, place)?;
            if row.gain.is_nan() {
                continue;
            }
            if !unit.has(row.gain) {
                let what = if unit == GainUnit::Linear { "factor" } else { "gain" };
                let (found, allowed) = (format!("a {what} of {}", row.gain), unit.allowed().to_owned());
                return Err(ConvertError::Invalid { place: place(), found, allowed });
            }
            let value = if unit == GainUnit::Linear { 10.0 * libm::log10(row.gain.max(1e-20)) } else { row.gain };
            let (sum, count) = cells.entry((owner, azimuth, elevation)).or_default();
            *sum += value;
            *count += 1;
            several += u32::from(*count == 2);
        }
        if several > 0 {
            notes.push(format!("{several} directions had several gains: their means in decibels are used"));
        }
        let mut owners: Vec<Owner> = cells.keys().map(|&(owner, ..)| owner).collect();
        owners.dedup();
        let sectors = owners.iter().filter(|owner| matches!(owner, Owner::Sector(_))).count();
        if sectors == 0 {
            let allowed = "a gain of at least one sector, besides the listening pattern".to_owned();
            return Err(ConvertError::Invalid {
                place: "the gains".to_owned(),
                found: "no sector".to_owned(),
                allowed,
            });
        }
        let mut places: Vec<(Angle, Angle)> =
            cells.keys().map(|&(_, azimuth, elevation)| (azimuth, elevation)).collect();
        places.sort_unstable();
        places.dedup();
        let gaps = owners.len() * places.len() - cells.len();
        let mut text = format!("sector,azimuth_deg,elevation_deg,{}\n", unit.column());
        for ((owner, azimuth, elevation), (sum, count)) in cells {
            let mean = sum / f64::from(count);
            let mean = if unit == GainUnit::Linear { libm::pow(10.0, mean / 10.0) } else { mean };
            let name = match owner {
                Owner::Sector(sector) => sector.to_string(),
                Owner::QuasiOmni => "quasi_omni".to_owned(),
            };
            writeln!(text, "{name},{},{},{}", degrees(azimuth), degrees(elevation), rounded(mean))
                .expect("a string grows");
        }
        Ok(ConvertedBook { text, sectors, directions: places.len(), gaps, unit, notes })
    }
}

/// Azimuth from −180 to below 180 degrees, and elevation from the horizontal plane.
fn directed(row: &TableRow, place: impl Fn() -> String) -> Result<(Angle, Angle), ConvertError> {
    if !(-90.0..=90.0).contains(&row.elevation_deg) {
        let allowed = "-90 to 90 degrees from the horizontal plane; angles from the zenith need a word".to_owned();
        return Err(ConvertError::Elevation {
            place: place(),
            found: format!("elevation {}", row.elevation_deg),
            allowed,
        });
    }
    if !(-720.0..=720.0).contains(&row.azimuth_deg) {
        let allowed = "degrees, -720 to 720".to_owned();
        return Err(ConvertError::Invalid { place: place(), found: format!("azimuth {}", row.azimuth_deg), allowed });
    }
    let turned = angle(row.azimuth_deg).rem_euclid(360_000);
    Ok((if turned >= 180_000 { turned - 360_000 } else { turned }, angle(row.elevation_deg)))
}

/// Six significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
