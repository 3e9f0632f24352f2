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
/// | 1 | who is asked: 0 all that hear the request, 1 those in a disc on the map, 2 those that hear it well |
/// | 16 | with 1: centre x, y, z and radius of the disc as `f32` |
/// | 4 | with 2: least power of the request (dBm) as `f32` |
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Request {
    /// Number of the poll; after 65535 comes 0.
    pub number: u16,
    /// The time in which nodes answer, each at a random instant; whole milliseconds, below 65.536 s.
    pub window: Duration,
    /// Who is asked.
    pub asked: Asked,
}

/// Which nodes a robot asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Asked {
    /// All that hear the request.
    All,
    /// Those in a disc on the map.
    Near {
        /// Its centre (m).
        center: Position,
        /// Its radius (m).
        radius_m: f64,
    },
    /// Those that receive the request with at least this power: a robot that does not know where it is on the map gets
    /// few answers, from the nodes that are near.
    Loud(Dbm),
}

/// What each node that answers tells of itself. As octets:
///
/// | octets | field |
/// | --- | --- |
/// | 2 | number of the poll |
/// | 12 | place of the node on the map: x, y, z as `f32` |
/// | 4 | its transmit power (dBm) as `f32` |
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer {
    /// Number of the poll.
    pub number: u16,
    /// Where the node is on the map (m).
    pub place: Position,
    /// Its transmit power.
    pub tx_power: Dbm,
}

impl Request {
    /// Whether a node at `place` on the map is asked that received the request with the power `rssi`.
    #[must_use]
    pub(crate) fn concerns(&self, place: Position, rssi: Dbm) -> bool {
        match self.asked {
            Asked::All => true,
            Asked::Near { center, radius_m } => center.distance_m(place) <= radius_m,
            Asked::Loud(least) => rssi.0 >= least.0,
        }
    }

    pub(crate) fn write(&self, octets: &mut Vec<u8>) {
        octets.extend(self.number.to_le_bytes());
        let window_ms = u16::try_from(self.window.as_millis()).expect("a window is shorter than 65.536 s");
        octets.extend(window_ms.to_le_bytes());
        match self.asked {
            Asked::All => octets.push(0),
            Asked::Near { center, radius_m } => {
                octets.push(1);
                put_place(octets, center);
                put(octets, radius_m);
            }
            Asked::Loud(least) => {
                octets.push(2);
                put(octets, least.0);
            }
        }
    }

    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Self, MessageError> {
        let (number, window_ms) = (reader.u16("the request")?, reader.u16("the request")?);
        let asked = match reader.take("the request")? {
            [0] => Asked::All,
            [1] => Asked::Near { center: reader.place("the disc")?, radius_m: reader.number("the disc")? },
            [2] => Asked::Loud(Dbm(reader.number("the least power")?)),
            [found] => return Err(MessageError::Kind { found, allowed: "0 to 2 for who is asked" }),
        };
        Ok(Self { number, window: Duration::from_millis(window_ms.into()), asked })
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

/// Polls for the tests of messages that carry them.
#[cfg(test)]
pub(crate) mod any {
    use proptest::prelude::*;

    use super::*;

    /// A number that binary32 holds exactly.
    pub(crate) fn number() -> impl Strategy<Value = f64> {
        any::<f32>().prop_filter("finite", |number| number.is_finite()).prop_map(f64::from)
    }

    /// A place.
    pub(crate) fn place() -> impl Strategy<Value = Position> {
        prop::array::uniform3(number()).prop_map(Position::from)
    }

    /// A request.
    pub(crate) fn request() -> impl Strategy<Value = Request> {
        let asked = prop_oneof![
            Just(Asked::All),
            (place(), number()).prop_map(|(center, radius_m)| Asked::Near { center, radius_m }),
            number().prop_map(|least_dbm| Asked::Loud(Dbm(least_dbm))),
        ];
        (any::<u16>(), any::<u16>(), asked).prop_map(|(number, window_ms, asked)| Request {
            number,
            window: Duration::from_millis(window_ms.into()),
            asked,
        })
    }

    /// An answer.
    pub(crate) fn answer() -> impl Strategy<Value = Answer> {
        (any::<u16>(), place(), number()).prop_map(|(number, place, tx_power_dbm)| Answer {
            number,
            place,
            tx_power: Dbm(tx_power_dbm),
        })
    }
}
