//! The directions that the sectors of a listener cover together.
//!
//! Where no sector points, nothing is received. So a stop that heard nothing says nothing about vertices there.

use std::f64::consts::{FRAC_PI_2, TAU};

use sextant_channel::Wedge;

use super::sector_conditions::SectorConditions;

/// Angles closer than this are equal (rad).
const ROUNDING_RAD: f64 = 1e-9;

/// A part of the sphere.
#[derive(Clone, Debug)]
pub(super) struct SpherePart {
    pub(super) test: SectorConditions,
    pub(super) wedge: Wedge,
}

impl SpherePart {
    /// The parts of the sphere that `sectors` cover; `None` if they cover every direction in which a vertex may be. The
    /// sectors of a ring that fill the circle become one part, made by `of_ring`, without conditions on the azimuth.
    pub(super) fn outside_of_which_silence_is_certain(
        sectors: Vec<Self>,
        is_flat: bool,
        mut of_ring: impl FnMut(&Wedge) -> Self,
    ) -> Option<Vec<Self>> {
        let wedges: Vec<Wedge> = sectors.iter().map(|part| part.wedge).collect();
        let needed = if is_flat { [0.0; 2] } else { [-FRAC_PI_2, FRAC_PI_2] };
        if fill(&wedges, needed) {
            return None;
        }
        let mut parts: Vec<Self> = Vec::new();
        let mut rings: Vec<[f64; 2]> = Vec::new();
        for part in sectors {
            let elevations = part.wedge.elevation_rad;
            if rings.iter().any(|ring| is_same(ring, &elevations)) {
                continue;
            }
            let ring: Vec<Wedge> =
                wedges.iter().copied().filter(|wedge| is_same(&wedge.elevation_rad, &elevations)).collect();
            if fill(&ring, elevations) {
                rings.push(elevations);
                parts.push(of_ring(&Wedge {
                    azimuth_from_rad: 0.0,
                    azimuth_width_rad: TAU,
                    elevation_rad: elevations,
                }));
            } else {
                parts.push(part);
            }
        }
        Some(parts)
    }
}

fn is_same(a: &[f64; 2], b: &[f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDING_RAD)
}

/// Whether `wedges` together hold every azimuth at all elevations from the first to the second of `needed` (rad).
fn fill(wedges: &[Wedge], needed: [f64; 2]) -> bool {
    let mut edges: Vec<f64> = vec![0.0, TAU];
    for wedge in wedges {
        edges.extend([0.0, wedge.azimuth_width_rad].map(|width| (wedge.azimuth_from_rad + width).rem_euclid(TAU)));
    }
    edges.sort_unstable_by(f64::total_cmp);
    edges.windows(2).filter(|arc| arc[1] - arc[0] > ROUNDING_RAD).all(|arc| {
        let azimuth = 0.5 * (arc[0] + arc[1]);
        let holds = |wedge: &&Wedge| (azimuth - wedge.azimuth_from_rad).rem_euclid(TAU) <= wedge.azimuth_width_rad;
        let mut elevations: Vec<[f64; 2]> = wedges.iter().filter(holds).map(|wedge| wedge.elevation_rad).collect();
        elevations.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let mut reached = None;
        for [low, high] in elevations {
            let from: f64 = reached.unwrap_or(needed[0]);
            if low <= from + ROUNDING_RAD && high >= from - ROUNDING_RAD {
                reached = Some(from.max(high));
            }
        }
        reached.is_some_and(|reached| reached >= needed[1] - ROUNDING_RAD)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wedge(azimuth_deg: [f64; 2], elevation_deg: [f64; 2]) -> Wedge {
        Wedge {
            azimuth_from_rad: azimuth_deg[0].to_radians(),
            azimuth_width_rad: (azimuth_deg[1] - azimuth_deg[0]).to_radians(),
            elevation_rad: elevation_deg.map(f64::to_radians),
        }
    }

    #[test]
    fn what_sectors_fill_is_found_by_arcs_of_azimuth() {
        let sphere = [-FRAC_PI_2, FRAC_PI_2];
        let ring = |elevation: [f64; 2]| -> Vec<Wedge> {
            (-4..4).map(|i| wedge([45.0 * f64::from(i) + 20.0, 45.0 * f64::from(i) + 65.0], elevation)).collect()
        };
        assert!(fill(&ring([-90.0, 90.0]), sphere));
        let rings =
            |elevations: &[[f64; 2]]| elevations.iter().flat_map(|&elevation| ring(elevation)).collect::<Vec<_>>();
        assert!(fill(&rings(&[[10.0, 90.0], [-90.0, 20.0]]), sphere));
        assert!(!fill(&rings(&[[10.0, 90.0], [-90.0, 5.0]]), sphere), "a gap between the rings");
        assert!(!fill(&ring([-90.0, 90.0])[1..], sphere), "a gap of azimuth");
        assert!(!fill(&ring([0.0, 50.0]), sphere) && fill(&ring([0.0, 50.0]), [0.0; 2]), "enough for a plane");
        assert!(!fill(&ring([25.0, 75.0]), [0.0; 2]) && !fill(&[], [0.0; 2]));
        // Two half circles that differ in their rings still fill the sphere.
        let east = [wedge([-90.0, 90.0], [-90.0, 10.0]), wedge([-90.0, 90.0], [10.0, 90.0])];
        let west = wedge([90.0, 270.0], [-90.0, 90.0]);
        assert!(fill(&[east[0], east[1], west], sphere) && !fill(&[east[0], west], sphere));
    }
}
