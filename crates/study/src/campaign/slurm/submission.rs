//! The folder of a submission.

use std::ffi::OsStr;
use std::io;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use serde::Serialize;
use sextant::NumberRange;
use sextant_kernel::{LARGEST_FILE, SettingError};
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::{OutputError, write_file};

use super::super::error::CampaignError;
use super::super::json_object::JsonObject;
use super::FOLDER;
use super::settings::SlurmSettings;
use super::slurm_option::SlurmOption;
use super::value::{Grammar, Job, JobId, found};

/// The job script.
pub(super) const SCRIPT: &str = "job.sh";
/// The runs of each task, one range a line.
pub(super) const CHUNKS: &str = "chunks";
/// What was submitted.
const RECORD: &str = "submission.json";
/// Digits in the name of its folder.
const DIGITS: usize = 6;

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
    pub jobs: Vec<JobId>,
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
#[derive(Clone, Debug, Serialize)]
pub(super) struct Record {
    pub(super) settings: SlurmSettings,
    pub(super) arrays: Vec<Array>,
    pub(super) runs: usize,
}

/// An array of tasks.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Array {
    pub(super) job: JobId,
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
    let own = folder.join(format!("{number:0DIGITS$}"));
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

/// The chunks in the file at `path`, of a plan with so many `runs`.
fn chunks_in(plan: &ForeignFolder, path: &Path, runs: usize) -> Result<Vec<NumberRange>, CampaignError> {
    let text = plan.read_text(path, LARGEST_FILE).map_err(|error| CampaignError::unreadable(path, &error))?;
    let mut chunks: Vec<NumberRange> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let start = chunks.last().map_or(0, |last| last.end);
        let chunk = line.parse().ok().filter(|chunk: &NumberRange| chunk.start >= start && chunk.end <= runs);
        let chunk = chunk.ok_or_else(|| {
            let allowed = format!("A..B with A at least {start} and B at most {runs}");
            CampaignError::invalid(path, SettingError::new(format!("line {}", i + 1), found(line), allowed))
        })?;
        chunks.push(chunk);
    }
    Ok(chunks)
}

pub(super) fn write_script(path: &Path, text: &str) -> Result<(), CampaignError> {
    Ok(write_file(path, text.as_bytes())?)
}

impl Record {
    pub(super) fn jobs(&self) -> impl Iterator<Item = JobId> {
        self.arrays.iter().map(|array| array.job.clone())
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), CampaignError> {
        let path = folder.join(RECORD);
        let json = serde_json::to_vec_pretty(self)
            .map_err(|error| OutputError::new(&path, &io::Error::other(error.to_string())))?;
        Ok(write_file(&path, &json)?)
    }

    /// The record in a file, of a submission whose tasks do these `chunks`.
    fn parse(mut object: JsonObject, chunks: &[NumberRange]) -> Result<Self, SettingError> {
        let settings = SlurmSettings::parse(object.object("settings")?)?;
        let mut arrays: Vec<Array> = Vec::new();
        let mut next = 0;
        for mut array in object.objects("arrays")? {
            let job: String = array.take("job", Job::ALLOWED)?;
            let job = JobId::of(&array.path("job"), &job)?;
            let first: usize = array.take("first", "a whole number")?;
            if first != next {
                return Err(SettingError::new(
                    array.path("first"),
                    first,
                    format!("{next}, the first line that is left"),
                ));
            }
            let left = chunks.len() - next;
            let allowed = format!("a whole number, 1 to {left}: so many lines of `{CHUNKS}` are left");
            let tasks: usize = array.take("tasks", &allowed)?;
            if tasks == 0 || tasks > left {
                return Err(SettingError::new(array.path("tasks"), tasks, allowed));
            }
            array.finish()?;
            next += tasks;
            arrays.push(Array { job, first, tasks });
        }
        let runs = object.take("runs", "a whole number")?;
        let all: usize = chunks[..next].iter().map(|chunk| chunk.len()).sum();
        if runs != all {
            return Err(SettingError::new("runs", runs, format!("{all}, the runs of all tasks")));
        }
        object.finish()?;
        Ok(Self { settings, arrays, runs })
    }
}

impl Submission {
    /// The submissions of a plan with so many `runs`, which are in the folder `all` of it, in their order; and the folders of
    /// those that have no job yet.
    pub(super) fn all(
        plan: &ForeignFolder,
        all: &Path,
        runs: usize,
    ) -> Result<(Vec<Self>, Vec<PathBuf>), CampaignError> {
        let folders = match plan.entries(all) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((Vec::new(), Vec::new())),
            other => other.map_err(|error| CampaignError::unreadable(all, &error))?,
        };
        let (mut made, mut begun) = (Vec::new(), Vec::new());
        for folder in folders {
            let is_number = |name: &str| name.len() == DIGITS && name.bytes().all(|octet| octet.is_ascii_digit());
            if !folder.file_name().and_then(OsStr::to_str).is_some_and(is_number) {
                let why = format!("allowed in `{FOLDER}`: folders that are called 000001, 000002 and so on");
                return Err(CampaignError::Foreign { path: folder, why });
            }
            match Self::read(plan, &folder, runs)? {
                Some(submission) => made.push(submission),
                None => begun.push(folder),
            }
        }
        Ok((made, begun))
    }

    /// The submission in `folder`, of a plan with so many `runs`; `None` if it has no job yet.
    pub(super) fn read(plan: &ForeignFolder, folder: &Path, runs: usize) -> Result<Option<Self>, CampaignError> {
        let path = folder.join(RECORD);
        let json = match plan.read(&path, LARGEST_FILE) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|error| CampaignError::unreadable(&path, &error))?,
        };
        let chunks = chunks_in(plan, &folder.join(CHUNKS), runs)?;
        let object = JsonObject::parse(&json).map_err(|error| CampaignError::Foreign {
            path: path.clone(),
            why: format!("it is no JSON object: {error}"),
        })?;
        let record = Record::parse(object, &chunks).map_err(|error| CampaignError::invalid(&path, error))?;
        Ok(Some(Self { folder: folder.to_owned(), record, chunks }))
    }

    /// Refuses settings of this submission that only a user may choose.
    pub(super) fn check_options(&self) -> Result<(), CampaignError> {
        match self.record.settings.option_of_user() {
            None => Ok(()),
            Some(option) => Err(CampaignError::OptionOfUser {
                file: self.folder.join(RECORD),
                option: option.to_string(),
                allowed: SlurmOption::of_resources(),
            }),
        }
    }

    pub(super) fn jobs(&self) -> impl Iterator<Item = JobId> {
        self.record.jobs()
    }

    /// The chunks that were submitted: all, unless Slurm refused a later array.
    pub(super) fn submitted_chunks(&self) -> &[NumberRange] {
        let end = self.record.arrays.last().map_or(0, |last| last.first + last.tasks);
        &self.chunks[..end.min(self.chunks.len())]
    }

    /// The runs of a task.
    pub(super) fn chunk_of(&self, job: &JobId, index: usize) -> Option<NumberRange> {
        let array = self.record.arrays.iter().find(|array| array.job == *job && index < array.tasks)?;
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
