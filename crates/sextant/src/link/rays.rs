//! The rays of a link as numbers, for people and for programs.

use std::fmt::{self, Formatter, Write as _};

use serde::Serialize;
use sextant_channel::{PathBudget, Ray, angles_rad};

/// One way of a signal from the first end of a link to the second one. On the way back departure and arrival change places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RayReport {
    /// Gain along it, without the antennas (dB); `None` if nothing gets through.
    pub gain_db: Option<f64>,
    /// How long a signal takes (s).
    pub delay_s: f64,
    /// Azimuth, counterclockwise from x, and elevation in which it leaves the first end (rad).
    pub departure_rad: [f64; 2],
    /// Azimuth and elevation in which the second end sees it (rad).
    pub arrival_rad: [f64; 2],
    /// Phase of the field at the second end, at the carrier of the channel, or of the radios if it has none (rad).
    pub phase_rad: f64,
    /// Number of reflections.
    pub bounces: u8,
    /// Whether it bends round an edge.
    pub diffracted: bool,
}

impl From<&Ray> for RayReport {
    fn from(ray: &Ray) -> Self {
        Self {
            gain_db: Some(-ray.loss.0).filter(|gain_db| gain_db.is_finite()),
            delay_s: ray.delay_s(),
            departure_rad: angles_rad(ray.departure),
            arrival_rad: angles_rad(ray.arrival),
            phase_rad: ray.phase_rad,
            bounces: ray.bounces,
            diffracted: ray.is_diffracted,
        }
    }
}

/// The rays of a path, and the gain of the sum of their fields (dB), if it is finite.
pub(super) fn rays_of(path: &PathBudget) -> (Vec<RayReport>, Option<f64>) {
    let rays = path.rays();
    let field_db = Ray::field_sum(&rays).0;
    (rays.iter().map(RayReport::from).collect(), Some(field_db).filter(|db| db.is_finite()))
}

/// Rays as comma-separated values, with a line of the names of the columns.
#[must_use]
pub fn rays_csv(rays: &[RayReport]) -> String {
    let mut csv = String::from(
        "ray,gain_db,delay_s,departure_azimuth_rad,departure_elevation_rad,arrival_azimuth_rad,arrival_elevation_rad,\
         phase_rad,bounces,diffracted\n",
    );
    for (number, ray) in rays.iter().enumerate() {
        let RayReport { delay_s, departure_rad, arrival_rad, phase_rad, bounces, diffracted, .. } = ray;
        let gain_db = ray.gain_db.unwrap_or(f64::NEG_INFINITY);
        let ([from_az, from_el], [to_az, to_el]) = (departure_rad, arrival_rad);
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "{number},{gain_db},{delay_s:e},{from_az},{from_el},{to_az},{to_el},{phase_rad},{bounces},{diffracted}"
        );
    }
    csv
}

/// Writes rays as a table.
pub(super) fn write_table(f: &mut Formatter<'_>, rays: &[RayReport], field_gain_db: Option<f64>) -> fmt::Result {
    writeln!(
        f,
        "{:<12} {:>10} {:>10} {:>17} {:>17} {:>7}",
        "ray", "gain", "delay", "departs", "arrives from", "phase"
    )?;
    for ray in rays {
        let name = match (ray.diffracted, ray.bounces) {
            (true, _) => "edge",
            (false, 0) => "straight",
            (false, 1) => "1 reflection",
            (false, _) => "2 reflections",
        };
        let gain = ray.gain_db.map_or("nothing".to_owned(), |gain_db| format!("{gain_db:.2} dB"));
        let angles = |[azimuth, elevation]: [f64; 2]| {
            format!("{:.1}\u{b0}, {:.1}\u{b0}", azimuth.to_degrees() + 0.0, elevation.to_degrees() + 0.0)
        };
        let delay = format!("{:.2} ns", ray.delay_s * 1e9);
        let (departs, arrives) = (angles(ray.departure_rad), angles(ray.arrival_rad));
        let phase = format!("{:.0}\u{b0}", ray.phase_rad.to_degrees());
        writeln!(f, "{name:<12} {gain:>10} {delay:>10} {departs:>17} {arrives:>17} {phase:>7}")?;
    }
    if let Some(gain_db) = field_gain_db {
        writeln!(
            f,
            "The sum of their fields has a gain of {gain_db:.2} dB; the power above is the sum of their powers."
        )?;
    }
    writeln!(f)
}
