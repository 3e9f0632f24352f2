//! The directions of an anchor's sectors, from the anchors that it hears.
//!
//! An anchor knows its place but not how its antenna is turned. Each neighbour tells in which of the anchor's sectors it
//! hears best, and where it is itself: the direction to it lies in that sector (Gunathillake 2018, chapter 5, step 1).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{Position, Wedge};

use super::arcs::{Agreed, Arc, most_agreed};
use super::sector_bearing::SectorBearing;
use crate::grid_ml::directions::wrapped;

/// Two places nearer than this have no direction (m).
const NO_DIRECTION_M: f64 = 1e-9;
/// Intervals this far apart touch (rad): bearings on the edges of their sectors agree in spite of rounding.
const ROUNDING_RAD: f64 = 1e-9;
/// Number of standard deviations of the direction by which an interval is widened at each end. A direction that is uniform
/// in its sector, with an error of a quarter of the sector, is then outside in 0.4 % of the cases; with one standard
/// deviation in 4 %, with none in 20 % (twice `σ/HBW · E[(Z − k)⁺]` for a standard normal Z).
const DEVIATIONS: f64 = 2.0;
/// Directions that strengths tell agree within so many of their standard deviations.
const SURE: f64 = 3.0;

/// How the bearings of an anchor are combined, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case"))]
pub enum DirectionRule {
    /// The middle of the directions that the most bearings allow. If no more than half of them agree anywhere, the
    /// circular mean.
    #[default]
    Intervals,
    /// The circular mean of the directions, each taken for the middle of its sector (thesis, chapter 5, which has the
    /// arithmetic mean).
    CircularMean,
}

/// One neighbour of an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Where the neighbour is (m).
    pub place: Position,
    /// The anchor's own sector in which the neighbour hears it best, counted from 0 counterclockwise. Numbers beyond the
    /// first ring of sectors are those of further rings, one above the other.
    pub sector: u8,
    /// Covariance of the neighbour's place (m²), if it is an estimate.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// The direction of the neighbour in the frame of the anchor's antenna, if the strengths of several sectors tell it:
    /// surer than the sector alone.
    pub of_strengths: Option<SectorBearing>,
}

/// An anchor whose sectors are turned in an unknown way: rings of equal sectors round the vertical.
#[derive(Clone, Debug, PartialEq)]
pub struct UnorientedRing<'a> {
    /// Where the anchor is (m).
    pub place: Position,
    /// Covariance of this place (m²), if it is an estimate.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Number of sectors in a ring, `N_S`. 0 counts as 1.
    pub sectors: u8,
    /// Width of each sector in elevation (rad). All are raised by the same angle, which is unknown too.
    pub vertical_width_rad: f64,
    /// The neighbours that hear the anchor.
    pub bearings: &'a [Bearing],
}

/// How the sectors of an anchor are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingOrientation {
    /// Azimuth of the middle of sector 0 (rad), counterclockwise from x, in (−π, π]. Sector i is `i · 2π/N_S` further.
    pub azimuth_rad: f64,
    /// How far the azimuth may be off (rad), at most π: half the width of the interval, or the standard deviation of a
    /// mean.
    pub half_width_rad: f64,
    /// Elevation of the middle of all sectors (rad), in [−π/2, π/2].
    pub elevation_rad: f64,
    /// How far the elevation may be off (rad): half the width of the interval; 0 for the mean of the elevations, which
    /// claims nothing.
    pub elevation_half_width_rad: f64,
    /// Standard deviation of the neighbours' elevations about their mean (rad); 0 for one neighbour.
    pub elevation_spread_rad: f64,
    /// How the azimuth was found.
    pub method: OrientationMethod,
    /// Number of neighbours with a direction: those that are not at the anchor's own place.
    pub bearings: usize,
}

/// How an orientation was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationMethod {
    /// From the directions that this many bearings allow, the most that agree.
    Intersected {
        /// Number of bearings that agree.
        agreeing: usize,
    },
    /// As the mean of the directions that strengths tell, each weighed by its variance, of the neighbours that agree with most.
    Weighed {
        /// Number of bearings that agree.
        agreeing: usize,
    },
    /// As the circular mean.
    CircularMean,
}

impl RingOrientation {
    /// Share of the neighbours with a direction that agree on the azimuth; 0 for the circular mean.
    #[must_use]
    pub fn agreement(&self) -> f64 {
        match self.method {
            OrientationMethod::Intersected { agreeing } | OrientationMethod::Weighed { agreeing } => {
                agreeing as f64 / self.bearings as f64
            }
            OrientationMethod::CircularMean => 0.0,
        }
    }

    /// Standard deviation of the azimuth (rad): that of a uniform law over the interval, or that of the mean.
    #[must_use]
    pub fn azimuth_sigma_rad(&self) -> f64 {
        match self.method {
            OrientationMethod::Intersected { .. } => self.half_width_rad / 3.0_f64.sqrt(),
            OrientationMethod::Weighed { .. } | OrientationMethod::CircularMean => self.half_width_rad,
        }
    }

    /// Azimuth of the middle of a sector (rad), in (−π, π]; `sectors` is the number in a ring.
    #[must_use]
    pub(crate) fn sector_azimuth_rad(&self, sector: u8, sectors: u8) -> f64 {
        wrapped(self.azimuth_rad + TAU * f64::from(sector % sectors.max(1)) / f64::from(sectors.max(1)))
    }

    /// The directions of a sector between two elevations (rad); `sectors` is the number in a ring.
    #[must_use]
    pub fn wedge(&self, sector: u8, sectors: u8, elevation_rad: [f64; 2]) -> Wedge {
        let width = TAU / f64::from(sectors.max(1));
        let azimuth_from_rad = wrapped(self.sector_azimuth_rad(sector, sectors) - 0.5 * width);
        Wedge { azimuth_from_rad, azimuth_width_rad: width, elevation_rad }
    }
}

impl UnorientedRing<'_> {
    /// How the sectors are turned; `None` without a neighbour that has a direction.
    ///
    /// Neighbour k at the azimuth `φ_k` hears sector `h_k` best, so the middle of sector 0 is at `φ_k − h_k HBW`, give or
    /// take `HBW/2` and the error of `φ_k` (two standard deviations, from the covariances). [`DirectionRule::Intervals`]
    /// takes the azimuths that the most neighbours allow. More than half of all must agree, so that a neighbour with a
    /// wrong place or sector changes little. If several intervals have equally many, the result spans all of them: each
    /// two share a neighbour, so they are close to each other. Without noise and wrong neighbours the true azimuth is
    /// never further than `half_width_rad` away.
    ///
    /// The elevation is found in the same way: each neighbour is within half a vertical width of it. Without such an
    /// interval, and by [`DirectionRule::CircularMean`], it is the mean of the neighbours' elevations (thesis, chapter 5).
    #[must_use]
    pub fn orientation(&self, rule: DirectionRule) -> Option<RingOrientation> {
        let lines: Vec<BearingLine> = self.bearings.iter().filter_map(|bearing| self.line(bearing)).collect();
        if lines.is_empty() {
            return None;
        }
        let count = lines.len() as f64;
        let mean_rad = lines.iter().map(|line| line.elevation).sum::<f64>() / count;
        let squares: f64 = lines.iter().map(|line| (line.elevation - mean_rad).powi(2)).sum();
        let agreed = |arc: fn(&BearingLine) -> Arc| {
            let arcs: Vec<Arc> = lines.iter().map(arc).collect();
            if rule == DirectionRule::Intervals { most_agreed(&arcs) } else { None }
        };
        let (azimuth_rad, half_width_rad, method) = match agreed(|line| line.azimuth) {
            Some(agreed) => {
                let method = OrientationMethod::Intersected { agreeing: agreed.agreeing };
                weighed_mean(&lines, agreed).unwrap_or((agreed.middle, agreed.half, method))
            }
            None => self.circular_mean(&lines),
        };
        let (elevation_rad, elevation_half_width_rad) =
            agreed(|line| line.raised).map_or((mean_rad, 0.0), |agreed| (agreed.middle, agreed.half));
        Some(RingOrientation {
            azimuth_rad,
            half_width_rad,
            elevation_rad: elevation_rad.clamp(-FRAC_PI_2, FRAC_PI_2),
            elevation_half_width_rad,
            elevation_spread_rad: (squares / count).sqrt(),
            method,
            bearings: lines.len(),
        })
    }

    /// Width of a sector (rad).
    fn width(&self) -> f64 {
        TAU / f64::from(self.sectors.max(1))
    }

    fn line(&self, bearing: &Bearing) -> Option<BearingLine> {
        let apart = bearing.place - self.place;
        let across_m = libm::hypot(apart.x_m, apart.y_m);
        if !apart.is_finite() || across_m <= NO_DIRECTION_M {
            return None;
        }
        let (sin, cos) = (apart.y_m / across_m, apart.x_m / across_m);
        let variance: f64 = [self.covariance, bearing.covariance]
            .iter()
            .flatten()
            .map(|c| sin * sin * c[0][0] + cos * cos * c[1][1] - sin * cos * (c[0][1] + c[1][0]))
            .sum();
        let sector = f64::from(bearing.sector % self.sectors.max(1));
        let sigma = variance.max(0.0).sqrt() / across_m;
        let up_variance: f64 = [self.covariance, bearing.covariance].iter().flatten().map(|c| c[2][2]).sum();
        let elevation = libm::atan2(apart.z_m, across_m);
        // An error along the line of sight changes the elevation less than one straight up does.
        let up_sigma = up_variance.max(0.0).sqrt() * libm::cos(elevation) / libm::hypot(across_m, apart.z_m);
        let half = |width: f64, sigma: f64| (0.5 * width + DEVIATIONS * sigma + ROUNDING_RAD).min(PI);
        let azimuth = libm::atan2(apart.y_m, apart.x_m);
        let told = bearing.of_strengths.map(|told| (told.azimuth_rad, libm::hypot(told.sigma_rad, sigma)));
        let azimuth = match told {
            Some((of_sector_0, sigma)) => {
                Arc { middle: wrapped(azimuth - of_sector_0), half: half(0.0, SURE / DEVIATIONS * sigma) }
            }
            None => Arc { middle: wrapped(azimuth - sector * self.width()), half: half(self.width(), sigma) },
        };
        Some(BearingLine {
            azimuth,
            azimuth_sigma_rad: told.map(|(_, sigma)| sigma),
            elevation,
            raised: Arc { middle: elevation, half: half(self.vertical_width_rad, up_sigma) },
        })
    }

    /// The circular mean of the azimuths and its standard deviation: the circular standard deviation `√(−2 ln R)` of one
    /// (Mardia and Jupp 2000, section 2.3.4), at least that of a uniform law over a sector, over the root of their number.
    fn circular_mean(&self, lines: &[BearingLine]) -> (f64, f64, OrientationMethod) {
        let [x, y] = lines
            .iter()
            .map(|line| line.azimuth.middle)
            .fold([0.0, 0.0], |[x, y], azimuth| [x + libm::cos(azimuth), y + libm::sin(azimuth)]);
        let count = lines.len() as f64;
        let resultant = (libm::hypot(x, y) / count).clamp(1e-12, 1.0);
        let one = (-2.0 * libm::log(resultant)).sqrt().max(self.width() / 12.0_f64.sqrt());
        // A direction that is uniform on the circle has this one.
        let sigma = (one / count.sqrt()).min(PI / 3.0_f64.sqrt());
        (libm::atan2(y, x), sigma, OrientationMethod::CircularMean)
    }
}

/// The mean of the azimuths that strengths tell, of those bearings that agree with most: weighed by their variances. If they are
/// farther apart than these say, its standard deviation is larger in the same proportion. `None` if strengths tell less than half of the
/// bearings that agree.
fn weighed_mean(lines: &[BearingLine], agreed: Agreed) -> Option<(f64, f64, OrientationMethod)> {
    let told = || {
        lines.iter().filter_map(|line| {
            let off = wrapped(line.azimuth.middle - agreed.middle);
            let sigma = line.azimuth_sigma_rad.filter(|_| off.abs() <= line.azimuth.half + agreed.half)?;
            Some((off, 1.0 / (sigma * sigma)))
        })
    };
    let count = told().count();
    if 2 * count < agreed.agreeing || count == 0 {
        return None;
    }
    let weight: f64 = told().map(|(_, weight)| weight).sum();
    let mean = told().map(|(off, weight)| weight * off).sum::<f64>() / weight;
    let square: f64 = told().map(|(off, weight)| weight * (off - mean) * (off - mean)).sum();
    let spread = if count > 1 { (square / (count as f64 - 1.0)).max(1.0) } else { 1.0 };
    let method = OrientationMethod::Weighed { agreeing: agreed.agreeing };
    Some((wrapped(agreed.middle + mean), (spread / weight).sqrt(), method))
}

/// What one bearing says.
struct BearingLine {
    /// Azimuths of the middle of sector 0.
    azimuth: Arc,
    /// Standard deviation of its middle (rad), if strengths tell it.
    azimuth_sigma_rad: Option<f64>,
    /// Elevation of the neighbour (rad).
    elevation: f64,
    /// Elevations of the middle of the sectors: the neighbour is within half their width.
    raised: Arc,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HERE: Position = Position::new(2.0, -1.0, 1.5);

    fn at(azimuth: f64, distance_m: f64, z_m: f64) -> Position {
        HERE + Position::new(distance_m * libm::cos(azimuth), distance_m * libm::sin(azimuth), z_m)
    }

    /// The bearing of a neighbour at `azimuth` if sector 0 points to `truth`.
    fn heard(truth: f64, azimuth: f64, sectors: u8) -> Bearing {
        let width = TAU / f64::from(sectors);
        let sector = ((azimuth - truth + 0.5 * width).rem_euclid(TAU) / width).floor();
        let sector = (0..sectors).find(|&i| (f64::from(i) - sector).abs() < 0.5).unwrap_or(0);
        Bearing { place: at(azimuth, 4.0, 0.0), sector, covariance: None, of_strengths: None }
    }

    fn ring(sectors: u8, bearings: &[Bearing]) -> UnorientedRing<'_> {
        UnorientedRing { place: HERE, covariance: None, sectors, vertical_width_rad: PI, bearings }
    }

    fn off(a: f64, b: f64) -> f64 {
        wrapped(a - b).abs()
    }

    proptest! {
        #[test]
        fn the_true_azimuth_is_in_the_interval_which_shrinks_with_each_bearing(
            truth in -PI..PI, azimuths in prop::collection::vec(-PI..PI, 1..12), sectors in 1..17_u8,
        ) {
            let bearings: Vec<Bearing> = azimuths.iter().map(|&azimuth| heard(truth, azimuth, sectors)).collect();
            let mut before = PI;
            for count in 1..=bearings.len() {
                let found = ring(sectors, &bearings[..count]).orientation(DirectionRule::Intervals).unwrap();
                prop_assert_eq!(found.method, OrientationMethod::Intersected { agreeing: count });
                prop_assert!(off(found.azimuth_rad, truth) <= found.half_width_rad + 1e-9, "{:?}", found);
                prop_assert!(found.half_width_rad <= before + 1e-9);
                before = found.half_width_rad;
            }
        }

        #[test]
        fn the_true_elevation_is_in_the_interval(
            raised in -0.6_f64..0.6, width in 0.2_f64..1.5, lines in prop::collection::vec((-PI..PI, -0.5..0.5), 1..12),
        ) {
            // Each neighbour is somewhere within the width of the beams.
            let place = |&(azimuth, off): &(f64, f64)| at(azimuth, 4.0, 4.0 * libm::tan(raised + width * off));
            let bearings: Vec<Bearing> =
                lines.iter().map(|line| Bearing { place: place(line), sector: 0, covariance: None, of_strengths: None }).collect();
            let ring = UnorientedRing { vertical_width_rad: width, ..ring(1, &bearings) };
            let found = ring.orientation(DirectionRule::Intervals).unwrap();
            prop_assert!((found.elevation_rad - raised).abs() <= found.elevation_half_width_rad + 1e-9, "{:?}", found);
            let mean = ring.orientation(DirectionRule::CircularMean).unwrap();
            let expected = lines.iter().map(|line| raised + width * line.1).sum::<f64>() / lines.len() as f64;
            prop_assert!((mean.elevation_rad - expected).abs() < 1e-9 && mean.elevation_half_width_rad <= 0.0);
        }

        #[test]
        fn the_interval_is_that_of_a_fine_circle(
            truth in -PI..PI, azimuths in prop::collection::vec((-PI..PI, 0..8_u8), 1..9), sectors in 3..9_u8,
        ) {
            // Every third neighbour names any sector.
            let bearings: Vec<Bearing> = azimuths.iter().enumerate().map(|(i, &(azimuth, any))| {
                let bearing = heard(truth, azimuth, sectors);
                if i % 3 == 2 { Bearing { sector: any, ..bearing } } else { bearing }
            }).collect();
            let half = PI / f64::from(sectors);
            let agree = |angle: f64| bearings.iter().filter(|bearing| {
                let apart = bearing.place - HERE;
                let sector = f64::from(bearing.sector % sectors);
                off(libm::atan2(apart.y_m, apart.x_m) - 2.0 * half * sector, angle) <= half
            }).count();
            let circle: Vec<f64> = (0..20_000).map(|i| -PI + TAU * f64::from(i) / 20_000.0).collect();
            let most = circle.iter().map(|&angle| agree(angle)).max().unwrap();
            let found = ring(sectors, &bearings).orientation(DirectionRule::Intervals).unwrap();
            match found.method {
                OrientationMethod::Intersected { agreeing } | OrientationMethod::Weighed { agreeing } => {
                    // An arc narrower than the circle's step can escape brute force.
                    prop_assert!(agreeing == most || found.half_width_rad < TAU / 20_000.0 || agreeing > most);
                    if agreeing == most {
                        let reach = circle.iter().filter(|&&angle| agree(angle) == most)
                            .map(|&angle| off(angle, found.azimuth_rad)).fold(0.0, f64::max);
                        prop_assert!((reach - found.half_width_rad).abs() < 2.0 * TAU / 20_000.0, "{reach} {found:?}");
                    }
                }
                OrientationMethod::CircularMean => prop_assert!(2 * most <= bearings.len()),
            }
        }

        #[test]
        fn turning_all_turns_the_result(turn in -7.0..7.0_f64, azimuths in prop::collection::vec(-PI..PI, 1..7)) {
            for rule in [DirectionRule::Intervals, DirectionRule::CircularMean] {
                let of = |turn: f64| {
                    let bearings: Vec<Bearing> =
                        azimuths.iter().map(|azimuth| heard(0.3 + turn, azimuth + turn, 8)).collect();
                    ring(8, &bearings).orientation(rule).unwrap()
                };
                let (one, other) = (of(0.0), of(turn));
                prop_assert!(off(other.azimuth_rad, one.azimuth_rad + turn) < 1e-6);
                prop_assert!((other.half_width_rad - one.half_width_rad).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn one_neighbour_that_lies_does_not_move_the_result() {
        let mut bearings: Vec<Bearing> = [3.1, -3.0, 1.0, -1.2].map(|azimuth| heard(PI, azimuth, 8)).to_vec();
        let honest = ring(8, &bearings).orientation(DirectionRule::Intervals).unwrap();
        let sector = (bearings[2].sector + 3) % 8;
        bearings.push(Bearing { sector, ..bearings[2] });
        let found = ring(8, &bearings).orientation(DirectionRule::Intervals).unwrap();
        assert_eq!((found.method, found.bearings), (OrientationMethod::Intersected { agreeing: 4 }, 5));
        assert!(off(found.azimuth_rad, honest.azimuth_rad) < 1e-9);
        assert!(off(found.azimuth_rad, PI) <= found.half_width_rad);
    }

    #[test]
    fn two_that_contradict_each_other_give_their_mean_and_a_wide_error() {
        let one = heard(0.0, 0.1, 8);
        let bearings = [one, Bearing { sector: one.sector + 2, ..one }];
        let found = ring(8, &bearings).orientation(DirectionRule::Intervals).unwrap();
        assert_eq!(found.method, OrientationMethod::CircularMean);
        assert!(off(found.azimuth_rad, 0.1 - TAU / 8.0) < 1e-12);
        // Two azimuths 45 degrees from their mean: R = cos 45°, so √(−2 ln R)/√2 = √(ln 2 / 2).
        assert!((found.half_width_rad - (0.5 * 2.0_f64.ln()).sqrt()).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_circular_mean_has_no_seam() {
        // Middles of sector 0 at 179 and at -179 degrees.
        let bearings = [179.0_f64, -179.0].map(|deg| heard(PI, deg.to_radians(), 8));
        let found = ring(8, &bearings).orientation(DirectionRule::CircularMean).unwrap();
        assert!(off(found.azimuth_rad, PI) < 1e-9);
        let uniform = TAU / 8.0 / 12.0_f64.sqrt() / 2.0_f64.sqrt();
        assert!((found.half_width_rad - uniform).abs() < 1e-9);
    }

    #[test]
    fn uncertain_places_widen_the_interval() {
        let exact = heard(0.4, 0.3, 8);
        // 0.5 m across the line of 4 m: 0.125 rad; what lies along the line does not count.
        let (sin, cos) = (libm::sin(0.3), libm::cos(0.3));
        let covariance = [
            [0.25 * sin * sin + 9.0 * cos * cos, (9.0 - 0.25) * sin * cos, 0.0],
            [(9.0 - 0.25) * sin * cos, 0.25 * cos * cos + 9.0 * sin * sin, 0.0],
            [0.0, 0.0, 4.0],
        ];
        let of = |bearing| ring(8, &[bearing]).orientation(DirectionRule::Intervals).unwrap().half_width_rad;
        assert!((of(exact) - PI / 8.0).abs() < 1e-8);
        assert!((of(Bearing { covariance: Some(covariance), ..exact }) - PI / 8.0 - 0.25).abs() < 1e-8);
        let bearings = [exact];
        let own = UnorientedRing { covariance: Some(covariance), ..ring(8, &bearings) };
        let found = own.orientation(DirectionRule::Intervals).unwrap();
        assert!((found.half_width_rad - PI / 8.0 - 0.25).abs() < 1e-8);
    }

    #[test]
    fn elevations_are_averaged_and_neighbours_at_the_same_place_say_nothing() {
        let up = Bearing { place: at(0.0, 4.0, 4.0), sector: 0, covariance: None, of_strengths: None };
        let level = Bearing { place: at(0.1, 4.0, 0.0), ..up };
        let here = Bearing { place: HERE, ..up };
        let found = ring(8, &[up, level, here]).orientation(DirectionRule::Intervals).unwrap();
        assert_eq!(found.bearings, 2);
        assert!((found.elevation_rad - PI / 8.0).abs() < 1e-9);
        assert!((found.elevation_spread_rad - PI / 8.0).abs() < 1e-9);
        assert_eq!(ring(8, &[here]).orientation(DirectionRule::Intervals), None);
        assert_eq!(ring(8, &[]).orientation(DirectionRule::CircularMean), None);
    }

    #[test]
    fn a_sector_of_a_further_ring_and_a_single_sector_are_understood() {
        let second_ring = Bearing { sector: 8 + 3, ..heard(0.2, 0.2, 8) };
        let first_ring = Bearing { sector: 3, ..second_ring };
        let of = |bearing| ring(8, &[bearing]).orientation(DirectionRule::Intervals).unwrap();
        assert_eq!(of(second_ring), of(first_ring));
        let found = ring(1, &[first_ring]).orientation(DirectionRule::Intervals).unwrap();
        assert!((found.half_width_rad - PI).abs() < 1e-12);
        let wedge = of(heard(0.0, 0.0, 8)).wedge(4, 8, [-1.0, 1.0]);
        assert!(off(wedge.azimuth_from_rad, PI - PI / 8.0) < 1e-9);
        assert!((wedge.azimuth_width_rad - PI / 4.0).abs() < 1e-12);
    }

    #[test]
    fn directions_of_strengths_are_weighed_and_one_that_is_far_off_does_not_count() {
        let told = |azimuth: f64, error: f64, sigma_rad: f64| Bearing {
            of_strengths: Some(SectorBearing { azimuth_rad: wrapped(azimuth - 0.3 + error), sigma_rad }),
            ..heard(0.3, azimuth, 8)
        };
        let mut bearings = vec![told(0.1, 0.02, 0.02), told(2.0, -0.04, 0.04), told(-2.5, 0.01, 0.02)];
        let found = ring(8, &bearings).orientation(DirectionRule::Intervals).unwrap();
        // Errors of bearings turn the antenna the other way: (-0.02 w + 0.04 w / 4 - 0.01 w) / (2.25 w).
        assert!(off(found.azimuth_rad, 0.3 - 0.02 / 2.25) < 1e-9, "{found:?}");
        assert!((found.azimuth_sigma_rad() - 0.02 / 1.5).abs() < 1e-9, "{found:?}");
        assert_eq!(found.method, OrientationMethod::Weighed { agreeing: 3 });
        bearings.push(told(1.0, 1.0, 0.02));
        let robust = ring(8, &bearings).orientation(DirectionRule::Intervals).unwrap();
        assert!(off(robust.azimuth_rad, found.azimuth_rad) < 1e-9 && (robust.agreement() - 0.75).abs() < 1e-12);
        // Without strengths the interval is as wide as the sectors leave it.
        let of_sectors: Vec<Bearing> = bearings.iter().map(|b| Bearing { of_strengths: None, ..*b }).collect();
        let wide = ring(8, &of_sectors).orientation(DirectionRule::Intervals).unwrap();
        assert!(wide.azimuth_sigma_rad() > 3.0 * found.azimuth_sigma_rad(), "{wide:?}");
    }
}
