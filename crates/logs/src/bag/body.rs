//! The octets of a message: CDR of ROS 2 (OMG DDS-RTPS 2.5, clause 10; OMG CORBA 3.3, part 2, clause 9.3), or the
//! serialization of ROS 1.

use super::definition::{Dialect, Number};

/// The octets of a message from a place on. Places count from the start of the body, after the encapsulation header.
#[derive(Clone, Copy, Debug)]
pub(super) struct MessageBody<'a> {
    octets: &'a [u8],
    at: usize,
    is_big_endian: bool,
    dialect: Dialect,
}

/// The message ends before a value that its definition has.
const TOO_SHORT: &str = "the message is shorter than its definition says";

impl<'a> MessageBody<'a> {
    /// The body of a message.
    ///
    /// # Errors
    /// If its encoding is not known.
    pub(super) fn new(dialect: Dialect, data: &'a [u8]) -> Result<Self, String> {
        let (octets, is_big_endian) = match (dialect, data) {
            (Dialect::Ros1, _) => (data, false),
            (Dialect::Ros2, [0, order @ (0 | 1), _, _, octets @ ..]) => (octets, *order == 0),
            (Dialect::Ros2, [high, low, _, _, ..]) => {
                let found = u16::from_be_bytes([*high, *low]);
                return Err(format!("its encapsulation is {found:#06x}; allowed: 0x0000 and 0x0001 (CDR)"));
            }
            (Dialect::Ros2, _) => return Err(TOO_SHORT.to_owned()),
        };
        Ok(Self { octets, at: 0, is_big_endian, dialect })
    }

    /// Number of octets that are left.
    pub(super) fn left(&self) -> usize {
        self.octets.len() - self.at
    }

    /// The next `count` octets.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let taken = self.octets[self.at..].get(..count).ok_or(TOO_SHORT)?;
        self.at += count;
        Ok(taken)
    }

    /// Skips `count` numbers that follow each other.
    pub(super) fn skip(&mut self, number: Number, count: usize) -> Result<(), String> {
        if count == 0 {
            return Ok(());
        }
        self.align(number.octets())?;
        self.take(count.checked_mul(number.octets()).ok_or(TOO_SHORT)?).map(drop)
    }

    /// The next octets, after the padding that a number of their size has before it, low octet first.
    pub(super) fn little<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.align(N)?;
        let mut octets = [0; N];
        octets.copy_from_slice(self.take(N)?);
        if self.is_big_endian {
            octets.reverse();
        }
        Ok(octets)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.little().map(u32::from_le_bytes)
    }

    /// The length of a sequence, of which each element has at least one octet.
    pub(super) fn length(&mut self) -> Result<usize, String> {
        let length = self.u32()? as usize;
        self.fits(length)
    }

    /// `length`, if so many elements can be left.
    pub(super) fn fits(&self, length: usize) -> Result<usize, String> {
        if length > self.left() {
            return Err(format!("it has a list of {length} values, but only {} octets follow", self.left()));
        }
        Ok(length)
    }

    /// The octets of a string, without the zero at its end.
    pub(super) fn text(&mut self) -> Result<&'a [u8], String> {
        let length = self.length()?;
        let octets = self.take(length)?;
        Ok(match (self.dialect, octets) {
            (Dialect::Ros2, [text @ .., 0]) => text,
            (_, text) => text,
        })
    }

    fn align(&mut self, octets: usize) -> Result<(), String> {
        if self.dialect == Dialect::Ros2 {
            let padding = self.at.next_multiple_of(octets) - self.at;
            self.take(padding)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_from_the_start_of_the_body_in_ros_2_only() {
        let data = [0, 1, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0];
        let mut body = MessageBody::new(Dialect::Ros2, &data).unwrap();
        assert_eq!(body.take(1).unwrap(), [7]);
        assert_eq!(body.u32(), Ok(1));
        assert_eq!(body.little().map(u64::from_le_bytes), Ok(2));
        assert_eq!(body.left(), 0);
        let mut body = MessageBody::new(Dialect::Ros1, &[7, 1, 0, 0, 0]).unwrap();
        assert_eq!(body.take(1).unwrap(), [7]);
        assert_eq!(body.u32(), Ok(1));
    }

    #[test]
    fn both_byte_orders_are_read() {
        let mut body = MessageBody::new(Dialect::Ros2, &[0, 0, 0, 0, 0, 0, 1, 2]).unwrap();
        assert_eq!(body.u32(), Ok(0x0102));
        let mut body = MessageBody::new(Dialect::Ros2, &[0, 1, 0, 0, 2, 1, 0, 0]).unwrap();
        assert_eq!(body.u32(), Ok(0x0102));
    }

    #[test]
    fn a_message_that_is_too_short_or_encoded_otherwise_is_an_error() {
        assert_eq!(MessageBody::new(Dialect::Ros2, &[0, 1]).unwrap_err(), TOO_SHORT);
        let xcdr2 = MessageBody::new(Dialect::Ros2, &[0, 7, 0, 0, 0]).unwrap_err();
        assert_eq!(xcdr2, "its encapsulation is 0x0007; allowed: 0x0000 and 0x0001 (CDR)");
        let mut long = MessageBody::new(Dialect::Ros2, &[0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]).unwrap();
        assert_eq!(long.text().unwrap_err(), "it has a list of 4294967295 values, but only 0 octets follow");
    }
}
