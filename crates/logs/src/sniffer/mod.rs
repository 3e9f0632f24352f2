//! Captures of sniffers as logs of real robots: pcap and pcapng files with frames of IEEE 802.15.4 or 802.11.
//!
//! Input: captures of a sniffer on the robot, and the path of the robot. Output: a reception log in which each frame that
//! names its sender is a packet of this node. Frames that are sent again are packets too: they were received. A capture is
//! read twice from start to end, with one frame in memory: first for the PANs, then for the packets.

mod contents;
mod ieee80211;
mod sender;
mod skipped;

use std::collections::BTreeSet;
use std::path::{Path as FilePath, PathBuf};

use sextant_kernel::SimTime;
use sextant_kernel::text::choices;
use sextant_recording::capture::{self, CaptureEnd, CaptureError, CaptureRecord, link_type};

use self::sender::{HeardFrame, PanNames, Sender, SenderAddress};
use self::skipped::{FrameCount, Skipped};
use crate::error::robot_log_error::RobotLogError;
use crate::error::sniffer_error::SnifferError;
use crate::options::sniffer_options::{FcsField, SnifferOptions};
use crate::packets::gatherer::Gatherer;
use crate::packets::packet::Packet;
use crate::packets::reciprocal::Roles;

pub(super) use self::contents::contents;
pub use self::contents::{CaptureContents, CapturedLink, CapturedSender};

/// Whether the file `path` is a capture.
#[must_use]
pub(super) fn is_capture(path: &FilePath) -> bool {
    path.is_file() && capture::is_capture(path)
}

/// Gives the packets of `captures` to `gatherer`. If roles are turned, each capture is that of a receiver with the name of the
/// file.
///
/// # Errors
/// If a capture cannot be read or is of another technology, or two would be of one receiver.
pub(super) fn read(
    captures: &[PathBuf],
    options: &SnifferOptions,
    roles: &mut Roles,
    gatherer: &mut Gatherer,
    notes: &mut Vec<String>,
) -> Result<(), RobotLogError> {
    let mut pans = BTreeSet::new();
    for capture in captures {
        frames::<SnifferError>(capture, options, &mut |_, frame| {
            if let Ok(HeardFrame { sender: Sender { pan, address: SenderAddress::Short(_) }, .. }) = frame {
                pans.insert(pan);
            }
            Ok(())
        })?;
    }
    let pan_names = if pans.len() > 1 { PanNames::Several } else { PanNames::One };
    if pan_names == PanNames::Several {
        let names: Vec<_> =
            pans.iter().map(|pan| pan.map_or("none".to_owned(), |pan| format!("{pan:#06x}"))).collect();
        notes.push(format!(
            "the frames are of several PANs ({}): nodes with a short address are named PAN/ADDRESS; option `pan` chooses one",
            choices(&names)
        ));
    }
    let mut receivers = BTreeSet::new();
    for capture in captures {
        let receiver = capture.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if matches!(roles, Roles::Turned(_)) && !receivers.insert(receiver.clone()) {
            let problem = format!(
                "two captures are of the receiver `{receiver}`: with option `reciprocal`, the name of a file is that \
                of its receiver"
            );
            return Err(RobotLogError::Form { problem });
        }
        notes.extend(gather(capture, pan_names, options, roles, &receiver, gatherer)?);
    }
    Ok(())
}

/// Gives the packets of a capture to `gatherer`. Returns what the user should know.
fn gather(
    capture: &FilePath,
    pans: PanNames,
    options: &SnifferOptions,
    roles: &mut Roles,
    receiver: &str,
    gatherer: &mut Gatherer,
) -> Result<Vec<String>, RobotLogError> {
    let mut count = FrameCount::default();
    let mut name = String::new();
    let end = frames::<RobotLogError>(capture, options, &mut |time, frame| {
        count.take(&frame);
        let Ok(HeardFrame { sender, rssi_dbm }) = frame else { return Ok(()) };
        name.clear();
        sender.write(pans, &mut name).expect("a string grows");
        let node = match roles {
            Roles::Usual => &name,
            Roles::Turned(transmitter) => {
                let is_wanted = transmitter.is_the_one(&name);
                let problem =
                    |problem| RobotLogError::Form { problem: format!("`{}`: {problem}", capture.display()) };
                if !is_wanted.map_err(problem)? {
                    return Ok(());
                }
                receiver
            }
        };
        gatherer.take(Packet { rssi_dbm, ..Packet::new(time, node) })
    })?;
    let reasons = count.reasons();
    let mut skipped = if reasons.is_empty() { String::new() } else { format!("; skipped: {reasons}") };
    if count.is_mostly_wrong() {
        skipped.push_str(". ");
        skipped.push_str(match options.fcs {
            Some(FcsField::Ti { .. }) => {
                "With `fcs=ti` the last octet of a frame must say that its check sequence was right: the sniffer has another chip"
            }
            _ => OTHER_VALUES,
        });
    }
    if count.used() == 0 {
        return Err(SnifferError::NoFrames { path: capture.to_owned(), skipped }.into());
    }
    let shown = capture.display();
    let mut notes = vec![format!("`{shown}`: {} frames are packets{skipped}", count.used())];
    if let Some(FcsField::Ti { offset_db }) = options.fcs {
        notes.push(format!(
            "`{shown}`: strengths are the RSSI that a chip of Texas Instruments wrote in the place of the FCS, {offset_db:+} dB \
             (a CC2530, CC2531 or CC2538 has -73, a CC2420 -45, a CC2520 -76: `fcs=ti:-45`)"
        ));
    }
    if end == CaptureEnd::Truncated {
        notes.push(format!("`{shown}` ends in the middle of a packet, as after a crash of the sniffer"));
    }
    Ok(notes)
}

/// What helps if most check sequences are wrong.
const OTHER_VALUES: &str = "Some sniffers put other values in the place of the FCS. Those with a chip of Texas Instruments write \
     the RSSI there: `fcs=ti`. Of others the frames can be used without strengths: `fcs=none`. Or save the frames without FCS \
     (link type 230) or with TAP headers (283)";

/// Refuses a capture whose first frame is of another technology.
pub(super) fn check_link(capture: &FilePath) -> Result<(), SnifferError> {
    /// The first frame, or an error.
    enum First {
        Seen,
        Refused(SnifferError),
    }
    impl From<SnifferError> for First {
        fn from(why: SnifferError) -> Self {
            Self::Refused(why)
        }
    }
    impl From<CaptureError> for First {
        fn from(why: CaptureError) -> Self {
            Self::Refused(why.into())
        }
    }
    match frames::<First>(capture, &SnifferOptions::default(), &mut |_, _| Err(First::Seen)) {
        Err(First::Refused(why)) => Err(why),
        Err(First::Seen) | Ok(_) => Ok(()),
    }
}

/// Calls `visit` with the time and the sender of each frame, of the PAN of `options` only if it is given.
fn frames<E: From<SnifferError> + From<CaptureError>>(
    capture: &FilePath,
    options: &SnifferOptions,
    visit: &mut dyn FnMut(SimTime, Result<HeardFrame, Skipped>) -> Result<(), E>,
) -> Result<CaptureEnd, E> {
    let (pan, fcs) = (options.pan, options.fcs.unwrap_or(FcsField::Checked));
    capture::read_capture::<E>(capture, &mut |CaptureRecord { time, link, octets, is_cut }| {
        let frame = sender::heard(link, octets, is_cut, fcs).ok_or_else(|| SnifferError::UnknownLink {
            path: capture.to_owned(),
            link,
            name: link_type::name(link),
        })?;
        let is_wanted = |heard: &HeardFrame| pan.is_none() || heard.sender.pan == pan;
        let frame = frame.and_then(|heard| if is_wanted(&heard) { Ok(heard) } else { Err(Skipped::OtherPan) });
        match time {
            Some(time) => visit(time, frame),
            None => visit(SimTime::ZERO, frame.and(Err(Skipped::NoTime))),
        }
    })
}
