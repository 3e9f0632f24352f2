//! What a run is asked for.

use std::path::Path;

/// What a run is asked for beside its scenario.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Where the recording goes.
    pub recording: &'a Path,
    /// Where the capture of frames goes, if one is wanted.
    pub pcap: Option<&'a Path>,
    /// Whether nothing is shown while the work goes on.
    pub quiet: bool,
}
