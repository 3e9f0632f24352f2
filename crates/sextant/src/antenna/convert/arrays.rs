//! Arrays of a MATLAB file as gains: vectors of equal length, or an array with an axis for each of sector, azimuth and
//! elevation.

use std::collections::BTreeMap;

use super::book::{Owner, Rows, TableRow};
use super::mat::Array;
use super::names::{AZIMUTH, ArrayOrder, Axis, ColumnName, ELEVATION, GAIN, SECTOR, find};
use super::{AngleNames, ConvertError, Source, SourceNames, angles};

/// The gains in these variables.
///
/// # Errors
/// If one is missing, or they do not fit together.
pub(super) fn rows(variables: &BTreeMap<String, Array>, names: &SourceNames) -> Result<Source, ConvertError> {
    let known: Vec<&str> = variables.keys().map(String::as_str).collect();
    let take =
        |given: Option<&str>, usual: &[&str]| find(&known, given, usual).map(|at| (known[at], &variables[known[at]]));
    let missing = |what: &'static str, usual: &[&str]| ConvertError::Missing {
        what,
        found: format!("the variables `{}`", known.join("`, `")),
        allowed: format!("a variable called `{}`, or its name", usual.join("`, `")),
    };
    let (azimuth_name, azimuths) =
        take(names.azimuth.as_deref(), &AZIMUTH).ok_or_else(|| missing("azimuths", &AZIMUTH))?;
    let (gain_name, gains) = take(names.gain.as_deref(), &GAIN).ok_or_else(|| missing("gains", &GAIN))?;
    let elevations = take(names.elevation.as_deref(), &ELEVATION);
    if names.elevation.is_some() && elevations.is_none() {
        return Err(missing("elevations", &ELEVATION));
    }
    let sectors = take(names.sector.as_deref(), &SECTOR).map(|(_, array)| array);
    let mut notes = Vec::new();
    if elevations.is_none() {
        notes.push("there are no elevations: the array is a planar cut at elevation 0".to_owned());
    }
    let flat = Array { dimensions: vec![1, 1], values: vec![0.0] };
    let of = AngleNames { azimuth: azimuth_name, elevation: elevations.map(|(name, _)| name) };
    let elevations = elevations.map_or(&flat, |(_, array)| array);
    let count = gains.values.len();
    let is_list = |array: &Array| array.values.len() == count;
    let mut rows = match sectors {
        Some(sectors)
            if is_list(sectors) && is_list(azimuths) && (is_list(elevations) || elevations.values.len() == 1) =>
        {
            listed(sectors, azimuths, elevations, gains)?
        }
        _ => on_axes(sectors, azimuths, elevations, gains, names.order, &mut notes)?,
    };
    angles::settle(&mut rows, &of, names)?;
    Ok(Source { rows, named_unit: ColumnName::of(gain_name).gain_unit(), gains: gain_name.to_owned(), notes })
}

/// One gain for each place of vectors of equal length.
fn listed(sectors: &Array, azimuths: &Array, elevations: &Array, gains: &Array) -> Result<Rows, ConvertError> {
    let row = |i: usize| {
        Ok(TableRow {
            owner: Owner::of(sectors.values[i], || format!("sector number {}", i + 1))?,
            azimuth_deg: azimuths.values[i],
            elevation_deg: elevations.values[i.min(elevations.values.len() - 1)],
            gain: gains.values[i],
        })
    };
    (0..gains.values.len()).map(row).collect::<Result<Vec<_>, _>>().map(Rows)
}

/// An array of gains whose axes are the sectors, azimuths and elevations, in the order that their lengths tell.
fn on_axes(
    sectors: Option<&Array>,
    azimuths: &Array,
    elevations: &Array,
    gains: &Array,
    order: Option<ArrayOrder>,
    notes: &mut Vec<String>,
) -> Result<Rows, ConvertError> {
    let count = |array: &Array| array.values.len();
    let cells = count(azimuths).saturating_mul(count(elevations));
    let sector_count = sectors.map_or_else(|| count(gains) / cells.max(1), count);
    let length = |axis: Axis| match axis {
        Axis::Sector => sector_count,
        Axis::Azimuth => count(azimuths),
        Axis::Elevation => count(elevations),
    };
    let mut dimensions = gains.dimensions.clone();
    dimensions.retain(|&length| length != 1);
    let found = format!(
        "{}, with {sector_count} sectors, {} azimuths and {} elevations",
        gains.dimensions.iter().map(usize::to_string).collect::<Vec<_>>().join(" by "),
        count(azimuths),
        count(elevations)
    );
    // Axes of length 1 are anywhere.
    let fits = |order: &&ArrayOrder| {
        order.0.iter().map(|&axis| length(axis)).filter(|&length| length != 1).eq(dimensions.iter().copied())
    };
    let all = ORDERS.map(ArrayOrder);
    let mut fitting: Vec<ArrayOrder> = match &order {
        Some(order) => std::iter::once(order).filter(fits).copied().collect(),
        None => all.iter().filter(fits).copied().collect(),
    };
    // Orders that differ in the place of an axis of length 1 only are the same.
    fitting.dedup_by_key(|order| {
        order.0.iter().filter(|&&axis| length(axis) != 1).map(|&axis| axis as u8).collect::<Vec<_>>()
    });
    let [order] = fitting[..] else {
        let allowed = match fitting.len() {
            0 => "an axis for each sector, azimuth and elevation".to_owned(),
            _ => "axes of different lengths, or their order, as `sector,elevation,azimuth`".to_owned(),
        };
        return Err(ConvertError::Shape { found, allowed });
    };
    if sectors.is_none() {
        notes.push(format!("there are no identities of sectors: they are 0 to {}", sector_count.saturating_sub(1)));
    }
    let mut rows = Vec::with_capacity(count(gains));
    for (place, &gain) in gains.values.iter().enumerate() {
        // The first axis runs fastest.
        let (mut rest, mut at) = (place, [0; 3]);
        for axis in order.0 {
            at[axis as usize] = rest % length(axis);
            rest /= length(axis);
        }
        let sector = at[Axis::Sector as usize];
        let identity = sectors.map_or(sector as f64, |sectors| sectors.values[sector]);
        rows.push(TableRow {
            owner: Owner::of(identity, || format!("sector number {}", sector + 1))?,
            azimuth_deg: azimuths.values[at[Axis::Azimuth as usize]],
            elevation_deg: elevations.values[at[Axis::Elevation as usize]],
            gain,
        });
    }
    Ok(Rows(rows))
}

/// All orders of the axes.
const ORDERS: [[Axis; 3]; 6] = {
    use Axis::{Azimuth, Elevation, Sector};
    [
        [Sector, Azimuth, Elevation],
        [Sector, Elevation, Azimuth],
        [Azimuth, Sector, Elevation],
        [Azimuth, Elevation, Sector],
        [Elevation, Sector, Azimuth],
        [Elevation, Azimuth, Sector],
    ]
};
