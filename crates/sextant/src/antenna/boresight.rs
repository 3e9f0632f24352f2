//! The main lobe of a sector: its boresight and its half-power widths.

use sextant_channel::{Antenna, Position};

/// Gains that differ by less are equal (dB).
pub(super) const EQUAL_DB: f64 = 1e-9;
/// How far below its peak the half-power width ends (dB).
const HALF_POWER_DB: f64 = 3.010_299_956_639_812;
/// The steps in which an edge of a lobe is looked for (degrees).
const STEP_DEG: f64 = 0.25;
/// A peak is found to this angle (degrees).
const FINEST_DEG: f64 = 1e-4;

/// The main lobe of a sector. Angles are in the frame of the antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lobe {
    sector: u8,
    /// The greatest gain.
    pub(super) peak_dbi: f64,
    /// The boresight: the middle of the directions with the greatest gain.
    pub(super) azimuth_deg: f64,
    pub(super) elevation_deg: f64,
}

impl Lobe {
    /// That of a sector.
    pub(super) fn of(antenna: &Antenna, sector: u8) -> Self {
        let gain = |azimuth_deg: f64, elevation_deg: f64| antenna.gain(sector, towards(azimuth_deg, elevation_deg)).0;
        let mut grid = Vec::new();
        for elevation in -90..=90 {
            for azimuth in -180..180 {
                let (azimuth, elevation) = (f64::from(azimuth), f64::from(elevation));
                grid.push(([azimuth, elevation], gain(azimuth, elevation)));
            }
        }
        let greatest = grid.iter().map(|(_, gain_dbi)| *gain_dbi).fold(f64::NEG_INFINITY, f64::max);
        let is_greatest = |(_, gain_dbi): &&([f64; 2], f64)| *gain_dbi > greatest - EQUAL_DB;
        let at_peak: Vec<[f64; 2]> = grid.iter().filter(is_greatest).map(|(place, _)| *place).collect();
        // The middle of all of them, if it is one: two lobes have it between them. Those of a ring stand for its area.
        let sum = at_peak.iter().fold(Position::default(), |sum, [azimuth, elevation]| {
            let (weight, part) = (libm::cos(elevation.to_radians()), towards(*azimuth, *elevation));
            Position::new(sum.x_m + weight * part.x_m, sum.y_m + weight * part.y_m, sum.z_m + weight * part.z_m)
        });
        let across = libm::hypot(sum.x_m, sum.y_m);
        let middle = [libm::atan2(sum.y_m, sum.x_m).to_degrees(), libm::atan2(sum.z_m, across).to_degrees()];
        let is_at_peak = |place: &[f64; 2]| gain(place[0], place[1]) > greatest - EQUAL_DB;
        let is_somewhere = libm::hypot(across, sum.z_m) > 1e-6 * at_peak.len() as f64;
        let start = [middle].into_iter().filter(|_| is_somewhere).chain([[0.0, 0.0]]).find(is_at_peak);
        let start = start.or(at_peak.first().copied()).unwrap_or_default();
        let (mut place, peak_dbi) = climbed(start, &gain);
        // A flat top: the middle between its edges, in azimuth and in elevation.
        let level = peak_dbi - EQUAL_DB;
        for _ in 0..2 {
            let [azimuth, elevation] = place;
            let [left, right] =
                [1.0, -1.0].map(|side| edge_deg(180.0, level, |aside| gain(azimuth + side * aside, elevation)));
            place[0] = azimuth + 0.5 * (left - right);
            let [up, down] = [1.0, -1.0].map(|side| {
                edge_deg(90.0 - side * elevation, level, |aside| gain(place[0], elevation + side * aside))
            });
            place[1] = elevation + 0.5 * (up - down);
        }
        if gain(place[0], place[1]) <= level {
            place = start;
        }
        let azimuth_deg = (place[0] + 180.0).rem_euclid(360.0) - 180.0;
        Self { sector, peak_dbi, azimuth_deg, elevation_deg: place[1] }
    }

    /// Half-power width in azimuth through the boresight (degrees).
    pub(super) fn azimuth_width_deg(&self, antenna: &Antenna) -> f64 {
        self.width_deg(180.0, |aside| {
            antenna.gain(self.sector, towards(self.azimuth_deg + aside, self.elevation_deg)).0
        })
    }

    /// Half-power width in elevation through the boresight (degrees).
    pub(super) fn elevation_width_deg(&self, antenna: &Antenna) -> f64 {
        self.width_deg(90.0, |aside| {
            antenna.gain(self.sector, towards(self.azimuth_deg, self.elevation_deg + aside)).0
        })
    }

    /// Between the first angles on both sides where the gain is half the greatest one, at most so far away.
    fn width_deg(&self, most_deg: f64, gain_dbi: impl Fn(f64) -> f64) -> f64 {
        let level = self.peak_dbi - HALF_POWER_DB;
        [1.0, -1.0].map(|side| edge_deg(most_deg, level, |aside| gain_dbi(side * aside))).iter().sum()
    }
}

/// The unit vector of a direction; an elevation beyond the vertical comes down on the other side.
fn towards(azimuth_deg: f64, elevation_deg: f64) -> Position {
    let (sa, ca) = libm::sincos(azimuth_deg.to_radians());
    let (se, ce) = libm::sincos(elevation_deg.to_radians());
    Position::new(ca * ce, sa * ce, se)
}

/// The top of the hill on which `place` is, and its height: a peak is between the degrees of a grid.
fn climbed(mut place: [f64; 2], gain: &impl Fn(f64, f64) -> f64) -> ([f64; 2], f64) {
    let mut height = gain(place[0], place[1]);
    let mut step_deg = 0.5;
    while step_deg > FINEST_DEG {
        let around = [[step_deg, 0.0], [-step_deg, 0.0], [0.0, step_deg], [0.0, -step_deg]];
        let higher = around.into_iter().find_map(|[east, north]| {
            let next = [place[0] + east, place[1] + north];
            let found = gain(next[0], next[1]);
            (next[1].abs() <= 90.0 && found > height + EQUAL_DB).then_some((next, found))
        });
        match higher {
            Some((next, found)) => (place, height) = (next, found),
            None => step_deg *= 0.5,
        }
    }
    (place, height)
}

/// The first angle where the gain is below `level`, found in steps and then by halving; at most `most_deg`.
fn edge_deg(most_deg: f64, level: f64, gain_dbi: impl Fn(f64) -> f64) -> f64 {
    let mut inside = 0.0;
    while inside < most_deg {
        let next = (inside + STEP_DEG).min(most_deg);
        if gain_dbi(next) < level {
            let mut ends = [inside, next];
            for _ in 0..30 {
                let middle = f64::midpoint(ends[0], ends[1]);
                ends[usize::from(gain_dbi(middle) < level)] = middle;
            }
            return ends[0];
        }
        inside = next;
    }
    most_deg
}
