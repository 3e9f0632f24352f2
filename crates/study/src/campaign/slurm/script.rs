//! The job script of a submission.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sextant_scenario::shell::{self, has_controls};

use super::super::error::CampaignError;
use super::settings::SlurmSettings;
use super::submission::CHUNKS;
use super::value::found;

/// The file of what a task of an array prints.
pub(super) const EACH_TASK: &str = "%A_%a.log";

/// What a script is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Script<'a> {
    /// Name of the job.
    pub(super) name: &'a str,
    /// What is printed goes to files in this folder, an absolute path.
    pub(super) folder: &'a ScriptFolder,
    pub(super) settings: &'a SlurmSettings,
    /// The name of such a file.
    pub(super) output: &'a str,
}

/// A folder that scripts can name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ScriptFolder(String);

impl ScriptFolder {
    /// The folder at the absolute path `folder`.
    ///
    /// # Errors
    /// If its path has characters that end a line or are not shown, or a backslash, which Slurm takes for something else in the
    /// names of files.
    pub(super) fn new(folder: &Path) -> Result<Self, CampaignError> {
        let what = "the path of the folder";
        line_word(what, folder.as_os_str())?;
        let path = folder.to_string_lossy().into_owned();
        if path.contains('\\') {
            let allowed = "a path without a backslash";
            return Err(CampaignError::NoScript { what, found: found(&path), allowed });
        }
        Ok(Self(path))
    }

    /// The folder of this number in it, which has no other letters.
    pub(super) fn numbered(&self, folder: &Path) -> Self {
        Self(format!("{}/{}", self.0, folder.file_name().unwrap_or_default().to_string_lossy()))
    }

    /// A file in it.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        Path::new(&self.0).join(name)
    }

    /// A file in it, as a word of a shell.
    fn word(&self, name: &str) -> String {
        shell::path(&self.file(name))
    }

    /// A file in it, whose name may have patterns of Slurm such as `%A`, for a line `#SBATCH`.
    fn pattern(&self, name: &str) -> String {
        sbatch_value(&format!("{}/{name}", self.0.replace('%', "%%")))
    }
}

impl Script<'_> {
    /// The script that does `work`.
    pub(super) fn text(&self, work: &str) -> String {
        let Self { name, folder, settings, output } = self;
        let mut text = String::from("#!/bin/sh\n");
        let mut option = |line: String| {
            // Writing to a text cannot fail.
            let _ = writeln!(text, "#SBATCH {line}");
        };
        option(format!("--job-name=sextant-{}", job_name(name)));
        option(format!("--output={}", folder.pattern(output)));
        option("--open-mode=append".to_owned());
        option("--requeue".to_owned());
        option(format!("--cpus-per-task={}", settings.cpus.map_or(1, std::num::NonZeroU32::get)));
        let values = [
            ("time", settings.time.as_ref().map(AsRef::as_ref)),
            ("partition", settings.partition.as_ref().map(AsRef::as_ref)),
            ("account", settings.account.as_ref().map(AsRef::as_ref)),
            ("mem", settings.memory.as_ref().map(AsRef::as_ref)),
        ];
        let values = values.into_iter().filter_map(|(name, value): (_, Option<&str>)| Some((name, Some(value?))));
        let others = settings.options.iter().map(|option| (option.name(), option.value()));
        for (name, value) in values.chain(others) {
            option(format!(
                "--{name}{}",
                value.map_or_else(String::new, |value| format!("={}", sbatch_value(value)))
            ));
        }
        text + "\n" + work
    }
}

/// The work of the tasks of an array: `sbatch --array=0-9 job.sh` does the first ten lines of the file `chunks`, each by the
/// command line `call`, where `$part` stands for the line.
pub(super) fn each_chunk(folder: &ScriptFolder, call: &str) -> String {
    format!(
        "# Each task of the array does one line A..B of the file `{CHUNKS}`: the numbers A to B - 1. It can be repeated: what is\n\
         # done is not done again. The first argument is the line of task 0, from 0.\n\
         line=$((${{1:-0}} + SLURM_ARRAY_TASK_ID + 1))\n\
         part=$(sed -n \"${{line}}p\" {})\n\
         # With `exec`, the signals of Slurm reach the program, which then keeps what is done.\n\
         exec {call}\n",
        folder.word(CHUNKS),
    )
}

/// The name of a job: letters that mean something else anywhere are replaced.
fn job_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "_.-".contains(c) { c } else { '_' };
    name.chars().map(plain).collect()
}

/// A value in a line `#SBATCH`, as `sbatch` reads it: a backslash stands before each letter that could mean something else.
fn sbatch_value(value: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:,=@%".contains(c);
    value.chars().flat_map(|c| (!is_plain(c)).then_some('\\').into_iter().chain([c])).collect()
}

/// The word of a command line in a script.
///
/// # Errors
/// If it has characters that end a line or are not shown. `what` says what it is.
pub(super) fn line_word(what: &'static str, word: &OsStr) -> Result<String, CampaignError> {
    match word.to_str() {
        Some(word) if !has_controls(word) => Ok(shell::word(word).into_owned()),
        _ => {
            let allowed = "Unicode on one line, without characters that are not shown";
            Err(CampaignError::NoScript { what, found: found(&word.to_string_lossy()), allowed })
        }
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use super::*;

    fn script(name: &str, folder: &str, settings: &SlurmSettings) -> String {
        let folder = ScriptFolder::new(Path::new(folder)).unwrap();
        let script = Script { name, folder: &folder, settings, output: EACH_TASK };
        script.text(&each_chunk(&folder, "sextant sweep '/home/me/my study' --cells \"$part\""))
    }

    #[test]
    fn the_script_can_be_read() {
        let settings = SlurmSettings {
            time: Some("1:00:00".parse().unwrap()),
            partition: Some("long".parse().unwrap()),
            cpus: NonZeroU32::new(4),
            options: vec!["--qos=low".parse().unwrap(), "--comment=it's #1".parse().unwrap()],
            ..SlurmSettings::default()
        };
        insta::assert_snapshot!(script("study", "/home/me/my study/slurm/000001", &settings));
    }

    #[test]
    fn no_name_ends_a_line_or_is_a_pattern_of_slurm() {
        let text = script("a\nb $(id)%j", "/%j/`id`", &SlurmSettings::default());
        assert!(text.contains("--job-name=sextant-a_b___id__j\n"), "{text}");
        assert!(text.contains("--output=/%%j/\\`id\\`/%A_%a.log\n"), "{text}");
        assert!(text.contains("'/%j/`id`/chunks')"), "{text}");
        for folder in ["/a\nb", "/a\rb", "/a\u{b}b", "/a\u{2028}b", "/a\u{85}b", "/a\u{202e}b", "/a\tb", "/a\\b"] {
            let error = ScriptFolder::new(Path::new(folder)).unwrap_err().to_string();
            assert!(!error.contains(folder) || folder.contains('\\'), "{error:?}");
            assert!(error.contains("allowed: "), "{error}");
        }
    }
}
