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
        let [low, high] = wedge.elevation_rad.map(libm::sin);
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

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, Reception, SectorConfig, SectorTable, Stop};
    use sextant_kernel::{NodeId, RobotId, SimTime};

    use super::*;

    /// A log whose four sectors are each so wide in azimuth (degrees).
    fn log(width_deg: f64) -> ReceptionLog {
        let sector = |sector: u8| SectorConfig {
            sector,
            azimuth_from_deg: 90.0 * f64::from(sector),
            azimuth_to_deg: 90.0 * f64::from(sector) + width_deg,
            elevation_from_deg: -90.0,
            elevation_to_deg: 90.0,
        };
        let stop = Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::ORIGIN, heading_rad: None };
        let heard = Reception {
            node: NodeId(0),
            stop: 0,
            received: 1,
            sent: 1,
            sector: Some(2),
            rssi_dbm: None,
            snr_db: None,
        };
        let log = ReceptionLog::new(vec!["a".into()], vec![stop], vec![heard], Vec::new()).unwrap();
        log.with_sectors(SectorTable::new((0..4).map(sector)).unwrap()).unwrap()
    }

    #[test]
    fn sectors_that_overlap_twice_are_told_with_their_width() {
        assert_eq!(finding(&log(90.0)), None);
        assert_eq!(finding(&log(170.0)), None);
        let found = finding(&log(190.0)).unwrap();
        assert_eq!(found.odd, "the 4 sectors are 190 degrees wide on average, and a direction is in 2.1 of them");
        assert!(found.remedy.contains("antenna.toml"));
    }
}
