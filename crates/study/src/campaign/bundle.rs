//! The files that the runs of a plan need, copied into its folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use sextant_kernel::text::hexadecimal;
use sextant_kernel::{LARGEST_FILE, SettingError};
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::{self, OutputError, write_file};
use sextant_scenario::NamedFile;
use sha2::{Digest, Sha256};

use super::error::CampaignError;
use super::json_object::JsonObject;
use crate::sweep::Sweep;

/// The files of a plan.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Bundle {
    /// The scenario, as its path among the files.
    pub(super) scenario: String,
    /// Hash of each file by its path, with `/` between folders.
    pub(super) sha256: BTreeMap<String, String>,
    /// The path among the files of each file that a cell names, by how it is written there.
    pub(super) named: BTreeMap<PathBuf, String>,
}

/// Rejects files that would not be found where the plan is moved to.
pub(super) fn check(sweep: &Sweep) -> Result<(), CampaignError> {
    let named = sweep.named_files().iter().map(|file| file.written.clone());
    match sweep.file().bases().chain(named).find(|file| file.is_absolute()) {
        Some(file) => Err(CampaignError::Absolute { file }),
        None => Ok(()),
    }
}

/// Copies the scenario of `sweep`, the files that it extends and those that any cell names to `folder`. They keep their
/// places relative to each other, so that the paths in them stay true.
pub(super) fn write(sweep: &Sweep, folder: &Path) -> Result<Bundle, CampaignError> {
    let named = sweep.named_files();
    let layers = sweep.file().layers().map(Path::to_path_buf);
    let named_paths = named.iter().map(|file| file.path.clone());
    let files: Vec<PathBuf> = layers.chain(named_paths).map(|file| plain(&file)).collect::<Result<_, _>>()?;
    let root = common_folder(&files);
    let scenario = plain(sweep.file().path())?;
    let mut bundle = Bundle { scenario: portable(&scenario, &root), ..Bundle::default() };
    for file in files {
        let name = portable(&file, &root);
        if bundle.sha256.contains_key(&name) {
            continue;
        }
        let bytes = fs::read(&file).map_err(|error| CampaignError::unreadable(&file, &error))?;
        let copy = folder.join(&name);
        if let Some(parent) = copy.parent() {
            disk::create_folders(parent).map_err(|error| OutputError::new(parent, &error))?;
        }
        write_file(&copy, &bytes)?;
        bundle.sha256.insert(name, hexadecimal(&Sha256::digest(&bytes)));
    }
    for file in named {
        bundle.named.insert(file.written.clone(), portable(&plain(&file.path)?, &root));
    }
    Ok(bundle)
}

impl Bundle {
    /// The files in a file that somebody else may have written: each name is one in the folder, and each file that is named is
    /// among them.
    pub(super) fn parse(mut object: JsonObject) -> Result<Self, SettingError> {
        let this = Self {
            scenario: object.take("scenario", "the path of a file")?,
            sha256: object.take("sha256", "the hash of each file by its path")?,
            named: object.take("named", "the path of each file by how it is written")?,
        };
        let is_listed = |key: &str, name: &String| {
            let allowed = || format!("one of the files in `{}`", object.path("sha256"));
            let error = || SettingError::new(object.path(key), format!("`{}`", name.escape_debug()), allowed());
            this.sha256.contains_key(name).then_some(()).ok_or_else(error)
        };
        is_listed("scenario", &this.scenario)?;
        this.named.values().try_for_each(|name| is_listed("named", name))?;
        for (name, sha256) in &this.sha256 {
            let key = || object.path(&format!("sha256.\"{}\"", name.escape_debug()));
            if !is_portable(name) {
                let allowed = "paths in the folder, with `/` between folders and without `..`";
                return Err(SettingError::new(
                    object.path("sha256"),
                    format!("a file `{}`", name.escape_debug()),
                    allowed,
                ));
            }
            if !is_sha256(sha256) {
                let found = format!("`{}`", sha256.escape_debug());
                return Err(SettingError::new(key(), found, "64 hexadecimal digits"));
            }
        }
        object.finish()?;
        Ok(this)
    }

    /// The files in `folder` that the cells name.
    pub(super) fn named_files(&self, folder: &Path) -> Vec<NamedFile> {
        let file =
            |(written, name): (&PathBuf, &String)| NamedFile { written: written.clone(), path: folder.join(name) };
        self.named.iter().map(file).collect()
    }

    /// Rejects files in `folder`, which is in `plan`, that are no longer what they were.
    pub(super) fn check(&self, plan: &ForeignFolder, folder: &Path) -> Result<(), CampaignError> {
        for (name, sha256) in &self.sha256 {
            let file = folder.join(name);
            let bytes = plan.read(&file, LARGEST_FILE).map_err(|error| CampaignError::unreadable(&file, &error))?;
            if hexadecimal(&Sha256::digest(bytes)) != *sha256 {
                return Err(CampaignError::Changed { file });
            }
        }
        Ok(())
    }
}

/// Whether a path has names alone, with `/` between them.
fn is_portable(name: &str) -> bool {
    !name.contains(['\\', '\0']) && name.split('/').all(|part| !matches!(part, "" | "." | ".."))
}

/// The absolute path of `file` without `.` and `..`. Links are kept: paths in a file are relative to where it is named.
fn plain(file: &Path) -> Result<PathBuf, CampaignError> {
    let absolute = std::path::absolute(file).map_err(|error| CampaignError::unreadable(file, &error))?;
    Ok(output::plain(&absolute))
}

/// The deepest folder that has all files.
fn common_folder(files: &[PathBuf]) -> PathBuf {
    let mut folders = files.iter().filter_map(|file| file.parent());
    let mut common = folders.next().unwrap_or_else(|| Path::new("")).to_path_buf();
    for folder in folders {
        while !folder.starts_with(&common) {
            common.pop();
        }
    }
    common
}

/// Whether a text is the SHA-256 hash of something, as [`hexadecimal`] writes it.
fn is_sha256(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|octet| matches!(octet, b'0'..=b'9' | b'a'..=b'f'))
}

/// The path of `file` in `root`, with `/` between folders.
fn portable(file: &Path, root: &Path) -> String {
    let within = file.strip_prefix(root).unwrap_or(file);
    let names: Vec<_> = within.components().map(|component| component.as_os_str().to_string_lossy()).collect();
    names.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_keep_their_places_relative_to_each_other() {
        let files = ["/a/b/c/s.toml", "/a/b/base.toml", "/a/b/d/nodes.csv"].map(PathBuf::from);
        let root = common_folder(&files);
        assert_eq!(root, Path::new("/a/b"));
        assert_eq!(files.each_ref().map(|file| portable(file, &root)), ["c/s.toml", "base.toml", "d/nodes.csv"]);
        assert_eq!(plain(Path::new("/a/b/../c/./d")).unwrap(), Path::new("/a/c/d"));
    }
}
