//! The one place that decides which files a command may write.

use std::fmt;
use std::path::{Path, PathBuf};

use super::kind::OutputKind;
use super::refusal::{OutputNote, OutputRefusal};
use crate::output::{FileIdentity, Leftover, kept_name, part_of, try_folder};

/// What may be replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Replace {
    /// Earlier outputs of this program, of the same kind.
    #[default]
    Ours,
    /// Any file that is not an input.
    Any,
}

/// The files that a command reads and those that it will write. [`Outputs::admit`] is called before any work.
///
/// ```
/// use sextant_recording::admission::{OutputKind, OutputRefusal, Outputs, Replace};
///
/// let mut outputs = Outputs::new(Replace::Any);
/// outputs.reads("a.toml".as_ref()).writes("--out", "./b/../a.toml".as_ref(), OutputKind::Recording);
/// assert!(matches!(outputs.admit(), Err(OutputRefusal::Input { .. })));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Outputs<'a> {
    replace: Replace,
    inputs: Vec<(PathBuf, FileIdentity)>,
    folders: Vec<PathBuf>,
    /// Folders in which each file has a meaning, so that none may be added.
    closed: Vec<PathBuf>,
    outputs: Vec<Output<'a>>,
    /// Folders whose contents go, by the names that the user gave them.
    cleared: Vec<(String, PathBuf)>,
}

#[derive(Clone, Debug)]
struct Output<'a> {
    name: String,
    path: PathBuf,
    identity: FileIdentity,
    /// The file while it is written, if it is long.
    part: Option<PathBuf>,
    kind: OutputKind<'a>,
}

impl<'a> Outputs<'a> {
    /// No file yet.
    #[must_use]
    pub fn new(replace: Replace) -> Self {
        Self { replace, ..Self::default() }
    }

    /// The command reads this file, or this folder and all files in it.
    pub fn reads(&mut self, path: &Path) -> &mut Self {
        match path.canonicalize() {
            Ok(folder) if folder.is_dir() => self.folders.push(folder),
            _ => self.inputs.push((path.to_owned(), FileIdentity::of(path))),
        }
        self
    }

    /// The command reads this folder, to which no file may be added.
    pub fn reads_closed(&mut self, folder: &Path) -> &mut Self {
        self.closed.extend(folder.canonicalize());
        self.reads(folder)
    }

    /// The command writes this file; `name` is what the user calls it, `--out` for example.
    pub fn writes(&mut self, name: &str, path: &Path, kind: OutputKind<'a>) -> &mut Self {
        let (identity, part) = (FileIdentity::of(path), kind.part_suffix().map(|suffix| part_of(path, suffix)));
        self.outputs.push(Output { name: name.to_owned(), path: path.to_owned(), identity, part, kind });
        self
    }

    /// The command writes a folder anew: what is in it goes.
    pub fn clears(&mut self, name: &str, folder: &Path) -> &mut Self {
        self.cleared.push((name.to_owned(), folder.to_owned()));
        self
    }

    /// Decides whether each output is a file of its own: neither an input nor another output, and written by nobody else.
    ///
    /// # Errors
    /// The first reason why one is not.
    pub fn keep_inputs(&self) -> Result<(), OutputRefusal> {
        for (i, output) in self.outputs.iter().enumerate() {
            let shown = || output.to_string();
            if let Some((input, _)) = self.inputs.iter().find(|(_, identity)| output.is_or_passes(identity)) {
                return Err(OutputRefusal::Input { output: shown(), input: input.clone() });
            }
            if let Some(other) = self.outputs[..i].iter().find(|other| output.meets(other)) {
                return Err(OutputRefusal::Shared { output: shown(), other: other.to_string() });
            }
            if output.part.as_ref().is_some_and(|part| Leftover::at(part) == Leftover::Busy) {
                return Err(OutputRefusal::Busy { output: shown() });
            }
        }
        for (folder, output) in
            self.closed.iter().flat_map(|folder| self.outputs.iter().map(move |output| (folder, output)))
        {
            if output.would_be_in(folder) {
                return Err(OutputRefusal::Input { output: output.to_string(), input: folder.clone() });
            }
        }
        for (name, folder) in &self.cleared {
            let Ok(folder) = folder.canonicalize() else { continue };
            let is_within = |path: &PathBuf| path.canonicalize().is_ok_and(|path| path.starts_with(&folder));
            if let Some((input, _)) = self.inputs.iter().find(|(path, _)| is_within(path)) {
                let output = format!("what is in `{name} {}`", folder.display());
                return Err(OutputRefusal::Input { output, input: input.clone() });
            }
        }
        Ok(())
    }

    /// Decides whether all outputs may be written, and returns what the user should know.
    ///
    /// # Errors
    /// The first reason why one may not.
    pub fn admit(&self) -> Result<Vec<OutputNote>, OutputRefusal> {
        self.keep_inputs()?;
        let mut notes = Vec::new();
        for output in &self.outputs {
            let shown = || output.to_string();
            if let Err(why) = output.has_place() {
                return Err(OutputRefusal::Place { output: shown(), why });
            }
            if let Some(part) = output.part.as_ref().filter(|part| Leftover::at(part) == Leftover::Kept) {
                notes.push(OutputNote::LeftOver { part: part.clone(), kept: kept_name(part) });
            }
            if !output.path.is_file() {
                continue;
            }
            // A file that cannot be read is nobody's.
            let is_ours = output.kind.is_ours(&output.path).unwrap_or(false);
            if let Some(folder) = self.folders.iter().find(|folder| !is_ours && output.is_in(folder)) {
                return Err(OutputRefusal::Input { output: shown(), input: folder.clone() });
            }
            let what = match (is_ours, output.kind) {
                (true, OutputKind::Text(_)) => continue,
                (true, kind) => Some(kind.earlier()),
                (false, _) if self.replace == Replace::Any => None,
                (false, OutputKind::Table) => return Err(OutputRefusal::Exists { output: shown() }),
                (false, kind) => {
                    return Err(OutputRefusal::Foreign { output: shown(), kind: kind.earlier().to_owned() });
                }
            };
            notes.push(OutputNote::Replaced { path: output.path.clone(), what });
        }
        Ok(notes)
    }
}

/// Decides whether the many files of one output may be written into `folder`: it is new or empty, `is_ours`, or all may be
/// replaced.
///
/// # Errors
/// If not.
pub fn admit_folder(folder: &Path, replace: Replace, is_ours: impl FnOnce() -> bool) -> Result<(), OutputRefusal> {
    let has_files = std::fs::read_dir(folder).is_ok_and(|mut files| files.next().is_some());
    if has_files && replace == Replace::Ours && !is_ours() {
        return Err(OutputRefusal::Folder { folder: folder.to_owned() });
    }
    Ok(())
}

impl Output<'_> {
    /// Whether it is this file, or has its name while it is written.
    fn is_or_passes(&self, identity: &FileIdentity) -> bool {
        self.identity == *identity || self.part.as_ref().is_some_and(|part| FileIdentity::of(part) == *identity)
    }

    /// Whether both are one file, also while they are written.
    fn meets(&self, other: &Self) -> bool {
        let passes = |part: &PathBuf| other.is_or_passes(&FileIdentity::of(part));
        other.is_or_passes(&self.identity) || self.part.as_ref().is_some_and(passes)
    }

    /// Whether a file of this name would be in this folder, which has no links in its path.
    fn would_be_in(&self, folder: &Path) -> bool {
        let whole = std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
        let above = whole.ancestors().skip(1).find_map(|above| above.canonicalize().ok());
        above.is_some_and(|above| above.starts_with(folder))
    }

    /// Whether a file can be there. Of a file that the user did not name, the command makes the folder.
    ///
    /// # Errors
    /// The reason why not.
    fn has_place(&self) -> Result<(), String> {
        match std::fs::metadata(&self.path) {
            Ok(found) if found.is_dir() => return Err("it is a folder".to_owned()),
            Ok(found) if !found.is_file() && self.part.is_some() => {
                return Err("it is a device or a pipe, not a file".to_owned());
            }
            Ok(found) if !found.is_file() => return Ok(()),
            Ok(_) | Err(_) => {}
        }
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        match folder.is_dir() {
            true => try_folder(folder).map_err(|error| error.to_string()),
            false if self.name.is_empty() => Ok(()),
            false => Err(format!("there is no folder `{}`", folder.display())),
        }
    }

    /// Whether it is a file in this folder, or a name of one.
    fn is_in(&self, folder: &Path) -> bool {
        self.path.canonicalize().is_ok_and(|path| path.starts_with(folder))
            || files_of(folder).any(|file| FileIdentity::of(&file) == self.identity)
    }
}

/// The files that stand directly in a folder.
fn files_of(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_file())
}

impl fmt::Display for Output<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name.as_str() {
            "" => write!(f, "`{}`", self.path.display()),
            name => write!(f, "`{name} {}`", self.path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "node,x_m,y_m,z_m,ties,infeasible,concern\n";

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("a.toml", "seed = 1"), ("old.csv", MAP), ("diary.csv", "day,word\n")] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    fn admitted(folder: &Path, replace: Replace, out: &str) -> Result<Vec<OutputNote>, OutputRefusal> {
        Outputs::new(replace)
            .reads(&folder.join("a.toml"))
            .writes("--out", &folder.join(out), OutputKind::Map)
            .admit()
    }

    /// No file can be made there, not even by the administrator.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_file_is_refused_before_anything_is_said_of_it() {
        let mut outputs = Outputs::new(Replace::Any);
        outputs.writes("", Path::new("/proc/version"), OutputKind::Picture);
        assert!(matches!(outputs.admit(), Err(OutputRefusal::Place { .. })), "{:?}", outputs.admit());
    }

    #[test]
    fn an_input_is_never_replaced() {
        let folder = folder();
        std::fs::create_dir(folder.path().join("below")).unwrap();
        std::fs::hard_link(folder.path().join("a.toml"), folder.path().join("hard.csv")).unwrap();
        let mut names = vec!["a.toml", "below/../a.toml", "hard.csv"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("a.toml", folder.path().join("soft.csv")).unwrap();
            names.push("soft.csv");
        }
        for name in names {
            for replace in [Replace::Ours, Replace::Any] {
                let refusal = admitted(folder.path(), replace, name).unwrap_err();
                assert!(matches!(refusal, OutputRefusal::Input { .. }), "{name}: {refusal}");
            }
        }
    }

    #[test]
    fn an_earlier_output_is_replaced_and_a_foreign_file_is_not() {
        let folder = folder();
        let note = admitted(folder.path(), Replace::Ours, "old.csv").unwrap();
        assert!(note[0].to_string().ends_with("old.csv` is replaced: it is an earlier map"), "{}", note[0]);
        assert_eq!(admitted(folder.path(), Replace::Ours, "new.csv"), Ok(Vec::new()));
        let refusal = admitted(folder.path(), Replace::Ours, "diary.csv").unwrap_err();
        assert!(refusal.to_string().contains("exists, and is not an earlier map"), "{refusal}");
        let forced = admitted(folder.path(), Replace::Any, "diary.csv").unwrap();
        assert!(forced[0].to_string().ends_with("diary.csv` is replaced"), "{}", forced[0]);
    }

    #[test]
    fn files_in_a_folder_that_is_read_are_inputs_unless_they_are_ours() {
        let folder = folder();
        let admit = |out: &str| {
            let mut outputs = Outputs::new(Replace::Any);
            outputs.reads(folder.path()).writes("", &folder.path().join(out), OutputKind::Map).admit()
        };
        assert!(matches!(admit("diary.csv"), Err(OutputRefusal::Input { .. })));
        assert!(admit("old.csv").is_ok() && admit("new.csv").is_ok());
    }

    #[test]
    fn two_outputs_are_two_files() {
        let folder = folder();
        let path = |name: &str| folder.path().join(name);
        let mut outputs = Outputs::new(Replace::Any);
        outputs.writes("--out", &path("x"), OutputKind::Map).writes("--summary", &path("./X"), OutputKind::Summary);
        let refusal = outputs.admit().unwrap_err();
        assert!(refusal.to_string().contains("are the same file"), "{refusal}");
    }

    #[test]
    fn an_output_is_not_called_as_another_one_while_that_is_written() {
        let folder = folder();
        let path = |name: &str| folder.path().join(name);
        let admit = |recording: &str, capture: &str| {
            let mut outputs = Outputs::new(Replace::Any);
            outputs.writes("--out", &path(recording), OutputKind::Recording);
            outputs.writes("--pcap", &path(capture), OutputKind::Capture).admit()
        };
        for (recording, capture) in [("r.part", "r"), ("r", "r.part"), ("r", "./R.PART")] {
            assert!(matches!(admit(recording, capture), Err(OutputRefusal::Shared { .. })), "{recording} {capture}");
        }
        assert_eq!(admit("r.mcap", "r.pcap"), Ok(Vec::new()));
    }

    #[test]
    fn an_output_has_a_place_before_the_work() {
        let folder = folder();
        let admit = |name: &str, out: &str, kind| {
            Outputs::new(Replace::Any).writes(name, &folder.path().join(out), kind).admit()
        };
        for out in ["", "no/x.json", "no/../x.json", "a.toml/x.json"] {
            let refusal = admit("--summary", out, OutputKind::Summary).unwrap_err();
            assert!(matches!(refusal, OutputRefusal::Place { .. }), "{out}: {refusal}");
        }
        assert_eq!(admit("--summary", "x.json", OutputKind::Summary), Ok(Vec::new()));
        assert_eq!(admit("", "new/x.svg", OutputKind::Picture), Ok(Vec::new()), "the command makes the folder");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "nothing is left");
    }

    #[cfg(unix)]
    #[test]
    fn small_files_alone_are_written_to_devices() {
        let admit = |kind| Outputs::new(Replace::Any).writes("--out", Path::new("/dev/null"), kind).admit();
        assert_eq!(admit(OutputKind::Map), Ok(Vec::new()));
        assert!(matches!(admit(OutputKind::Recording), Err(OutputRefusal::Place { .. })));
    }

    #[test]
    fn nothing_is_added_to_a_closed_folder() {
        let folder = folder();
        let admit = |out: &str| {
            let mut outputs = Outputs::new(Replace::Any);
            outputs.reads_closed(folder.path()).writes("--out", &folder.path().join(out), OutputKind::Table).admit()
        };
        assert!(matches!(admit("new.csv"), Err(OutputRefusal::Input { .. })));
        assert!(matches!(admit("no/new.csv"), Err(OutputRefusal::Input { .. })));
        assert!(!matches!(admit("../new.csv"), Err(OutputRefusal::Input { .. })));
    }

    #[test]
    fn the_temporary_name_of_an_output_is_no_input_either() {
        let folder = folder();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("a.mcap.part"), "left").unwrap();
        let admit =
            |kind| Outputs::new(Replace::Any).reads(&path("a.mcap.part")).writes("", &path("a.mcap"), kind).admit();
        assert!(matches!(admit(OutputKind::Recording), Err(OutputRefusal::Input { .. })));
        assert_eq!(admit(OutputKind::RecoveredRecording), Ok(Vec::new()));
        let notes = Outputs::new(Replace::Ours).writes("", &path("a.mcap"), OutputKind::Recording).admit().unwrap();
        assert!(notes[0].to_string().ends_with("a.mcap.part.1`"), "{}", notes[0]);
    }

    #[test]
    fn a_folder_with_an_input_is_not_cleared() {
        let folder = folder();
        let clear = |cleared: &Path| {
            Outputs::new(Replace::Any).reads(&folder.path().join("a.toml")).clears("--plan", cleared).keep_inputs()
        };
        assert!(matches!(clear(&folder.path().join(".")), Err(OutputRefusal::Input { .. })));
        assert_eq!(clear(&folder.path().join("below")), Ok(()));
    }

    #[test]
    fn a_folder_with_files_of_others_is_not_written_into() {
        let folder = folder();
        assert!(admit_folder(folder.path(), Replace::Ours, || false).is_err());
        for (replace, is_ours) in [(Replace::Any, false), (Replace::Ours, true)] {
            assert_eq!(admit_folder(folder.path(), replace, || is_ours), Ok(()));
        }
        assert_eq!(admit_folder(&folder.path().join("new"), Replace::Ours, || false), Ok(()));
    }
}
