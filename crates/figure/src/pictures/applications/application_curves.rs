//! What an application came to over time: errors, distances, the field.

use plotters::style::RGBColor;
use sextant_kernel::SimTime;

use sextant_recording::RecordedApplication;

use crate::paint::palette::{INK, of_robot};
use crate::paint::picture::Picture;
use crate::pictures::source::Source;
use crate::plot::curves::{Curves, Series};

/// Largest number of points of a curve: a longer one is thinned out.
const MOST: usize = 150;

/// The curves of an application, each with the end of the name of its figure: `prediction-error`, `distance` and
/// `own-place-error` if it searches targets or knows its place, `value` if it seeks the source of a field.
pub(crate) fn draw(source: &Source<'_>, application: &RecordedApplication) -> Vec<(&'static str, Picture)> {
    let plot = |what: &str, up: &str, lines: Vec<Line>| {
        let across = "time [s]".to_owned();
        let title = format!("{}: {}, {what}", source.title, application.name);
        let note = format!("{} on the map {}", application.algorithm, application.map);
        let (series, colors): (Vec<Series>, Vec<RGBColor>) = lines.into_iter().unzip();
        Curves { title, note, across, up: up.to_owned(), series }.draw_in(&colors)
    };
    let of = |what: &str| series(source, application, what, "");
    let mut figures = Vec::new();
    for (figure, what, up, found) in [
        ("prediction-error", "prediction of targets", "error [m]", of("prediction_error_m")),
        ("distance", "nearest target", "distance [m]", of("distance_to_target_m")),
        ("own-place-error", "own place", "error [m]", of("map_error_m")),
        ("value", "value of the field", "value", values(source, application)),
    ] {
        if !found.is_empty() {
            figures.push((figure, plot(what, up, found)));
        }
    }
    figures
}

/// A curve and its colour.
type Line = (Series, RGBColor);

/// What robots worked out, what is true there, and the level that they seek.
fn values(source: &Source<'_>, application: &RecordedApplication) -> Vec<Line> {
    let mut found = series(source, application, "field_truth", ", true");
    found.extend(series(source, application, "field_estimate", ", estimate"));
    let times = || found.iter().flat_map(|(series, _)| &series.points).map(|point| point.0);
    if let (Some(level), Some(last)) = (application.level, times().max_by(f64::total_cmp)) {
        let points = vec![(0.0, level), (last, level)];
        found.push((Series { name: "level".to_owned(), points, intervals: Vec::new() }, INK));
    }
    found
}

/// One curve for each station with such a time series. A robot has its colour of all figures, and another station one that
/// no robot here has.
fn series(source: &Source<'_>, application: &RecordedApplication, what: &str, note: &str) -> Vec<Line> {
    let seconds = |time: SimTime| (time - application.start).as_secs_f64();
    let curve = |(station, points): (&str, &[(SimTime, f64)])| Series {
        name: format!("{station}{note}"),
        points: thinned(points).map(|(time, value)| (seconds(time), value)).collect(),
        intervals: Vec::new(),
    };
    let mut others = application.paths.len()..;
    let mut color = |station: &str| of_robot(source.robot(station).or_else(|| others.next()).unwrap_or(0));
    application.series_of(what).map(|of| (curve(of), color(of.0))).collect()
}

/// At most [`MOST`] points, the first and the last one among them.
fn thinned(points: &[(SimTime, f64)]) -> impl Iterator<Item = (SimTime, f64)> {
    let step = points.len().div_ceil(MOST).max(1);
    let last = points.len().checked_sub(1);
    let is_chosen = move |i: usize| i.is_multiple_of(step) || Some(i) == last;
    points.iter().enumerate().filter(move |(i, _)| is_chosen(*i)).map(|(_, &point)| point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_are_thinned_out_and_keep_their_ends() {
        let points: Vec<_> = (0..1000_u16).map(|i| (SimTime::from_nanos(u64::from(i)), f64::from(i))).collect();
        let kept: Vec<f64> = thinned(&points).map(|point| point.1).collect();
        assert!(kept.len() <= MOST + 1, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (Some(&0.0), Some(&999.0)));
        assert_eq!(thinned(&points[..7]).count(), 7);
        assert_eq!(thinned(&[]).count(), 0);
    }
}
