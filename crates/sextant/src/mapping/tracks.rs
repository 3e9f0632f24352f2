//! The pipeline of `map --track`: the tracks of moving tags among receivers at known places.

use std::collections::BTreeSet;
use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::{SimTime, Watch};
use sextant_logs::{self as robot_log, FormOptions, TagRanges, TrueNodes, read_tag_ranges, read_true_path};
use sextant_mapper::{PositionError, Track, TrackSettings, track};
use sextant_recording as recording;

use super::error::MapLogError;
use crate::summary::{ErrorSummary, Stopwatch, Summary, Timing, TrackSummary, peak_rss_bytes};

/// What a track is made from.
#[derive(Clone, Copy, Debug)]
pub struct TrackJob<'a> {
    /// The folder with `ranges.csv`, such a file, or a recording whose robots are the tags.
    pub log: &'a Path,
    /// Where receivers are, by name.
    pub known: &'a TrueNodes,
    /// How the log is written.
    pub form: &'a FormOptions,
    /// Height of the tags (m), if it is known.
    pub height_m: Option<f64>,
    /// The file with the true path, to compare with.
    pub truth: Option<&'a Path>,
}

/// The tracks of all tags in a log, with the results.
///
/// # Errors
/// If the log or the true path cannot be read, a tag has too few ranges, or `watch` ends the work.
pub fn tracks(
    job: &TrackJob<'_>,
    start: Stopwatch,
    watch: &dyn Watch,
) -> Result<(Summary, Vec<(String, Track)>), MapLogError> {
    let is_recording = job.log.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
    let ranges = if is_recording {
        let run = recording::read_log(job.log)?;
        TagRanges::of_log(job.log, run.log(), &job.known.places)?
    } else {
        read_tag_ranges(job.log, &job.known.places, job.form)?
    };
    let mut notes = ranges.notes;
    let truth = job.truth.map(|path| read_true_path(path, job.form, &mut notes)).transpose()?;
    let receivers: Vec<Position> = job.known.places.values().copied().collect();
    let (mut tracks, mut summaries) = (Vec::new(), Vec::new());
    for (tag, ranges) in ranges.tags {
        let found = track(&receivers, &ranges, TrackSettings { height_m: job.height_m }, watch)?;
        let heard: BTreeSet<usize> = ranges.iter().map(|range| range.receiver).collect();
        summaries.push(summary(&tag, &found, heard.len(), truth.as_ref()));
        tracks.push((tag, found));
    }
    let timing = Timing { wall_s: start.elapsed_s(), peak_rss_bytes: peak_rss_bytes(), ..Timing::default() };
    Ok((Summary { notes, tracks: summaries, timing: Some(timing), ..Summary::default() }, tracks))
}

fn summary(tag: &str, track: &Track, receivers: usize, truth: Option<&robot_log::Path>) -> TrackSummary {
    /// The 95 % quantile of the chi-squared distribution with two degrees of freedom.
    const REGION_95: f64 = 5.991;
    let poses = &track.poses;
    let span = |from: SimTime, to: SimTime| to.saturating_since(from).as_secs_f64();
    let mut errors_m = Vec::new();
    let mut held = 0.0;
    for pose in poses {
        let Some(place) = truth.and_then(|truth| truth.at(pose.time)) else { continue };
        let [x, y] = [pose.position.x_m - place.x_m, pose.position.y_m - place.y_m];
        errors_m.push(libm::hypot(x, y));
        let [[xx, xy], [_, yy]] = pose.covariance;
        let distance = (x * x * yy - 2.0 * x * y * xy + y * y * xx) / (xx * yy - xy * xy);
        held += if distance <= REGION_95 { 1.0 } else { 0.0 };
    }
    let count = errors_m.len() as f64;
    let squares: f64 = errors_m.iter().map(|error| error * error).sum();
    TrackSummary {
        tag: tag.to_owned(),
        poses: poses.len(),
        ranges: track.fit.ranges,
        receivers,
        duration_s: poses.first().zip(poses.last()).map_or(0.0, |(first, last)| span(first.time, last.time)),
        length_m: poses.windows(2).map(|pair| pair[0].position.distance_m(pair[1].position)).sum(),
        height_m: track.fit.height_m,
        is_among_receivers: track.fit.is_among_receivers,
        range_bias_m: track.fit.bias_m,
        range_scale: track.fit.scale,
        noise_m: track.fit.errors.noise_m(),
        worth: track.fit.worth,
        acceleration_m2_per_s3: track.fit.acceleration,
        settled: track.fit.settled,
        position_rmse_m: (count > 0.0).then(|| (squares / count).sqrt()),
        in_region_95: (count > 0.0).then(|| held / count),
        position_error_m: PositionError::of(&errors_m).map(ErrorSummary::from),
    }
}
