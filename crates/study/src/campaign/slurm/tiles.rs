//! A map tile by tile on a cluster: an array makes the tiles, and a job that waits for it joins them.

use std::ffi::OsString;
use std::io;
use std::path::Path;

use sextant::NumberRange;
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::OutputError;

use super::super::error::CampaignError;
use super::script::{EACH_TASK, Script, ScriptFolder, each_chunk, line_word};
use super::settings::{Chunk, SlurmSettings};
use super::value::JobId;
use super::{FOLDER, scheduler, submission, submit_chunks};

/// The script that joins the tiles.
const JOIN: &str = "join.sh";

/// The jobs of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubmittedMap {
    /// Those that make the tiles.
    pub tiles: Vec<JobId>,
    /// Number of their tasks.
    pub tasks: usize,
    /// The one that joins them.
    pub join: JobId,
}

/// Submits a map in so many `tiles`, which are kept in `folder`: an array whose tasks call `program` with `words` and
/// `--only-tiles`, and a job that calls it with `words` alone once all tasks have ended. That one makes the tiles that are
/// missing by then, and writes the map.
///
/// # Errors
/// If a file cannot be written, or Slurm refuses.
pub fn submit_map(
    program: &Path,
    words: &[OsString],
    folder: &Path,
    tiles: usize,
    settings: &SlurmSettings,
) -> Result<SubmittedMap, CampaignError> {
    let unreadable = |error: io::Error| CampaignError::unreadable(folder, &error);
    let kept = std::path::absolute(folder).map_err(unreadable)?;
    let all = kept.join(FOLDER);
    let program = line_word("the path of this program", program.as_os_str())?;
    let words = words.iter().map(|word| line_word("a word of the command", word)).collect::<Result<Vec<_>, _>>()?;
    let of_scripts = ScriptFolder::new(&all)?;
    let count = match ForeignFolder::new(&kept).entries(&all) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => 0,
        entries => entries.map_err(unreadable)?.len(),
    };
    let own = submission::claim(&all, count + 1)?;
    let runs = match settings.chunk {
        Some(Chunk::Runs(tiles)) => tiles.get(),
        Some(Chunk::Auto) | None => 1,
    };
    let chunk = |start: usize| NumberRange { start, end: start.saturating_add(runs).min(tiles) };
    let chunks: Vec<NumberRange> = (0..tiles).step_by(runs).map(chunk).collect();
    submission::write_chunks(&own, &chunks)?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (flags, names) = words.split_at(words.iter().position(|word| word == "--").unwrap_or(words.len()));
    let call = |tiles: &str| {
        let own = ["--threads \"$SLURM_CPUS_PER_TASK\" --quiet", tiles].map(str::to_owned);
        let words = [std::slice::from_ref(&program), flags, &own, names].concat();
        words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let scripts = of_scripts.numbered(&own);
    let of_tiles = Script { name: &format!("{name}-tiles"), folder: &scripts, settings, output: EACH_TASK };
    let path = own.join(submission::SCRIPT);
    let work = each_chunk(&scripts, &call("--only-tiles \"$part\""));
    submission::write_script(&path, &of_tiles.text(&work))?;
    let of_join = Script { name: &format!("{name}-join"), folder: &scripts, settings, output: "%j.log" };
    let join = own.join(JOIN);
    let work =
        format!("# The tiles that are there are joined; any that are missing are made first.\nexec {}\n", call(""));
    submission::write_script(&join, &of_join.text(&work))?;
    let (arrays, refused) = submit_chunks(&path, chunks.len(), settings, scheduler::greatest_array());
    if let (true, Some(error)) = (arrays.is_empty(), refused) {
        disk::remove_folder(&own).map_err(|error| OutputError::new(&own, &error))?;
        return Err(error);
    }
    let jobs: Vec<JobId> = arrays.iter().map(|array| array.job.clone()).collect();
    let tasks = arrays.iter().map(|array| array.tasks).sum();
    match scheduler::submit_after(&join, &jobs) {
        Ok(join) => Ok(SubmittedMap { tiles: jobs, tasks, join }),
        Err(error) => {
            // Tiles that nobody joins are not asked for. The first error is the one that is told.
            let _ = scheduler::cancel(&jobs);
            Err(error)
        }
    }
}
