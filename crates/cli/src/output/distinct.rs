//! Outputs of one command must not overwrite each other.

use std::path::{Path, PathBuf};

use crate::diagnostic::Failure;

/// Refuses an output that another one of the same command would overwrite. `outputs` are the flags that name the files,
/// and the files.
///
/// # Errors
/// If two of them are the same file.
pub(crate) fn refuse_shared(outputs: &[(&str, Option<&PathBuf>)]) -> Result<(), Failure> {
    let is_same = |a: &Path, b: &Path| std::path::absolute(a).ok() == std::path::absolute(b).ok();
    for (i, (flag, path)) in outputs.iter().enumerate() {
        let Some(path) = path else { continue };
        let twin = outputs[..i].iter().find(|(_, other)| other.is_some_and(|other| is_same(path, other)));
        if let Some((other, _)) = twin {
            let message =
                format!("`{flag}` and `{other}` are both `{}`: give each a file of its own", path.display());
            return Err(Failure::bad_input(message));
        }
    }
    Ok(())
}
