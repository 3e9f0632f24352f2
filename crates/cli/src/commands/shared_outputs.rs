//! Checks that the outputs of a command do not overwrite each other.

use std::path::{Path, PathBuf};

use crate::diagnostic::Failure;

/// Rejects two outputs of one command that are the same file. `outputs` are pairs of a flag and the file that it names.
///
/// # Errors
/// If two of them are the same file.
pub(super) fn reject_shared(outputs: &[(&str, Option<&PathBuf>)]) -> Result<(), Failure> {
    let is_same = |a: &Path, b: &Path| std::path::absolute(a).ok() == std::path::absolute(b).ok();
    for (i, (flag, path)) in outputs.iter().enumerate() {
        let Some(path) = path else { continue };
        let twin = outputs[..i].iter().find(|(_, other)| other.is_some_and(|other| is_same(path, other)));
        if let Some((other, _)) = twin {
            let message = format!("`{flag}` and `{other}` are both `{}`: name two different files", path.display());
            return Err(Failure::bad_input(message));
        }
    }
    Ok(())
}
