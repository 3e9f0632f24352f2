//! The job script of a submission.

use std::fmt::Write as _;
use std::path::Path;

use super::settings::SlurmSettings;
use super::submission::CHUNKS;

/// The file of what a task of an array prints.
pub(super) const EACH_TASK: &str = "%A_%a.log";

/// What a script is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Script<'a> {
    /// Name of the job.
    pub(super) name: &'a str,
    /// What is printed goes to files in this folder, an absolute path.
    pub(super) folder: &'a Path,
    pub(super) settings: &'a SlurmSettings,
    /// The name of such a file.
    pub(super) output: &'a str,
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
        option(format!("--job-name={}", quoted(&format!("sextant-{name}"))));
        option(format!("--output={}", quoted(&folder.join(output).display().to_string())));
        option("--open-mode=append".to_owned());
        option("--requeue".to_owned());
        option(format!("--cpus-per-task={}", settings.cpus.map_or(1, std::num::NonZeroU32::get)));
        for (flag, value) in [
            ("time", &settings.time),
            ("partition", &settings.partition),
            ("account", &settings.account),
            ("mem", &settings.memory),
        ] {
            if let Some(value) = value {
                option(format!("--{flag}={}", quoted(value)));
            }
        }
        settings.options.iter().for_each(|line| option(line.clone()));
        text + "\n" + work
    }
}

/// The work of the tasks of an array: `sbatch --array=0-9 job.sh` does the first ten lines of the file `chunks`, each by the
/// command line `call`, where `$part` stands for the line.
pub(super) fn each_chunk(chunks: &Path, call: &str) -> String {
    format!(
        "# Each task of the array does one line A..B of the file `{CHUNKS}`: the numbers A to B - 1. It can be repeated: what is\n\
         # done is not done again. The first argument is the line of task 0, from 0.\n\
         line=$((${{1:-0}} + SLURM_ARRAY_TASK_ID + 1))\n\
         part=$(sed -n \"${{line}}p\" {})\n\
         # With `exec`, the signals of Slurm reach the program, which then keeps what is done.\n\
         exec {call}\n",
        quoted(&chunks.display().to_string()),
    )
}

/// A word of a shell, with quotes only where it needs them.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,=@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use super::*;

    #[test]
    fn the_script_can_be_read() {
        let settings = SlurmSettings {
            time: Some("1:00:00".to_owned()),
            partition: Some("long".to_owned()),
            cpus: NonZeroU32::new(4),
            options: vec!["--qos=low".to_owned()],
            ..SlurmSettings::default()
        };
        let folder = Path::new("/home/me/my study/slurm/000001");
        let script = Script { name: "study", folder, settings: &settings, output: EACH_TASK };
        let work = each_chunk(&folder.join(CHUNKS), "sextant sweep '/home/me/my study' --cells \"$part\"");
        insta::assert_snapshot!(script.text(&work));
    }

    #[test]
    fn words_are_quoted_where_a_shell_would_read_more_than_a_word() {
        assert_eq!(quoted("/a/b-1.sh"), "/a/b-1.sh");
        assert_eq!(quoted("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
