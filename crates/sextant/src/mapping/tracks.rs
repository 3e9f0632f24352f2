//! The pipeline of `map --track`: the tracks of moving tags among receivers at known places.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::{SimTime, Watch};
use sextant_logs::{self as robot_log, ReadOptions, RobotLog, Source, TagReadings, TagTables};
use sextant_mapper::{
    DoubtedReceiver, PositionError, RangeFault, Track, TrackHeight, TrackMotion, TrackSettings, track,
};
use sextant_recording as recording;

use super::error::MapLogError;
use crate::summary::{
    DoubtedSummary, ErrorSummary, Stopwatch, Summary, Timing, TrackSummary, UnexplainedSummary, peak_rss_bytes,
};

/// What a track is made from.
#[derive(Clone, Copy, Debug)]
pub struct TrackJob<'a> {
    /// What was measured.
    pub source: TrackSource<'a>,
    /// Where receivers are, by name (m).
    pub known: &'a BTreeMap<String, Position>,
    /// How the log is written.
    pub options: &'a ReadOptions,
    /// What is known of the tags.
    pub settings: TrackSettings,
    /// The true path, to compare with.
    pub truth: Option<&'a robot_log::Path>,
}

/// Where the readings of tags are.
#[derive(Clone, Copy, Debug)]
pub enum TrackSource<'a> {
    /// A folder with `ranges.csv` or `packets.csv`, such a file, or the log or a recording of robots that stopped: each robot is a tag.
    File(&'a Path),
    /// Tables in memory.
    Tables(&'a TagTables<'a>),
    /// The log of robots that stopped, which was read.
    Log(&'a RobotLog),
}

impl TrackSource<'_> {
    fn readings(self, known: &BTreeMap<String, Position>, options: &ReadOptions) -> Result<TagReadings, MapLogError> {
        let path = match self {
            Self::Tables(tables) => return Ok(robot_log::read_tag_tables(tables, known, options)?),
            Self::Log(log) => return Ok(TagReadings::of_log(Path::new("the log"), &log.log, known)?),
            Self::File(path) => path,
        };
        let is_tables = matches!(Source::of(path), None | Some(Source::Tables));
        let is_recording = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
        if is_recording && Source::of(path).is_none() {
            robot_log::refuse_options(path, options)?;
            let run = recording::read_log(path)?;
            return Ok(TagReadings::of_log(path, run.log(), known)?);
        }
        if is_tables && robot_log::has_tag_readings(path) {
            return Ok(robot_log::read_tag_readings(path, known, options)?);
        }
        let read = robot_log::read(path, options)?;
        let mut found = TagReadings::of_log(path, &read.log, known)?;
        found.notes.splice(0..0, read.notes);
        Ok(found)
    }
}

/// The tracks of all tags in a log, with the results.
///
/// # Errors
/// If the log cannot be read, a tag has too few readings, or `watch` ends the work.
pub fn tracks(
    job: &TrackJob<'_>,
    start: Stopwatch,
    watch: &dyn Watch,
) -> Result<(Summary, Vec<(String, Track)>), MapLogError> {
    let TagReadings { tags, mut notes } = job.source.readings(job.known, job.options)?;
    let receivers: Vec<Position> = job.known.values().copied().collect();
    let (mut tracks, mut summaries) = (Vec::new(), Vec::new());
    for (tag, readings) in tags {
        let found = track(&receivers, &readings, job.settings, watch)?;
        let heard: BTreeSet<usize> = readings.iter().map(|reading| reading.receiver).collect();
        let name = |receiver: usize| job.known.keys().nth(receiver).cloned().unwrap_or_default();
        let doubted = found.doubted.iter().map(|&DoubtedReceiver { receiver, off_m, others_m }| DoubtedSummary {
            receiver: name(receiver),
            off_m,
            others_m,
        });
        let doubted = doubted.collect();
        let names = |receivers: &[usize]| receivers.iter().map(|&receiver| name(receiver)).collect::<Vec<_>>();
        let (mut unit, mut exchanged, mut unexplained) = (None, Vec::new(), None);
        let (mut unit_of_places, mut range_offset_m) = (None, None);
        match &found.fault {
            Some(RangeFault::Unit(other)) => unit = Some(other.name.to_owned()),
            Some(RangeFault::Places(other)) => unit_of_places = Some(other.name.to_owned()),
            Some(RangeFault::Offset { offset_m }) => range_offset_m = Some(*offset_m),
            Some(RangeFault::Exchanged(pairs)) => exchanged = pairs.iter().map(|pair| names(pair)).collect(),
            Some(RangeFault::Unexplained { usually_m, receivers }) => {
                unexplained = Some(UnexplainedSummary { usually_m: *usually_m, receivers: names(receivers) });
            }
            None => {}
        }
        summaries.push(TrackSummary {
            doubted,
            unit,
            unit_of_places,
            range_offset_m,
            exchanged,
            unexplained,
            ..summary(&tag, &found, heard.len(), job.truth)
        });
        tracks.push((tag, found));
    }
    notes.extend(job.truth.and_then(|truth| apart(truth, &tracks)));
    let timing = Timing { wall_s: start.elapsed_s(), peak_rss_bytes: peak_rss_bytes(), ..Timing::default() };
    Ok((Summary { notes, tracks: summaries, timing: Some(timing), ..Summary::default() }, tracks))
}

/// A note if no pose of a track is from the time of the true path, so that nothing can be compared.
fn apart(truth: &robot_log::Path, tracks: &[(String, Track)]) -> Option<String> {
    let times = || tracks.iter().flat_map(|(_, track)| &track.poses).map(|pose| pose.time);
    let (first, last) = (times().min()?, times().max()?);
    let seconds = |time: SimTime| time.saturating_since(SimTime::ZERO).as_secs_f64();
    let (from, to) = truth.span();
    (!times().any(|time| truth.at(time).is_some())).then(|| {
        format!(
            "the true path is not compared: it is from {:.1} s to {:.1} s, and the tracks are from {:.1} s to {:.1} s; both need \
             times of one clock",
            seconds(from),
            seconds(to),
            seconds(first),
            seconds(last)
        )
    })
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
    let fit = &track.fit;
    let (acceleration, odometry) = match fit.motion {
        TrackMotion::Free { acceleration } => (Some(acceleration), None),
        TrackMotion::Driven { scale, drift_rad_per_m } => (None, Some((scale, drift_rad_per_m))),
    };
    TrackSummary {
        tag: tag.to_owned(),
        poses: poses.len(),
        ranges: fit.ranges,
        strengths: fit.strengths,
        measured_ranges: fit.measured_ranges,
        measured_strengths: fit.measured_strengths,
        receivers,
        duration_s: poses.first().zip(poses.last()).map_or(0.0, |(first, last)| span(first.time, last.time)),
        // Adding 0 makes the -0 of a sum of nothing a 0.
        length_m: poses.windows(2).map(|pair| pair[0].position.distance_m(pair[1].position)).sum::<f64>() + 0.0,
        height_m: fit.height_m,
        height: match fit.height {
            TrackHeight::Given => "given",
            TrackHeight::OfReceivers => "of_receivers",
            TrackHeight::Constant { .. } => "constant",
            TrackHeight::Wandering => "over_time",
        },
        height_deviation_m: match fit.height {
            TrackHeight::Constant { deviation_m } => Some(deviation_m),
            TrackHeight::Given | TrackHeight::OfReceivers | TrackHeight::Wandering => None,
        },
        is_height_doubtful: fit.is_height_doubtful,
        heights_m: (fit.height == TrackHeight::Wandering).then(|| {
            let heights = || poses.iter().map(|pose| pose.position.z_m);
            [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)]
        }),
        is_among_receivers: fit.is_among_receivers,
        may_be_mirrored: fit.may_be_mirrored,
        range_bias_m: fit.of_ranges.map(|law| law.bias_m),
        range_scale: fit.of_ranges.map(|law| law.scale),
        noise_m: fit.of_ranges.map(|law| law.errors.noise_m()),
        worth: fit.of_ranges.map(|law| law.worth),
        at_1_m_dbm: fit.of_strengths.map(|law| law.at_1_m_dbm),
        path_loss_exponent: fit.of_strengths.map(|law| law.exponent),
        strength_error_db: fit.of_strengths.map(|law| law.width_db),
        strength_worth: fit.of_strengths.map(|law| law.worth),
        acceleration_m2_per_s3: acceleration,
        odometry_scale: odometry.map(|(scale, _)| scale),
        odometry_drift_rad_per_m: odometry.map(|(_, drift)| drift),
        settled: fit.settled,
        doubted: Vec::new(),
        unit: None,
        unit_of_places: None,
        range_offset_m: None,
        exchanged: Vec::new(),
        unexplained: None,
        is_beyond_prior: fit.of_ranges.is_some_and(|law| law.is_beyond_prior()),
        position_rmse_m: (count > 0.0).then(|| (squares / count).sqrt()),
        in_region_95: (count > 0.0).then(|| held / count),
        position_error_m: PositionError::of(&errors_m).map(ErrorSummary::from),
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::Unwatched;
    use sextant_logs::Pose;
    use sextant_mapper::TagReading;

    use super::*;

    fn at(second: u64) -> SimTime {
        SimTime::from_nanos(second * 1_000_000_000)
    }

    /// The notes on a tag that drives from 0 s to 19 s, with a true path that begins at a time (s).
    fn notes(truth_from: u64) -> Vec<String> {
        let receivers = [Position::new(0.0, 0.0, 0.0), Position::new(10.0, 0.0, 0.0), Position::new(0.0, 8.0, 0.0)];
        let reading = |second: u64| {
            let place = Position::new(1.0 + 0.3 * second as f64, 3.0, 0.0);
            let of = |(number, receiver): (usize, &Position)| {
                let error_m = 0.05 * libm::sin((7 * second + 3 * number as u64) as f64);
                TagReading::range(number, at(second), receiver.distance_m(place) + error_m)
            };
            receivers.iter().enumerate().map(of).collect::<Vec<_>>()
        };
        let readings: Vec<TagReading> = (0..20).flat_map(reading).collect();
        let found = track(&receivers, &readings, TrackSettings::default(), &Unwatched).unwrap();
        let pose = |second| Pose { time: at(second), position: receivers[0] };
        let truth = robot_log::Path::new(vec![pose(truth_from), pose(truth_from + 30)]).unwrap();
        apart(&truth, &[("tag".to_owned(), found)]).into_iter().collect()
    }

    #[test]
    fn a_tag_at_one_place_has_gone_0_m_and_not_less() {
        let receivers = [Position::new(0.0, 0.0, 0.0), Position::new(10.0, 0.0, 0.0), Position::new(0.0, 8.0, 0.0)];
        let readings: Vec<TagReading> = [5.0, 7.2, 5.1]
            .iter()
            .enumerate()
            .map(|(number, &range_m)| TagReading::range(number, at(1), range_m))
            .collect();
        let found = track(&receivers, &readings, TrackSettings::default(), &Unwatched).unwrap();
        assert_eq!(format!("{:.0}", summary("tag", &found, 3, None).length_m), "0");
    }

    #[test]
    fn a_true_path_of_another_time_is_told() {
        assert_eq!(notes(0), Vec::<String>::new());
        let found = notes(1000);
        assert!(
            found[0].contains("it is from 1000.0 s to 1030.0 s, and the tracks are from 0.0 s to 19.0 s"),
            "{found:?}"
        );
    }
}
