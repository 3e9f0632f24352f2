//! What the user says of a capture.

use std::str::FromStr;

/// What belongs to the capture of a sniffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SnifferOptions {
    /// Use only frames of this IEEE 802.15.4 PAN, 0xabcd for example. The default is all; nodes with a short address are then
    /// named with their PAN if the capture has several
    pub pan: Option<u16>,
    /// What stands at the end of frames of link type 195, in the place of their check sequence. The default is the check
    /// sequence
    pub fcs: Option<FcsField>,
}

/// What stands at the end of captured frames of IEEE 802.15.4, in the place of their check sequence (FCS).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FcsField {
    /// The check sequence itself, of two octets. Frames with a wrong one are skipped.
    Checked,
    /// Nothing that can be checked.
    None,
    /// What receivers of Texas Instruments write there: an octet of RSSI, and one with the bit that tells whether the check
    /// sequence was right.
    Ti {
        /// What is added to their RSSI to make it dBm (dB).
        offset_db: f64,
    },
}

/// What is added to the RSSI of a CC2530, CC2531 or CC2538 (dB); of a CC2420 it is -45, of a CC2520 -76 (data sheets SWRS081,
/// SWRU319, SWRS041 and SWRS068).
const USUAL_OFFSET_DB: f64 = -73.0;

impl FromStr for FcsField {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const ALLOWED: &str = "expected `checked`, `none` or `ti`: the RSSI of a chip of Texas Instruments, of a CC2531; of other \
             chips with what is added to make it dBm, `ti:-45` (CC2420), `ti:-76` (CC2520), `ti:0` (sniffers that did it)";
        let text = text.trim().to_lowercase();
        Ok(match text.split_once(':') {
            None if text == "checked" => Self::Checked,
            None if text == "none" => Self::None,
            None if text == "ti" => Self::Ti { offset_db: USUAL_OFFSET_DB },
            Some(("ti", offset)) => {
                let offset_db = offset.parse().ok().filter(|offset_db| (-150.0..=50.0).contains(offset_db));
                Self::Ti { offset_db: offset_db.ok_or(ALLOWED)? }
            }
            _ => return Err(ALLOWED),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_frames_is_named_in_words() {
        for (text, expected) in [
            ("checked", Ok(FcsField::Checked)),
            ("none", Ok(FcsField::None)),
            ("TI", Ok(FcsField::Ti { offset_db: -73.0 })),
            ("ti:-45", Ok(FcsField::Ti { offset_db: -45.0 })),
            ("ti:0", Ok(FcsField::Ti { offset_db: 0.0 })),
        ] {
            assert_eq!(text.parse(), expected, "{text}");
        }
        for text in ["", "ti:", "ti:far", "ti:nan", "ti:-300", "cc2531"] {
            assert!(text.parse::<FcsField>().unwrap_err().contains("`ti:-45` (CC2420)"), "{text}");
        }
    }
}
