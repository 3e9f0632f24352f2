//! The first pass over a log: all but its receptions, which are counted.

use std::path::Path;

use sextant_kernel::{Interrupted, Watch};
use sextant_logs::{ReadOptions, RowLog, Source};
use sextant_recording as recording;

use super::census::Census;
use crate::mapping::TilesError;
use crate::mapping::{Input, MapLogError};

/// Receptions between two looks whether the work is to end.
pub(super) const LOOK: u64 = 4096;

/// What the first pass over a log found.
#[derive(Debug)]
pub struct Survey {
    pub(super) census: Census,
    /// The log of a robot, whose rows become receptions later.
    pub(super) rows: Option<RowLog>,
}

/// Reads a log without its receptions, which are counted. If robots surveyed several networks, the log is that of `network`,
/// or of the first one.
///
/// # Errors
/// If it cannot be read, or is of a form that is read only as a whole.
pub fn survey(
    path: &Path,
    network: Option<&str>,
    options: &ReadOptions,
    watch: &dyn Watch,
) -> Result<(Input, Survey), MapLogError> {
    let mut census = Census::default();
    let mut count = 0;
    let (input, rows) = if Source::of(path).is_some() {
        let rows = RowLog::open(path, options, &mut |row, place| {
            census.count(&row, place);
            looked(&mut count, watch)
        })?;
        let rows = rows.ok_or_else(|| TilesError::Form { path: path.to_owned() })?;
        census.holds_rows();
        (Input::of_robot(rows.whole.clone(), rows.plane, rows.notes.clone()), Some(rows))
    } else {
        sextant_logs::refuse_options(path, options)?;
        let run = recording::stream_log(path, network, &mut |reception, stop| {
            census.count(&reception, stop.position);
            Ok(looked(&mut count, watch)?)
        })?;
        (Input::of_recording(path, run, network)?, None)
    };
    census.complete(input.log().node_count());
    Ok((input, Survey { census, rows }))
}

/// Counts a reception; an error once the work is to end.
pub(super) fn looked(count: &mut u64, watch: &dyn Watch) -> Result<(), Interrupted> {
    *count += 1;
    if count.is_multiple_of(LOOK) && watch.is_stopped() { Err(Interrupted) } else { Ok(()) }
}
