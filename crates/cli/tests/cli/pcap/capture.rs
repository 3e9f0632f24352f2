//! A small capture, octet by octet.

use std::path::Path;
use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;
use sextant_recording::{Capture, CapturedFrame, Signal, Technologies};

use super::packet;

/// An acknowledgement and a data frame. Their check sequences are correct according to tshark 4.0.
const ACK: &[u8] = &[0x02, 0x00, 0x05, 0x15, 0xE2];
const DATA: &[u8] = &[0x61, 0x88, 0x05, 0x34, 0x12, 0x00, 0x00, 0x07, 0x00, 0x68, 0x65, 0x6C, 0x6C, 0x6F, 0x87, 0x88];

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<_> = text.chars().filter(|c| !c.is_whitespace()).collect();
    let octet = |pair: &[char]| u8::from_str_radix(&pair.iter().collect::<String>(), 16).unwrap();
    digits.chunks(2).map(octet).collect()
}

fn captured(channel: u8, frames: &[CapturedFrame<'_>]) -> Vec<u8> {
    let mut capture = Capture::new(Vec::new(), Path::new("a.pcap"), Technologies::Ieee802154).unwrap();
    for frame in frames {
        capture.frame(&CapturedFrame { channel, ..*frame }).unwrap();
    }
    capture.into_output().unwrap()
}

fn received(dbm: f64, mpdu: &[u8]) -> CapturedFrame<'_> {
    let signal = Signal { power: Dbm(dbm), sensitivity: Dbm(-100.0) };
    let airtime = Duration::from_micros(352);
    CapturedFrame {
        start: SimTime::from_nanos(2_123_456_789),
        airtime,
        mpdu,
        channel: 11,
        page: 0,
        signal: Some(signal),
    }
}

#[test]
fn a_capture_of_one_frame_has_the_octets_of_the_format() {
    // Numbers packed with Python's `struct`.
    // An RSS of -81.5 dBm is 0xC2A30000; 18.5 of 40 dB above the sensitivity is an LQI of 118. The end is 2.123808789 s.
    let expected = "4d3cb2a1 0200 0400 00000000 00000000 ffff0000 1b010000
        02000000 152c6107 41000000 41000000
        00003c00 0000010001000000 010004000000a3c2 030003000f000000
        050008001561917e00000000 0600080015c0967e00000000 0a00010076000000
        02000515e2";
    assert_eq!(captured(15, &[received(-81.5, ACK)]), hex(expected));
}

#[test]
fn a_frame_without_a_receiver_has_neither_strength_nor_quality() {
    let frame = CapturedFrame { signal: None, ..received(0.0, DATA) };
    let [packet] = &packet::read(&captured(26, &[frame]))[..] else { panic!("one packet") };
    assert_eq!(packet.fields.keys().copied().collect::<Vec<_>>(), [0, 3, 5, 6]);
    assert_eq!((packet.channel(), packet.mpdu.as_slice()), ((26, 0), DATA));
    assert_eq!(packet.span_ns(), (2_123_456_789, 2_123_808_789));
    assert_eq!(packet.stamp_ns, 2_123_808_789);
    assert!(packet.has_good_fcs());
}

#[test]
fn link_quality_rises_from_the_sensitivity_to_40_db_above_it() {
    for (dbm, quality) in [(-130.0, 0), (-100.0, 0), (-90.0, 64), (-80.0, 128), (-60.0, 255), (-10.0, 255)] {
        let file = captured(11, &[received(dbm, ACK)]);
        assert_eq!(packet::read(&file)[0].link_quality(), Some(quality), "{dbm} dBm");
    }
}
