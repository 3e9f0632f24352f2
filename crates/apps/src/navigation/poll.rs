//! Polls: a robot asks the nodes around it, and they answer one after the other.

use std::time::Duration;

use sextant_channel::{Dbm, Position};

use crate::octets::{MessageError, Reader, put, put_place};

/// The question of a robot. As octets:
///
/// | octets | field |
/// | --- | --- |
/// | 2 | number of the poll |
/// | 2 | window in which nodes answer (ms) |
/// | 1 | 1 if a disc follows, otherwise 0 |
/// | 16 | with a disc: its centre x, y, z, and its radius, on the map, as `f32` |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Number of the poll; after 65535 comes 0.
    pub number: u16,
    /// The time in which nodes answer, each at a random instant; whole milliseconds, below 65.536 s.
    pub window: Duration,
    /// Centre and radius of the disc on the map whose nodes are asked (m); all that hear the request if absent.
    pub near: Option<(Position, f64)>,
}

/// What each node that answers tells of itself. As octets:
///
/// | octets | field |
/// | --- | --- |
/// | 2 | number of the poll |
/// | 12 | place of the node on the map: x, y, z as `f32` |
/// | 4 | its transmit power (dBm) as `f32` |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Number of the poll.
    pub number: u16,
    /// Where the node is on the map (m).
    pub place: Position,
    /// Its transmit power.
    pub tx_power: Dbm,
}

impl Request {
    /// Whether a node at `place` on the map is asked.
    #[must_use]
    pub fn concerns(&self, place: Position) -> bool {
        self.near.is_none_or(|(center, radius_m)| center.distance_m(place) <= radius_m)
    }

    pub(crate) fn write(&self, octets: &mut Vec<u8>) {
        octets.extend(self.number.to_le_bytes());
        let window_ms = u16::try_from(self.window.as_millis()).expect("a window is shorter than 65.536 s");
        octets.extend(window_ms.to_le_bytes());
        octets.push(self.near.is_some().into());
        if let Some((center, radius_m)) = self.near {
            put_place(octets, center);
            put(octets, radius_m);
        }
    }

    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Self, MessageError> {
        let (number, window_ms) = (reader.u16("the request")?, reader.u16("the request")?);
        let near = match reader.take("the request")? {
            [0] => None,
            _ => Some((reader.place("the disc")?, reader.number("the disc")?)),
        };
        Ok(Self { number, window: Duration::from_millis(window_ms.into()), near })
    }
}

impl Answer {
    /// Its octets.
    pub(crate) const OCTETS: usize = 18;

    pub(crate) fn write(&self, octets: &mut Vec<u8>) {
        octets.extend(self.number.to_le_bytes());
        put_place(octets, self.place);
        put(octets, self.tx_power.0);
    }

    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Self, MessageError> {
        let number = reader.u16("the answer")?;
        let place = reader.place("the place")?;
        Ok(Self { number, place, tx_power: Dbm(reader.number("the transmit power")?) })
    }
}
