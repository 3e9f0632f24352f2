//! `sextant map --track`: the tracks of tags among receivers at known places.

use std::path::Path;

use super::Arguments;
use crate::commands::outputs::{admit, keep_logs};
use crate::commands::path_flags::Side;
use crate::commands::with_flags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::Watcher;
use sextant::mapping::{TrackJob, TrackSource, tracks};
use sextant::summary::Stopwatch;
use sextant_logs::{read_true_path, read_truth, write_tracks};
use sextant_mapper::TrackSettings;
use sextant_recording::admission::OutputKind;

pub(super) fn execute(arguments: &Arguments, known: &Path, interrupt: &Interrupt) -> Result<(), Failure> {
    let start = Stopwatch::start();
    let mut outputs = arguments.inputs();
    if let Some(out) = &arguments.out {
        outputs.writes("--out", out, OutputKind::Path);
    }
    arguments.results.among(&mut outputs);
    let named = [("--out", arguments.out.as_deref()), ("--summary", arguments.results.summary.as_deref())];
    keep_logs(Some(&arguments.log), named.into_iter().filter_map(|(flag, path)| Some((flag, path?))))?;
    admit(&outputs, Some(arguments.work))?;
    let options = arguments.reading.options();
    let mut notes = Vec::new();
    let known = read_truth(known, None, None, &mut notes)?;
    let height_m = arguments.path.antenna_height;
    if let Some(height_m) = height_m.filter(|height_m| !height_m.is_finite()) {
        let problem = format!("`--antenna-height` is {height_m}; allowed: a finite number of metres");
        return Err(Failure::bad_input_with_help(
            problem,
            "leave it out, and it is estimated where receivers have heights",
        ));
    }
    let path = &arguments.path;
    let truth = arguments.truth.as_deref().map(|truth| read_true_path(truth, &options, &mut notes)).transpose()?;
    let job = TrackJob {
        source: TrackSource::File(&arguments.log),
        known: &known.places,
        options: &options,
        settings: TrackSettings {
            height_m,
            side: path.side.map(|Side(place)| place),
            odometry: path.path_error.unwrap_or_default(),
        },
        truth: truth.as_ref(),
    };
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let (mut summary, tracks) = tracks(&job, start, &watcher)?;
    watcher.clear();
    summary.notes.splice(0..0, notes);
    summary.notes.iter_mut().for_each(|note| *note = with_flags(note));
    if let Some(out) = &arguments.out {
        write_tracks(out, &tracks)?;
    }
    for note in &summary.notes {
        arguments.work.note(note);
    }
    arguments.results.tell(&summary)
}
