//! The transmitter of a frame of IEEE 802.11.

use super::skipped::Skipped;

/// A MAC address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct MacAddress(pub(super) [u8; 6]);

const MANAGEMENT: u8 = 0;
const CONTROL: u8 = 1;
const DATA: u8 = 2;
const EXTENSION: u8 = 3;

/// Where the second address of a frame is: after frame control, duration and the first address.
const SECOND: usize = 10;
/// Where the only address of a beacon of a directional multi-gigabit network is.
const FIRST: usize = 4;

/// The transmitter of `frame` (IEEE 802.11-2020, 9.3).
pub(super) fn transmitter(frame: &[u8]) -> Result<MacAddress, Skipped> {
    let [control, high, ..] = *frame else { return Err(Skipped::TooShort) };
    if control & 3 != 0 {
        return Err(Skipped::Invalid);
    }
    let at = match (control >> 2 & 3, control >> 4) {
        (MANAGEMENT | DATA, _) => SECOND,
        // Control frame extensions, except DTS, whose transmitter is not told.
        (CONTROL, 6) if high & 0xF != 6 => SECOND,
        // Trigger, beamforming report poll, NDP announcement, block acknowledgement and its request, PS-Poll, RTS, CF-End and its acknowledgement.
        (CONTROL, 2 | 4 | 5 | 8 | 9 | 10 | 11 | 14 | 15) => SECOND,
        (EXTENSION, 0) => FIRST,
        (CONTROL, _) => return Err(Skipped::NoSource),
        _ => return Err(Skipped::Invalid),
    };
    let mut address = *frame.get(at..).and_then(<[u8]>::first_chunk).ok_or(Skipped::TooShort)?;
    // In the address of a transmitter this bit tells of its bandwidth.
    address[0] &= !1;
    Ok(MacAddress(address))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transmitter_is_the_second_address_of_frames_that_have_one() {
        let mut frame = vec![0; 16];
        frame[4..10].copy_from_slice(&[1; 6]);
        frame[10..16].copy_from_slice(&[3, 2, 2, 2, 2, 2]);
        let mut of = |control: [u8; 2]| {
            frame[..2].copy_from_slice(&control);
            transmitter(&frame)
        };
        let second = Ok(MacAddress([2; 6]));
        for control in [[0x80, 0], [0x08, 1], [0x88, 0], [0xB4, 0], [0x94, 0], [0x64, 0x08]] {
            assert_eq!(of(control), second, "{control:x?}");
        }
        // A beacon of a directional network.
        assert_eq!(of([0x0C, 0]), Ok(MacAddress([0, 1, 1, 1, 1, 1])));
        // CTS, acknowledgement, DTS.
        for control in [[0xC4, 0], [0xD4, 0], [0x64, 0x06]] {
            assert_eq!(of(control), Err(Skipped::NoSource), "{control:x?}");
        }
        assert_eq!(of([0x81, 0]), Err(Skipped::Invalid));
        assert_eq!(transmitter(&[0x80, 0, 0, 0]), Err(Skipped::TooShort));
    }
}
