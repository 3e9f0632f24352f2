//! A stop as users find it in their files.

use sextant_channel::ReceptionLog;

/// Says which stop `index` is: a reception log does not keep the names of stops, so by its place and its row.
pub(super) fn stop_text(log: &ReceptionLog, index: u32) -> String {
    let at = log.stops()[index as usize].position;
    format!("the stop at ({:.1}, {:.1}) m, number {} of {}", at.x_m, at.y_m, index + 1, log.stops().len())
}
