//! Captures of frames: pcap and pcapng files with TAP and radiotap headers, written and read.
//!
//! What is written is read by protocol analysers: [`Capture`](crate::Capture). What is read may be of any sniffer:
//! [`read_capture`] passes on its frames, [`tap::parse`] and [`radiotap::parse`] read their headers.

mod error;
pub(crate) mod frame;
pub mod link_type;
mod parts;
mod pcap;
mod pcapng;
pub mod radiotap;
mod reader;
pub mod tap;
pub(crate) mod technologies;
pub(crate) mod writer;

pub use error::CaptureError;
pub use frame::{CaptureEnd, CaptureRecord};
pub use reader::{is_capture, read_capture};
