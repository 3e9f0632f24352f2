//! What a capture has: its frames, when they were heard, and of whom.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::Serialize;
use sextant_kernel::SimTime;
use sextant_kernel::text::{counted, printable};
use sextant_recording::capture::{CaptureEnd, CaptureRecord, link_type, read_capture};

use super::sender::{self, PanNames, SenderAddress};
use super::skipped::{FrameCount, Skipped};
use crate::error::sniffer_error::SnifferError;
use crate::options::sniffer_options::{FcsField, SnifferOptions};
use crate::time::instant;

/// What a capture has.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CaptureContents {
    /// Number of frames.
    pub frames: u64,
    /// Whether it ends in the middle of a packet.
    pub is_cut: bool,
    /// When its first frame was heard (date and time in UTC); absent if no frame has a time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<String>,
    /// When its last frame was heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last: Option<String>,
    /// The link types of its frames.
    pub links: Vec<CapturedLink>,
    /// Frames that say nothing of a node, and why; empty if there are none.
    pub skipped: String,
    /// Who was heard, by name.
    pub senders: Vec<CapturedSender>,
}

/// A link type of a capture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CapturedLink {
    /// Its number.
    pub link: u16,
    /// What it is.
    pub name: &'static str,
    /// Number of its frames.
    pub frames: u64,
}

/// Somebody who was heard.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CapturedSender {
    /// The name, as `map` names nodes.
    pub node: String,
    /// Number of frames.
    pub frames: u64,
    /// Mean strength of those that have one (dBm).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rssi_dbm: Option<f64>,
}

/// Frames of a sender, those with a strength, and the sum of the strengths.
#[derive(Clone, Copy, Default)]
struct Sum {
    frames: u64,
    measured: u64,
    sum_dbm: f64,
}

/// What the capture `path` has.
///
/// # Errors
/// If it cannot be read, or is damaged.
pub(in super::super) fn contents(path: &Path, options: &SnifferOptions) -> Result<CaptureContents, SnifferError> {
    let mut found = CaptureContents::default();
    let mut of_links: BTreeMap<u16, u64> = BTreeMap::new();
    let mut of_senders: BTreeMap<(Option<u16>, String), Sum> = BTreeMap::new();
    let mut count = FrameCount::default();
    let mut span: Option<(SimTime, SimTime)> = None;
    let fcs = options.fcs.unwrap_or(FcsField::Checked);
    let end = read_capture::<SnifferError>(path, &mut |CaptureRecord { time, link, octets, is_cut }| {
        found.frames += 1;
        *of_links.entry(link).or_default() += 1;
        if let Some(time) = time {
            span = Some(span.map_or((time, time), |(first, last)| (first.min(time), last.max(time))));
        }
        let Some(frame) = sender::heard(link, octets, is_cut, fcs) else { return Ok(()) };
        let is_wanted = |pan: Option<u16>| options.pan.is_none() || pan == options.pan;
        let frame =
            frame.and_then(|heard| if is_wanted(heard.sender.pan) { Ok(heard) } else { Err(Skipped::OtherPan) });
        count.take(&frame);
        let Ok(heard) = frame else { return Ok(()) };
        // Short addresses are unique within their network.
        let is_short = matches!(heard.sender.address, SenderAddress::Short(_));
        let mut name = String::new();
        heard.sender.write(PanNames::One, &mut name).expect("a string grows");
        let sum = of_senders.entry((heard.sender.pan.filter(|_| is_short), name)).or_default();
        sum.frames += 1;
        if let Some(level) = heard.rssi_dbm {
            sum.measured += 1;
            sum.sum_dbm += level;
        }
        Ok(())
    })?;
    let date = |time: SimTime| instant::format_date(i64::try_from(time.as_nanos()).unwrap_or(i64::MAX));
    found.is_cut = end == CaptureEnd::Truncated;
    (found.first, found.last) = span.map(|(first, last)| (date(first), date(last))).unzip();
    found.links = of_links
        .into_iter()
        .map(|(link, frames)| CapturedLink { link, name: link_type::name(link), frames })
        .collect();
    found.skipped = count.reasons();
    let mut pans: Vec<_> = of_senders.keys().filter_map(|(pan, _)| *pan).collect();
    pans.dedup();
    let named = |((pan, name), sum): ((Option<u16>, String), Sum)| CapturedSender {
        node: pan.filter(|_| pans.len() > 1).map_or_else(|| name.clone(), |pan| format!("{pan:#06x}/{name}")),
        frames: sum.frames,
        rssi_dbm: (sum.measured > 0).then(|| sum.sum_dbm / sum.measured as f64),
    };
    found.senders = of_senders.into_iter().map(named).collect();
    Ok(found)
}

impl fmt::Display for CaptureContents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, is_cut, first, last, links, skipped, senders } = self;
        write!(f, "a capture of {frames} frames")?;
        if let (Some(first), Some(last)) = (first, last) {
            write!(f, " from {first} to {last}")?;
        }
        writeln!(f, "{}", if *is_cut { "; it ends in the middle of a packet" } else { "" })?;
        for CapturedLink { link, name, frames } in links {
            writeln!(f, "  link type {link} ({name}): {frames} frames")?;
        }
        if !skipped.is_empty() {
            writeln!(f, "  of no node: {skipped}")?;
        }
        if !senders.is_empty() {
            writeln!(f, "{} heard:", counted(senders.len(), "node"))?;
        }
        let width = senders.iter().map(|sender| sender.node.chars().count()).max().unwrap_or(0);
        for CapturedSender { node, frames, rssi_dbm } in senders {
            let level = rssi_dbm.map_or_else(String::new, |level| format!("  {level:.1} dBm"));
            writeln!(f, "  {:<width$}  {frames:>7} frames{level}", printable(node))?;
        }
        Ok(())
    }
}
