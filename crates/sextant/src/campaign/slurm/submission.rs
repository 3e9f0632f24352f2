//! The folder of a submission.

use std::fs;
use std::io;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sextant_recording::disk;
use sextant_recording::output::{OutputError, write_file};

use super::super::error::CampaignError;
use super::settings::SlurmSettings;
use crate::number_range::NumberRange;

/// The job script.
pub(super) const SCRIPT: &str = "job.sh";
/// The runs of each task, one range a line.
pub(super) const CHUNKS: &str = "chunks";
/// What was submitted.
const RECORD: &str = "submission.json";

/// How often a run is submitted, at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attempts(Option<NonZeroU32>);

impl Attempts {
    pub(super) const ANY: Self = Self(None);

    /// At most so often.
    #[must_use]
    pub fn at_most(attempts: NonZeroU32) -> Self {
        Self(Some(attempts))
    }

    pub(super) fn are_used_up(self, tried: u32) -> bool {
        self.0.is_some_and(|most| tried >= most.get())
    }
}

/// What was submitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submitted {
    /// Its number, from 1, as the name of its folder.
    pub name: String,
    /// The identities of its jobs: one an array.
    pub jobs: Vec<String>,
    /// Number of tasks of all arrays.
    pub tasks: usize,
    /// Number of runs of all tasks.
    pub runs: usize,
    /// Number of runs that were not submitted because a task still waits for them or does them.
    pub left_to_queue: usize,
    /// Number of runs that were not submitted because they were submitted too often.
    pub given_up: usize,
    /// Why not all arrays were submitted, if so: the scheduler refused one.
    pub refused: Option<String>,
}

impl Submitted {
    /// A submission that has no job yet.
    pub(super) fn begun(folder: &Path) -> Self {
        let name = name_of(folder);
        Self { name, jobs: Vec::new(), tasks: 0, runs: 0, left_to_queue: 0, given_up: 0, refused: None }
    }
}

/// The name of a folder.
fn name_of(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What is kept of a submission.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    pub(super) settings: SlurmSettings,
    pub(super) arrays: Vec<Array>,
    pub(super) runs: usize,
}

/// An array of tasks.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Array {
    pub(super) job: String,
    /// The line of the file of chunks that its task 0 does.
    pub(super) first: usize,
    pub(super) tasks: usize,
}

/// A submission that was made.
#[derive(Clone, Debug)]
pub(super) struct Submission {
    folder: PathBuf,
    pub(super) record: Record,
    chunks: Vec<NumberRange>,
}

/// Makes the folder of submission `number`. If two processes ask for the same number, one gets it.
pub(super) fn claim(folder: &Path, number: usize) -> Result<PathBuf, CampaignError> {
    disk::create_folders(folder).map_err(|error| OutputError::new(folder, &error))?;
    let own = folder.join(format!("{number:06}"));
    match disk::create_folder(&own) {
        Ok(()) => Ok(own),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(CampaignError::Submitting { folder: own }),
        Err(error) => Err(OutputError::new(&own, &error).into()),
    }
}

pub(super) fn write_chunks(folder: &Path, chunks: &[NumberRange]) -> Result<(), CampaignError> {
    let lines: String = chunks.iter().map(|chunk| format!("{chunk}\n")).collect();
    Ok(write_file(&folder.join(CHUNKS), lines.as_bytes())?)
}

pub(super) fn write_script(path: &Path, text: &str) -> Result<(), CampaignError> {
    Ok(write_file(path, text.as_bytes())?)
}

impl Record {
    pub(super) fn jobs(&self) -> impl Iterator<Item = String> {
        self.arrays.iter().map(|array| array.job.clone())
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), CampaignError> {
        let path = folder.join(RECORD);
        let json = serde_json::to_vec_pretty(self)
            .map_err(|error| OutputError::new(&path, &io::Error::other(error.to_string())))?;
        Ok(write_file(&path, &json)?)
    }
}

impl Submission {
    /// The submissions in `folder`, in their order, and the folders of those that have no job yet.
    pub(super) fn all(folder: &Path) -> Result<(Vec<Self>, Vec<PathBuf>), CampaignError> {
        let unreadable = |error: io::Error| CampaignError::unreadable(folder, &error);
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((Vec::new(), Vec::new())),
            other => other.map_err(unreadable)?,
        };
        let mut folders =
            entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
        folders.sort();
        let (mut made, mut begun) = (Vec::new(), Vec::new());
        for folder in folders {
            match Self::read(&folder)? {
                Some(submission) => made.push(submission),
                None => begun.push(folder),
            }
        }
        Ok((made, begun))
    }

    /// The submission in `folder`; `None` if it has no job yet.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>, CampaignError> {
        let path = folder.join(RECORD);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| CampaignError::unreadable(&path, &error))?,
        };
        let invalid = |path: &Path, why: String| CampaignError::Read { path: path.to_owned(), why };
        let record = serde_json::from_slice(&bytes).map_err(|error| invalid(&path, error.to_string()))?;
        let path = folder.join(CHUNKS);
        let text = fs::read_to_string(&path).map_err(|error| CampaignError::unreadable(&path, &error))?;
        let chunks = text.lines().map(|line| line.parse().map_err(|why: &str| invalid(&path, why.to_owned())));
        Ok(Some(Self { folder: folder.to_owned(), record, chunks: chunks.collect::<Result<_, _>>()? }))
    }

    pub(super) fn jobs(&self) -> impl Iterator<Item = String> {
        self.record.jobs()
    }

    /// The chunks that were submitted: all, unless Slurm refused a later array.
    pub(super) fn submitted_chunks(&self) -> &[NumberRange] {
        let end = self.record.arrays.last().map_or(0, |last| last.first + last.tasks);
        &self.chunks[..end.min(self.chunks.len())]
    }

    /// The runs of a task.
    pub(super) fn chunk_of(&self, job: &str, index: usize) -> Option<NumberRange> {
        let array = self.record.arrays.iter().find(|array| array.job == job)?;
        self.chunks.get(array.first + index).copied()
    }

    pub(super) fn submitted(&self) -> Submitted {
        Submitted {
            name: name_of(&self.folder),
            jobs: self.jobs().collect(),
            tasks: self.submitted_chunks().len(),
            runs: self.record.runs,
            left_to_queue: 0,
            given_up: 0,
            refused: None,
        }
    }
}
