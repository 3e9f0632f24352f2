//! A ROS bag in an MCAP file.

use sextant_logs::ReadOptions;

use crate::scratch;
use crate::targets::tables::log_is_sound;

/// It is refused, or its packets and poses are a log that is written and read again.
pub(crate) fn check(octets: &[u8]) {
    let bag = scratch::file("bag.mcap", octets);
    match sextant_logs::read(&bag, &ReadOptions::default()) {
        Ok(read) => log_is_sound(&read),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
