//! Which files a command may write: an output never replaces an input, and only what is ours is replaced without being
//! asked for. All commands ask here, before any work.

mod kind;
mod outputs;

pub use kind::{MAP_HEADER, OutputKind, PICTURE_SOFTWARE, REPORT_TITLE};
pub use outputs::{OutputNote, OutputRefusal, Outputs, Replace, admit_folder};
