//! The frame check sequence.

/// CRC-16 of IEEE 802.15.4 over `octets` (2006, 7.2.1.9): polynomial x^16 + x^12 + x^5 + 1, start 0,
/// least significant bit first. It goes on the air low octet first.
///
/// ```
/// assert_eq!(sextant_mac::fcs(b"123456789"), 0x2189);
/// ```
#[must_use]
pub fn fcs(octets: &[u8]) -> u16 {
    octets.iter().fold(0, |crc, &octet| (crc >> 8) ^ TABLE[usize::from((crc ^ u16::from(octet)) & 0xFF)])
}

/// Remainder of each octet.
const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut octet = 0;
    while octet < 256 {
        let mut crc = octet;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0x8408 } else { crc >> 1 };
            bit += 1;
        }
        table[octet as usize] = crc;
        octet += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_standard_and_the_catalogue_hold() {
        assert_eq!(fcs(&[]), 0);
        assert_eq!(fcs(b"123456789"), 0x2189);
        assert_eq!(fcs(&[0x02, 0x00, 0x6A]).to_le_bytes(), [0xE4, 0x79]);
        assert_eq!(fcs(&[0x02, 0x00, 0x56]).to_le_bytes(), [0x0B, 0x82]);
    }

    #[test]
    fn every_single_and_double_bit_error_of_the_longest_frame_is_detected() {
        // The code is linear, so an error pattern is missed exactly if its own remainder is 0.
        let mut error = [0_u8; 127];
        for first in 0..127 * 8 {
            error[first / 8] ^= 1 << (first % 8);
            assert_ne!(fcs(&error), 0);
            for second in 0..first {
                error[second / 8] ^= 1 << (second % 8);
                assert_ne!(fcs(&error), 0);
                error[second / 8] ^= 1 << (second % 8);
            }
            error[first / 8] ^= 1 << (first % 8);
        }
    }
}
