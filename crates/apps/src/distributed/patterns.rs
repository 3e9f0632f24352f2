//! The patterns of antennas, by which strengths tell directions.

use std::f64::consts::TAU;
use std::sync::Arc;

use sextant_channel::Wedge;
use sextant_mapper::{BearingTable, HeardSector, SectorBearing};

use super::message::Directions;

/// Half the width of the wedge that stands for a bearing with a normal error, in standard deviations. Of the variance this is
/// a part; the azimuth of the wedge has the rest, so that both together have the variance of the bearing.
const HALF_WEDGE: f64 = 1.2;

/// The patterns of the antennas of a network; none where the best sector alone tells a direction.
#[derive(Clone, Debug, Default)]
pub struct Patterns {
    /// Of nodes.
    pub nodes: Option<Arc<BearingTable>>,
    /// Of mobile anchors.
    pub robots: Option<Arc<BearingTable>>,
}

impl Patterns {
    /// The direction of the listener in the frame of the antenna from whose sectors it heard these strengths (dB).
    pub(super) fn bearing(&self, is_mobile: bool, strengths: &[(u8, f64)]) -> Option<SectorBearing> {
        let table = if is_mobile { &self.robots } else { &self.nodes };
        table.as_ref()?.bearing(strengths)
    }
}

/// The evidence that an anchor with these directions was heard best in `sector`, and from this bearing if it is known.
pub(super) fn heard_sector(
    directions: &Directions,
    sector: u8,
    bearing: Option<SectorBearing>,
) -> Option<HeardSector> {
    let wedge = directions.wedge(sector)?;
    let Some(SectorBearing { azimuth_rad, sigma_rad }) = bearing else {
        return Some(HeardSector { wedge, azimuth_sigma_rad: directions.azimuth_sigma_rad });
    };
    let variance = directions.azimuth_sigma_rad * directions.azimuth_sigma_rad + sigma_rad * sigma_rad;
    let half = (HALF_WEDGE * variance.sqrt()).min(0.5 * TAU);
    let wedge = Wedge {
        azimuth_from_rad: directions.azimuth_rad + azimuth_rad - half,
        azimuth_width_rad: 2.0 * half,
        ..wedge
    };
    Some(HeardSector { wedge, azimuth_sigma_rad: (variance * (1.0 - HALF_WEDGE * HALF_WEDGE / 3.0)).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bearing_is_a_narrow_wedge_with_the_same_variance() {
        let directions =
            Directions { azimuth_rad: 0.5, azimuth_sigma_rad: 0.03, sectors: 8, rings: vec![[-0.4, 0.4]] };
        let of_sector = heard_sector(&directions, 2, None).unwrap();
        assert!((of_sector.wedge.azimuth_width_rad - TAU / 8.0).abs() < 1e-12);
        assert!((of_sector.azimuth_sigma_rad - 0.03).abs() < 1e-12);
        let bearing = SectorBearing { azimuth_rad: 1.4, sigma_rad: 0.04 };
        let HeardSector { wedge, azimuth_sigma_rad } = heard_sector(&directions, 2, Some(bearing)).unwrap();
        let half = 0.5 * wedge.azimuth_width_rad;
        assert!((wedge.azimuth_from_rad + half - 1.9).abs() < 1e-12);
        // A uniform law and a normal one: 0.03 and 0.04 make 0.05.
        let sigma = (half * half / 3.0 + azimuth_sigma_rad * azimuth_sigma_rad).sqrt();
        assert!((sigma - 0.05).abs() < 1e-12, "{sigma}");
        assert_eq!(wedge.elevation_rad.map(f64::to_bits), of_sector.wedge.elevation_rad.map(f64::to_bits));
        assert!(heard_sector(&directions, 9, Some(bearing)).is_none());
    }
}
