//! The options of a run.

use std::path::Path;

/// The options of a run, apart from its scenario.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The recording to write.
    pub recording: &'a Path,
    /// The capture of frames to write, if any.
    pub pcap: Option<&'a Path>,
    /// Whether progress is hidden.
    pub quiet: bool,
}
