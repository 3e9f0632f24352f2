//! The job script of a submission.

use std::fmt::Write as _;
use std::path::Path;

use super::settings::SlurmSettings;
use super::submission::CHUNKS;

/// What the script is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Script<'a> {
    /// Name of the plan.
    pub(super) name: &'a str,
    /// Folder of the plan, as an absolute path.
    pub(super) plan: &'a Path,
    /// Folder of the submission, as an absolute path.
    pub(super) folder: &'a Path,
    /// The program.
    pub(super) program: &'a Path,
    pub(super) settings: &'a SlurmSettings,
}

impl Script<'_> {
    /// The script. `sbatch --array=0-9 job.sh` does the first ten lines of the file of chunks.
    pub(super) fn text(&self) -> String {
        let Self { name, plan, folder, program, settings } = self;
        let mut text = String::from("#!/bin/sh\n");
        let output = folder.join("%A_%a.log");
        let mut option = |line: String| {
            // Writing to a text cannot fail.
            let _ = writeln!(text, "#SBATCH {line}");
        };
        option(format!("--job-name={}", quoted(&format!("sextant-{name}"))));
        option(format!("--output={}", quoted(&output.display().to_string())));
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
        let _ = write!(
            text,
            "\n\
             # Each task of the array does one line of the file `{CHUNKS}`: the runs A to B - 1 of the work list. It can be\n\
             # repeated: what is done is not done again. The first argument is the line of task 0, from 0.\n\
             plan={}\n\
             chunks={}\n\
             line=$((${{1:-0}} + SLURM_ARRAY_TASK_ID + 1))\n\
             runs=$(sed -n \"${{line}}p\" \"$chunks\")\n\
             # With `exec`, the signals of Slurm reach the program, which then keeps what is done.\n\
             exec {} sweep \"$plan\" --cells \"$runs\" --threads \"$SLURM_CPUS_PER_TASK\" --quiet\n",
            quoted(&plan.display().to_string()),
            quoted(&folder.join(CHUNKS).display().to_string()),
            quoted(&program.display().to_string()),
        );
        text
    }
}

/// A word of a shell, with quotes only where it needs them.
fn quoted(word: &str) -> String {
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
        let script = Script {
            name: "study",
            plan: Path::new("/home/me/my study"),
            folder: Path::new("/home/me/my study/slurm/000001"),
            program: Path::new("/home/me/bin/sextant"),
            settings: &settings,
        };
        insta::assert_snapshot!(script.text());
    }

    #[test]
    fn words_are_quoted_where_a_shell_would_read_more_than_a_word() {
        assert_eq!(quoted("/a/b-1.sh"), "/a/b-1.sh");
        assert_eq!(quoted("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
