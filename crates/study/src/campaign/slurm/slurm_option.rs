//! Other options of `sbatch`.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use sextant_scenario::shell::has_controls;

/// An option of `sbatch`: `--name`, or `--name=value` with a value on one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlurmOption {
    name: String,
    value: Option<String>,
}

/// Options that say where, when and with how much a job runs, and nothing else. Others may run a command, change the
/// environment of a job, write files elsewhere or send letters: these are taken from the user alone.
const OF_RESOURCES: [&str; 32] = [
    "begin",
    "cluster-constraint",
    "comment",
    "constraint",
    "cores-per-socket",
    "deadline",
    "delay-boot",
    "exclude",
    "exclusive",
    "gpus",
    "gpus-per-node",
    "gpus-per-task",
    "gres",
    "hint",
    "licenses",
    "mem-per-cpu",
    "mem-per-gpu",
    "mincpus",
    "nice",
    "no-requeue",
    "nodelist",
    "nodes",
    "prefer",
    "priority",
    "qos",
    "reservation",
    "signal",
    "sockets-per-node",
    "switches",
    "threads-per-core",
    "time-min",
    "tmp",
];

/// Longest text of an option (octets).
const LONGEST: usize = 1000;

impl SlurmOption {
    /// The options, in words.
    pub(super) const ALLOWED: &'static str =
        "--name or --name=value on one line, with small letters, digits and `-` in the name";

    /// Whether it may come from a file that somebody else may have written.
    pub(super) fn is_of_resources(&self) -> bool {
        OF_RESOURCES.contains(&self.name.as_str())
    }

    /// What may come from a file, in words.
    pub(super) fn of_resources() -> String {
        OF_RESOURCES.map(|name| format!("--{name}")).join(", ")
    }

    /// Its name, without the dashes.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Its value, if it has one.
    pub(super) fn value(&self) -> Option<&str> {
        self.value.as_deref()
    }
}

impl FromStr for SlurmOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let invalid = || format!("allowed: {}", Self::ALLOWED);
        let rest = text.strip_prefix("--").ok_or_else(invalid)?;
        let (name, value) = match rest.split_once('=') {
            Some((name, value)) => (name, Some(value)),
            None => (rest, None),
        };
        let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let is_name = name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(is_letter);
        let is_value = value.is_none_or(|value| !value.is_empty() && !has_controls(value));
        if is_name && is_value && text.len() <= LONGEST {
            Ok(Self { name: name.to_owned(), value: value.map(str::to_owned) })
        } else {
            Err(invalid())
        }
    }
}

impl fmt::Display for SlurmOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--{}", self.name)?;
        self.value.iter().try_for_each(|value| write!(f, "={value}"))
    }
}

impl Serialize for SlurmOption {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_option_is_one_word_on_one_line() {
        for text in ["--qos=long", "--exclusive", "--gres=gpu:2", "--comment=my study"] {
            let option: SlurmOption = text.parse().unwrap();
            assert_eq!(option.to_string(), text);
            assert!(option.is_of_resources(), "{text}");
        }
        let long = format!("--qos={}", "a".repeat(1000));
        for text in [
            "",
            "qos=long",
            "-q",
            "--",
            "--=a",
            "--qos=",
            "--Qos=a",
            "--qos=a\nid",
            "--qos=a\r",
            "--a b",
            "--qos=\u{2028}",
            "---x",
            &long,
        ] {
            assert!(text.parse::<SlurmOption>().is_err(), "{text:?}");
        }
    }

    #[test]
    fn options_that_run_or_write_something_are_not_of_resources() {
        for name in [
            "wrap",
            "export",
            "export-file",
            "chdir",
            "output",
            "error",
            "input",
            "mail-user",
            "mail-type",
            "get-user-env",
            "dependency",
            "array",
            "uid",
            "gid",
            "bb",
            "bbf",
            "container",
            "network",
            "propagate",
            "prolog",
            "task-prolog",
            "clusters",
            "open-mode",
            "kill-on-invalid-dep",
            "job-name",
            "test-only",
            "parsable",
            "wait",
            "wra",
            "qo",
        ] {
            assert!(!format!("--{name}=a").parse::<SlurmOption>().unwrap().is_of_resources(), "{name}");
        }
    }
}
