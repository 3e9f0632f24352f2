//! A capture of a sniffer with the path of its robot.

use sextant_logs::{FormOptions, ReadOptions};

use crate::scratch;
use crate::targets::tables::log_is_sound;

/// It is refused, or its packets are a log that is written and read again.
pub(crate) fn check(octets: &[u8]) {
    let capture = scratch::file("capture.pcapng", octets);
    let path = scratch::constant("path-of-capture.csv", b"t_s,x_m,y_m\n0,0,0\n5,10,0\n4000000000,20,10\n");
    let form = FormOptions { path: Some(path), ..FormOptions::default() };
    let options = ReadOptions { form, ..ReadOptions::default() };
    if let Ok(read) = sextant_logs::read(&capture, &options) {
        log_is_sound(&read);
    }
}
