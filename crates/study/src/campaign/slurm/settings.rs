//! What a submission asks of Slurm.

use std::num::{NonZeroU32, NonZeroUsize};
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use super::super::json_object::JsonObject;
use super::slurm_option::SlurmOption;
use super::value::{Grammar, Memory, SlurmName, TimeLimit, Value, found};

/// What a submission asks of Slurm. What is absent is left to the cluster.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SlurmSettings {
    /// Runs of a task; automatic if absent.
    pub chunk: Option<Chunk>,
    /// Time limit of a task, as `sbatch --time` takes it.
    pub time: Option<TimeLimit>,
    /// The partition.
    pub partition: Option<SlurmName>,
    /// The account that pays.
    pub account: Option<SlurmName>,
    /// Tasks that run at the same time, at most.
    pub max_running: Option<NonZeroU32>,
    /// Cores of a task; 1 if absent.
    pub cpus: Option<NonZeroU32>,
    /// Memory of a task, as `sbatch --mem` takes it.
    pub memory: Option<Memory>,
    /// Other options of `sbatch`.
    pub options: Vec<SlurmOption>,
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
        Self {
            chunk: self.chunk.or(before.chunk),
            time: self.time.clone().or_else(|| before.time.clone()),
            partition: self.partition.clone().or_else(|| before.partition.clone()),
            account: self.account.clone().or_else(|| before.account.clone()),
            max_running: self.max_running.or(before.max_running),
            cpus: self.cpus.or(before.cpus),
            memory: self.memory.clone().or_else(|| before.memory.clone()),
            options: if self.options.is_empty() { before.options.clone() } else { self.options.clone() },
        }
    }

    /// The settings in a file, whose values are in their grammars.
    pub(super) fn parse(mut object: JsonObject) -> Result<Self, SettingError> {
        let number = "a whole number, 1 or above, or null";
        let this = Self {
            chunk: object.take("chunk", "`auto`, {\"runs\": N} with N at least 1, or null")?,
            time: value(&mut object, "time")?,
            partition: value(&mut object, "partition")?,
            account: value(&mut object, "account")?,
            max_running: object.take("max_running", number)?,
            cpus: object.take("cpus", number)?,
            memory: value(&mut object, "memory")?,
            options: options(&mut object)?,
        };
        object.finish()?;
        Ok(this)
    }

    /// An option that may not come from a file, as `options` are those of one.
    pub(super) fn option_of_user(&self) -> Option<&SlurmOption> {
        self.options.iter().find(|option| !option.is_of_resources())
    }
}

/// The value under a key, if there is one.
fn value<G: Grammar>(object: &mut JsonObject, key: &str) -> Result<Option<Value<G>>, SettingError> {
    let text: Option<String> = object.take(key, G::ALLOWED)?;
    text.map(|text| Value::of(&object.path(key), &text)).transpose()
}

fn options(object: &mut JsonObject) -> Result<Vec<SlurmOption>, SettingError> {
    let texts: Vec<String> = object.take("options", "an array of texts")?;
    let option = |(i, text): (usize, String)| {
        let key = object.path(&format!("options[{i}]"));
        text.parse().map_err(|_| SettingError::new(key, found(&text), SlurmOption::ALLOWED))
    };
    texts.into_iter().enumerate().map(option).collect()
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
