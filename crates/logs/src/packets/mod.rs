//! Packets that robots heard, and the reception log that is gathered from them.

mod cover;
pub(crate) mod gathered;
pub(crate) mod gatherer;
mod heard;
mod interval;
pub(crate) mod packet;
pub(crate) mod packet_table;
mod path_ranges;
pub(crate) mod reciprocal;
pub(crate) mod rssi_check;
pub(crate) mod sending;
pub(crate) mod signal;
pub(crate) mod strengths;
