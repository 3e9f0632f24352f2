//! The messages of source seeking, as octets.

use sextant_sim::FieldId;

use crate::navigation::{Answer, Request};
use crate::octets::{MessageError, Reader, put};

const VERSION: u8 = 1;

const REQUEST: u8 = 1;
const ANSWER: u8 = 2;

/// A message, as octets in this layout.
///
/// All numbers are little-endian; `f32` is IEEE 754 binary32. The first octet has the version (1) in the high four bits
/// and the kind in the low four. The sender is the source address of the frame.
///
/// | kind | octets after the first |
/// | --- | --- |
/// | 1 REQUEST | a [`Request`]; 2 field |
/// | 2 ANSWER | an [`Answer`]; 2 field; 4 reading as `f32` |
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SeekMessage {
    /// A robot asks the nodes around it for their readings of a field.
    Request(Request, FieldId),
    /// A node answers with its latest reading.
    Answer(Answer, FieldId, f64),
}

impl SeekMessage {
    /// The octets of the message.
    #[must_use]
    pub(crate) fn to_octets(self) -> Vec<u8> {
        let mut octets = Vec::with_capacity(1 + Answer::OCTETS + 6);
        match self {
            Self::Request(request, field) => {
                octets.push(VERSION << 4 | REQUEST);
                request.write(&mut octets);
                octets.extend(field.0.to_le_bytes());
            }
            Self::Answer(answer, field, value) => {
                octets.push(VERSION << 4 | ANSWER);
                answer.write(&mut octets);
                octets.extend(field.0.to_le_bytes());
                put(&mut octets, value);
            }
        }
        octets
    }

    /// Reads a message.
    ///
    /// # Errors
    /// If the octets are not a message.
    pub(crate) fn read(octets: &[u8]) -> Result<Self, MessageError> {
        let mut reader = Reader::new(octets);
        let [first] = reader.take("the header")?;
        if first >> 4 != VERSION {
            return Err(MessageError::Version(first >> 4));
        }
        let message = match first & 0xF {
            REQUEST => {
                let request = Request::read(&mut reader)?;
                Self::Request(request, FieldId(reader.u16("the field")?))
            }
            ANSWER => {
                let answer = Answer::read(&mut reader)?;
                let field = FieldId(reader.u16("the field")?);
                Self::Answer(answer, field, reader.number("the reading")?)
            }
            found => return Err(MessageError::Kind { found, allowed: "1 and 2" }),
        };
        reader.end()?;
        Ok(message)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_channel::{Dbm, Position};

    use super::*;
    use crate::navigation::any as polls;

    fn message() -> impl Strategy<Value = SeekMessage> {
        let field = || any::<u16>().prop_map(FieldId);
        prop_oneof![
            (polls::request(), field()).prop_map(|(request, field)| SeekMessage::Request(request, field)),
            (polls::answer(), field(), polls::number())
                .prop_map(|(answer, field, value)| SeekMessage::Answer(answer, field, value)),
        ]
    }

    proptest! {
        #[test]
        fn a_message_is_read_as_it_was_written(message in message(), more in any::<u8>()) {
            let mut octets = message.to_octets();
            prop_assert_eq!(SeekMessage::read(&octets), Ok(message));
            let size = octets.len();
            for end in 0..size {
                let is_truncated = matches!(SeekMessage::read(&octets[..end]), Err(MessageError::Truncated { .. }));
                prop_assert!(is_truncated, "{} of {} octets", end, size);
            }
            octets.push(more);
            prop_assert_eq!(SeekMessage::read(&octets), Err(MessageError::TooLong(1)));
        }
    }

    #[test]
    fn an_answer_has_25_octets_in_the_documented_order() {
        let answer = Answer { number: 0x0201, place: Position::new(1.0, -2.0, 0.5), tx_power: Dbm(-50.0) };
        let octets = SeekMessage::Answer(answer, FieldId(3), 9.0).to_octets();
        let numbers = [1.0_f32, -2.0, 0.5, -50.0].map(f32::to_le_bytes).concat();
        let expected = [&[0x12, 1, 2][..], &numbers, &[3, 0], &9.0_f32.to_le_bytes()].concat();
        assert_eq!((octets.len(), &octets), (25, &expected));
        assert_eq!(SeekMessage::read(&[0x22]), Err(MessageError::Version(2)));
        assert_eq!(SeekMessage::read(&[0x13]), Err(MessageError::Kind { found: 3, allowed: "1 and 2" }));
    }
}
