//! The track of a tag, and how it reads.

use std::io::{self, Write};

use serde::Serialize;

use super::map::ErrorSummary;

/// The track of a tag among receivers at known places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackSummary {
    /// Name of the tag.
    pub tag: String,
    /// Number of poses.
    pub poses: usize,
    /// Ranges that were used.
    pub ranges: usize,
    /// Receivers at known places of which it has ranges.
    pub receivers: usize,
    /// From the first to the last pose (s).
    pub duration_s: f64,
    /// Length of the track (m).
    pub length_m: f64,
    /// Height of the tag (m).
    pub height_m: f64,
    /// Whether most of the track is among the receivers: only then biases and scale of ranges are estimated freely.
    pub is_among_receivers: bool,
    /// By how much all ranges are too long (m).
    pub range_bias_m: f64,
    /// The share by which all ranges are too long.
    pub range_scale: f64,
    /// Standard deviation of the noise of ranges (m).
    pub noise_m: f64,
    /// How many independent ranges one is worth, at most 1.
    pub worth: f64,
    /// Power spectral density of the acceleration (m²/s³).
    pub acceleration_m2_per_s3: f64,
    /// Whether the search ended by itself.
    pub settled: bool,
    /// Distances between the track and the true path in the plane (m), if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error_m: Option<ErrorSummary>,
    /// Root of their mean square (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rmse_m: Option<f64>,
    /// Share of the poses whose 95 % region holds the true place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub in_region_95: Option<f64>,
}

/// Writes the tracks for people.
pub(super) fn write(tracks: &[TrackSummary], out: &mut impl Write) -> io::Result<()> {
    for track in tracks {
        writeln!(
            out,
            "{}: {} poses over {:.0} s and {:.0} m from {} ranges of {} receivers; noise {:.2} m, ranges {:.2} m and {:.1} % too long",
            track.tag,
            track.poses,
            track.duration_s,
            track.length_m,
            track.ranges,
            track.receivers,
            track.noise_m,
            track.range_bias_m,
            // Without a sign of zero.
            (1000.0 * track.range_scale).round() / 10.0 + 0.0,
        )?;
        if !track.is_among_receivers {
            writeln!(
                out,
                "{}: most of the track is beside the receivers, where a bias of ranges moves all of it: ranges are taken as calibrated",
                track.tag
            )?;
        }
        if !track.settled {
            writeln!(out, "{}: warning: the search did not settle, so the track is not reliable", track.tag)?;
        }
        if let (Some(error), Some(rmse_m)) = (&track.position_error_m, track.position_rmse_m) {
            write!(
                out,
                "{}: error mean {:.2} m, median {:.2} m, 95 % {:.2} m, root mean square {rmse_m:.2} m",
                track.tag, error.mean, error.median, error.p95
            )?;
            match track.in_region_95 {
                Some(share) => writeln!(out, "; {:.0} % within the 95 % regions", 100.0 * share)?,
                None => writeln!(out)?,
            }
        }
    }
    Ok(())
}
