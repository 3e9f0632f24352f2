//! Which files a command may write: an output never replaces an input, and only what is ours is replaced without being
//! asked for. All commands ask here, before any work.

mod kind;
mod outputs;
mod refusal;

pub use kind::{OutputKind, PICTURE_SOFTWARE, REPORT_TITLE, TUM_PATH};
pub use outputs::{Outputs, Replace, admit_folder};
pub use refusal::{OutputNote, OutputRefusal};
