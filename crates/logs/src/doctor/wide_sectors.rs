//! Sectors whose directions overlap so much that they say little.

use std::f64::consts::TAU;

use sextant_channel::{ReceptionLog, Wedge};

use super::finding::Finding;

/// Directions are in so many sectors on average, or more.
const OVERLAP: f64 = 2.0;

/// What is odd of a log whose sectors are wide intervals of directions, where the gains of the antenna are not known.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let table = log.sectors().filter(|table| table.gains().is_none() && log.receptions().sectors().is_some())?;
    let wedges: Vec<Wedge> = table.iter().filter_map(|sector| sector.wedge().ok()).collect();
    let share = |wedge: &Wedge| {
        let [low, high] = wedge.elevation_rad.map(f64::sin);
        0.5 * (high - low) * wedge.azimuth_width_rad / TAU
    };
    let overlap: f64 = wedges.iter().map(share).sum();
    if overlap < OVERLAP {
        return None;
    }
    let width_deg =
        wedges.iter().map(|wedge| wedge.azimuth_width_rad.to_degrees()).sum::<f64>() / wedges.len() as f64;
    Some(Finding {
        check: "wide-sectors",
        odd: format!(
            "the {} sectors are {width_deg:.0} degrees wide on average, and a direction is in {overlap:.1} of them",
            wedges.len()
        ),
        cost: "an interval of directions says little of where such a sector is the best".to_owned(),
        remedy: "give the gains of the antenna in `antenna.toml`: maps then use how likely each sector is in each direction"
            .to_owned(),
    })
}
