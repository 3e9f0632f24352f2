//! The track of a tag, and how it reads.

use std::io::{self, Write};

use serde::Serialize;
use sextant_kernel::text::listed;

use super::map::ErrorSummary;

/// The track of a tag among receivers at known places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackSummary {
    /// Name of the tag.
    pub tag: String,
    /// Number of poses.
    pub poses: usize,
    /// Ranges that were used: of those of one receiver in a quarter of a second, the median.
    pub ranges: usize,
    /// Strengths that were used, alike.
    pub strengths: usize,
    /// Ranges of which these are the medians.
    pub measured_ranges: usize,
    /// Strengths of which these are the medians.
    pub measured_strengths: usize,
    /// Receivers at known places of which it has any.
    pub receivers: usize,
    /// From the first to the last pose (s).
    pub duration_s: f64,
    /// Length of the track (m).
    pub length_m: f64,
    /// Mean height of the tag (m).
    pub height_m: f64,
    /// How it is known: `given`, `of_receivers` (all receivers are on one level, and the tag is taken to be there), `constant` or
    /// `over_time` (estimated).
    pub height: &'static str,
    /// Standard deviation of a height that is constant and estimated (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_deviation_m: Option<f64>,
    /// The lowest and the highest height that was estimated over time (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights_m: Option<[f64; 2]>,
    /// Whether the height is so far from those of the receivers that it rather stands for another error.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_height_doubtful: bool,
    /// Whether most of the track is among the receivers: only then biases and scale of ranges are estimated freely.
    pub is_among_receivers: bool,
    /// Whether the receivers are on a line, and nothing says on which side of it the tag is.
    pub may_be_mirrored: bool,
    /// By how much all ranges are too long (m), if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_bias_m: Option<f64>,
    /// The share by which all ranges are too long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_scale: Option<f64>,
    /// Standard deviation of the noise of the medians of ranges (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_m: Option<f64>,
    /// How many independent ranges one is worth, at most 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worth: Option<f64>,
    /// The strength at a metre (dBm), if there are strengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_1_m_dbm: Option<f64>,
    /// The exponent of the path loss.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_loss_exponent: Option<f64>,
    /// The width of the law of errors of strengths (dB).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_error_db: Option<f64>,
    /// How many independent strengths one is worth, at most 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_worth: Option<f64>,
    /// Power spectral density of the acceleration (m²/s³), without odometry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_m2_per_s3: Option<f64>,
    /// The share by which the way is longer than odometry has it, if there is odometry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub odometry_scale: Option<f64>,
    /// How much the frame of odometry turns (rad/m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub odometry_drift_rad_per_m: Option<f64>,
    /// Whether the search ended by itself.
    pub settled: bool,
    /// Receivers whose ranges fit the track clearly worse than those of the others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubted: Vec<DoubtedSummary>,
    /// The unit in which the ranges fit clearly better than as metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The unit of the known places with which the ranges fit clearly better.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_of_places: Option<String>,
    /// By how much all ranges are too long if that makes them fit clearly better (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_offset_m: Option<f64>,
    /// Receivers in each other's place: the pair with which the ranges fit clearly better, and others that fit about as well.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub exchanged: Vec<Vec<String>>,
    /// Errors of ranges that are too large, and that nothing explains.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unexplained: Option<UnexplainedSummary>,
    /// Whether bias or scale of the ranges is far beyond what devices have.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_beyond_prior: bool,
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

/// A receiver whose ranges fit the track clearly worse than those of the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoubtedSummary {
    /// Its name.
    pub receiver: String,
    /// By how much its ranges are usually off (m).
    pub off_m: f64,
    /// By how much those of the usual receiver are (m).
    pub others_m: f64,
}

/// Errors of ranges that are too large, and that nothing explains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnexplainedSummary {
    /// By how much the ranges are usually off (m).
    pub usually_m: f64,
    /// The receivers whose ranges disagree most with the rest.
    pub receivers: Vec<String>,
}

/// Writes the tracks for people.
pub(super) fn write(tracks: &[TrackSummary], out: &mut impl Write) -> io::Result<()> {
    for track in tracks {
        write!(
            out,
            "{}: {} poses over {:.0} s and {:.0} m from ",
            track.tag, track.poses, track.duration_s, track.length_m
        )?;
        let counts = [
            (track.ranges, track.measured_ranges, "ranges"),
            (track.strengths, track.measured_strengths, "strengths"),
        ];
        let told = |(used, measured, noun): (usize, usize, &str)| {
            if used == measured { format!("{used} {noun}") } else { format!("{used} medians of {measured} {noun}") }
        };
        let counts: Vec<String> = counts.into_iter().filter(|(used, ..)| *used > 0).map(told).collect();
        write!(out, "{} of {} receivers", counts.join(" and "), track.receivers)?;
        if let (Some(noise_m), Some(bias_m), Some(scale)) = (track.noise_m, track.range_bias_m, track.range_scale) {
            // Without a sign of zero.
            let longer = (1000.0 * scale).round() / 10.0 + 0.0;
            write!(out, "; noise {noise_m:.2} m, ranges {bias_m:.2} m and {longer:.1} % too long")?;
        }
        if let (Some(at_1_m_dbm), Some(exponent), Some(error_db)) =
            (track.at_1_m_dbm, track.path_loss_exponent, track.strength_error_db)
        {
            write!(out, "; strengths {at_1_m_dbm:.0} dBm at 1 m, exponent {exponent:.1}, errors {error_db:.1} dB")?;
        }
        if let (Some(scale), Some(drift)) = (track.odometry_scale, track.odometry_drift_rad_per_m) {
            let rounded = |value: f64, digits: f64| (value * digits).round() / digits + 0.0;
            let (short, drift) = (rounded(100.0 * scale, 10.0), rounded(drift, 1e4));
            write!(out, "; odometry {short:.1} % short, drift {drift:.4} rad/m")?;
        }
        writeln!(out)?;
        if !track.is_among_receivers && track.ranges > 0 && track.height != "over_time" {
            writeln!(
                out,
                "{}: most of the track is beside the receivers, where a bias of ranges moves all of it: ranges are taken as calibrated",
                track.tag
            )?;
        }
        let wrote_height = match track.height {
            "of_receivers" => Some(format!(
                "all receivers are on one level, and the tag is assumed to be there (z = {:.2} m): a height of the antenna says \
                 otherwise",
                track.height_m
            )),
            "constant" => track.height_deviation_m.map(|deviation_m| {
                format!("one height is assumed for the whole track: {:.2} ± {deviation_m:.2} m", track.height_m)
            }),
            "over_time" => track
                .heights_m
                .map(|[low, high]| format!("the height is estimated over time, from {low:.2} m to {high:.2} m; ranges are taken as calibrated, and receivers \
                     nearly in one plane do not tell on which side of it the tag is")),
            _ => None,
        };
        if let Some(told) = wrote_height {
            writeln!(out, "{}: {told}", track.tag)?;
        }
        if track.is_height_doubtful {
            writeln!(
                out,
                "{}: warning: this height is far from those of the receivers, so it rather stands for another error; give the \
                 height of the antenna",
                track.tag
            )?;
        }
        if track.may_be_mirrored {
            writeln!(
                out,
                "{}: the receivers are on a line, so the mirror image of the track is as good; a side says which it is",
                track.tag
            )?;
        }
        if let Some(unit) = &track.unit {
            writeln!(
                out,
                "{}: warning: the ranges fit clearly better as {unit} than as metres, so the track is not reliable",
                track.tag
            )?;
        } else if let Some(unit) = &track.unit_of_places {
            writeln!(
                out,
                "{}: warning: the ranges fit clearly better if the known places are in {unit}, so the track is not reliable",
                track.tag
            )?;
        } else if let Some(offset_m) = track.range_offset_m {
            writeln!(
                out,
                "{}: warning: the ranges fit clearly better if all are {offset_m:.1} m too long, as with a delay of antennas: subtract \
                 that; the track is not reliable",
                track.tag
            )?;
        } else if !track.exchanged.is_empty() {
            let pairs: Vec<String> =
                track.exchanged.iter().map(|pair| format!("`{}`", pair.join("` and `"))).collect();
            writeln!(
                out,
                "{}: warning: the ranges fit clearly better with {} in each other's place: their names or known places may be \
                 exchanged; the track is not reliable",
                track.tag,
                pairs.join(", or ")
            )?;
        } else if track.is_beyond_prior {
            writeln!(
                out,
                "{}: warning: such a bias or scale is far beyond what devices have: check units, receivers and height; the track is \
                 not reliable",
                track.tag
            )?;
        }
        if let Some(UnexplainedSummary { usually_m, receivers }) = &track.unexplained {
            let most = match receivers.as_slice() {
                [] => String::new(),
                receivers => format!("; those of {} disagree most with the rest", listed(receivers)),
            };
            writeln!(
                out,
                "{}: warning: the ranges are usually {usually_m:.2} m off, and no other unit, offset or exchange of two \
                 receivers that was tried explains it{most}: check names and known places; the track is not reliable",
                track.tag
            )?;
        }
        let is_exchanged = |receiver: &String| track.exchanged.iter().flatten().any(|name| name == receiver);
        let doubted = track.doubted.iter().filter(|doubted| !is_exchanged(&doubted.receiver));
        for DoubtedSummary { receiver, off_m, others_m } in doubted {
            writeln!(
                out,
                "{}: warning: the ranges of `{receiver}` are usually {off_m:.2} m off, those of the others {others_m:.2} m: its known \
                 place or its name may be wrong, or something stands before it",
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
