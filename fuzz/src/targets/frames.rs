//! Frames as octets.

use sextant_logs::{FormOptions, ReadOptions};
use sextant_mac::dmg::{Enclosed, SweepBody, SweepFrame, beacon_payload, brp_measurements};
use sextant_mac::frame::{Frame, Header};

use crate::scratch;

/// Link types of captures: radiotap, 802.15.4 with and without its check sequence, and TAP.
const LINKS: [u32; 4] = [127, 195, 230, 283];

/// Frames that are read are written as octets that read the same. A capture with the frame is read or refused.
pub(crate) fn check(octets: &[u8]) {
    frame(octets);
    sweep_frame(octets);
    captured(octets);
}

fn frame(octets: &[u8]) {
    let header = Header::parse(octets);
    let Ok(frame) = Frame::parse(octets) else { return };
    let header = header.expect("the header of a frame can be read");
    assert_eq!(header.sequence, Some(frame.sequence), "the sequence number of a frame and of its header");
    assert_eq!(header.source.map(|source| source.address), frame.source.map(|source| source.address));
    let mut written = Vec::new();
    if frame.write(&mut written).is_ok() {
        assert_eq!(Frame::parse(&written).as_ref(), Ok(&frame), "a frame that is written reads as another one");
    }
}

fn sweep_frame(octets: &[u8]) {
    let Ok(frame) = SweepFrame::parse(octets) else { return };
    let measurements = brp_measurements(octets).unwrap_or_default();
    let payload = beacon_payload(octets).unwrap_or_default();
    let enclosed = match frame.body {
        SweepBody::Beacon { .. } => Enclosed::Payload(&payload),
        SweepBody::Brp { .. } => Enclosed::Measurements(&measurements),
        _ => Enclosed::Nothing,
    };
    let mut written = Vec::new();
    frame.write(enclosed, &mut written);
    assert_eq!(
        SweepFrame::parse(&written).as_ref(),
        Ok(&frame),
        "a sweep frame that is written reads as another one"
    );
}

/// The octets as the only packet of a capture, of a link type that they choose.
fn captured(octets: &[u8]) {
    let (Ok(length), Some(&last)) = (u32::try_from(octets.len()), octets.last()) else { return };
    let link = LINKS[usize::from(last) % LINKS.len()];
    let words = [0xA1B2_C3D4, 0x0004_0002, 0, 0, 0xFFFF, link, 0, 500_000, length, length];
    let mut capture: Vec<u8> = words.iter().flat_map(|word: &u32| word.to_le_bytes()).collect();
    capture.extend(octets);
    let path = scratch::constant("path.csv", b"t_s,x_m,y_m\n0,0,0\n1,1,0\n");
    let form = FormOptions { path: Some(path), ..FormOptions::default() };
    let options = ReadOptions { form, ..ReadOptions::default() };
    if let Ok(read) = sextant_logs::read(&scratch::file("frame.pcap", &capture), &options) {
        let heard: u64 = read.log.receptions().iter().map(|reception| u64::from(reception.received)).sum();
        assert!(heard <= 1, "one frame is {heard} packets");
    }
}
