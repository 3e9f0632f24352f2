//! The files that commands write: the flag `--force`, and the notes on what is replaced.

use std::path::Path;

use clap::Args;
use sextant::scenario::Scenario;
use sextant_logs::is_part_of_log;
use sextant_recording::admission::{OutputNote, Outputs, Replace};
use sextant_study::sweep::Sweep;

use super::options::Work;
use crate::diagnostic::Failure;
use crate::terminal::say;

/// What may be replaced.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Replacing {
    /// Replace files that are not earlier outputs of this command. An input is never replaced
    #[arg(long)]
    pub(crate) force: bool,
}

impl Replacing {
    pub(super) fn replace(self) -> Replace {
        if self.force { Replace::Any } else { Replace::Ours }
    }

    /// No file yet.
    pub(super) fn outputs<'a>(self) -> Outputs<'a> {
        Outputs::new(self.replace())
    }
}

/// Adds the files of a scenario to the inputs.
pub(super) fn reads_scenario(outputs: &mut Outputs<'_>, scenario: &Scenario) {
    scenario.sources().for_each(|path| {
        outputs.reads(path);
    });
}

/// Adds the files of the scenario of a sweep to the inputs.
pub(super) fn reads_sweep(outputs: &mut Outputs<'_>, sweep: &Sweep) {
    let named = sweep.named_files().iter().map(|file| file.path.as_path());
    sweep.file().layers().chain(named).for_each(|path| {
        outputs.reads(path);
    });
}

/// Adds files that flags name to the inputs, where they are given.
pub(super) fn reads_given<'p>(outputs: &mut Outputs<'_>, paths: impl IntoIterator<Item = Option<&'p Path>>) {
    paths.into_iter().flatten().for_each(|path| {
        outputs.reads(path);
    });
}

/// Refuses outputs that a later command would read as parts of the log in their folder, or that would keep it from being read.
/// Each has the name of its flag. `read` is a log that this command reads, if it reads one.
///
/// # Errors
/// The first such output.
pub(super) fn keep_logs<'p>(
    read: Option<&Path>,
    outputs: impl IntoIterator<Item = (&'p str, &'p Path)>,
) -> Result<(), Failure> {
    let Some((flag, path)) = outputs.into_iter().find(|(_, path)| is_part_of_log(path, read)) else { return Ok(()) };
    let output = if flag.is_empty() { path.display().to_string() } else { format!("{flag} {}", path.display()) };
    Err(Failure::bad_input_with_help(
        format!("`{output}` would be a part of the log in its folder"),
        "the parts of a log are known by their names: give the file another name, or put it into another folder",
    ))
}

/// Decides whether the command may write, and tells the user what it replaces, unless `work` is to be quiet.
///
/// # Errors
/// If it may not.
pub(super) fn admit(outputs: &Outputs<'_>, work: Option<Work>) -> Result<(), Failure> {
    for note in told(&outputs.admit()?) {
        match work {
            Some(work) => work.note(&note),
            None => say(&format!("note: {note}")),
        }
    }
    Ok(())
}

/// The notes in words. Of many files of one kind, the first is named.
fn told(notes: &[OutputNote]) -> Vec<String> {
    let is_alike = |a: &OutputNote, b: &OutputNote| match (a, b) {
        (OutputNote::Replaced { what: a, .. }, OutputNote::Replaced { what: b, .. }) => a == b,
        _ => false,
    };
    let groups = notes.chunk_by(is_alike).flat_map(|group| match group {
        [OutputNote::Replaced { path, what }, others @ ..] if others.len() > 1 => {
            let what = what.map_or(String::new(), |what| format!(": each is {what}"));
            vec![format!("`{}` and {} more files are replaced{what}", path.display(), others.len())]
        }
        few => few.iter().map(ToString::to_string).collect(),
    });
    groups.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_files_the_first_is_named() {
        let note = |name: &str, what| OutputNote::Replaced { path: name.into(), what };
        let picture = |name| note(name, Some("an earlier picture"));
        let words = told(&[picture("a"), picture("b"), picture("c"), note("d", None), picture("e")]);
        assert_eq!(
            words,
            [
                "`a` and 2 more files are replaced: each is an earlier picture",
                "`d` is replaced",
                "`e` is replaced: it is an earlier picture"
            ]
        );
    }
}
