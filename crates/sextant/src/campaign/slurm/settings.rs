//! What a submission asks of Slurm.

use std::num::{NonZeroU32, NonZeroUsize};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What a submission asks of Slurm. What is absent is left to the cluster.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlurmSettings {
    /// Runs of a task; automatic if absent.
    pub chunk: Option<Chunk>,
    /// Time limit of a task, as `sbatch --time` takes it.
    pub time: Option<String>,
    /// The partition.
    pub partition: Option<String>,
    /// The account that pays.
    pub account: Option<String>,
    /// Tasks that run at the same time, at most.
    pub max_running: Option<NonZeroU32>,
    /// Cores of a task; 1 if absent.
    pub cpus: Option<NonZeroU32>,
    /// Memory of a task, as `sbatch --mem` takes it.
    pub memory: Option<String>,
    /// Other options of `sbatch`, each `--name=value`.
    pub options: Vec<String>,
}

/// Runs of a task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Chunk {
    /// As many as take a quarter of an hour, and fewer where the work is little.
    #[default]
    Auto,
    /// So many, and those that share their survey.
    Runs(NonZeroUsize),
}

impl SlurmSettings {
    /// These, and those of `before` where these say nothing.
    #[must_use]
    pub fn or(&self, before: &Self) -> Self {
        let text = |own: &Option<String>, before: &Option<String>| own.clone().or_else(|| before.clone());
        Self {
            chunk: self.chunk.or(before.chunk),
            time: text(&self.time, &before.time),
            partition: text(&self.partition, &before.partition),
            account: text(&self.account, &before.account),
            max_running: self.max_running.or(before.max_running),
            cpus: self.cpus.or(before.cpus),
            memory: text(&self.memory, &before.memory),
            options: if self.options.is_empty() { before.options.clone() } else { self.options.clone() },
        }
    }
}

impl FromStr for Chunk {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            number => number.parse().map(Self::Runs).map_err(|_| "expected a number of runs, 1 or above, or `auto`"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_is_a_number_or_automatic() {
        assert_eq!("auto".parse(), Ok(Chunk::Auto));
        assert_eq!("12".parse(), Ok(Chunk::Runs(NonZeroUsize::new(12).unwrap())));
        for text in ["0", "-1", "many", ""] {
            assert!(text.parse::<Chunk>().is_err(), "{text}");
        }
    }
}
