//! What an application works out about the world.

use sextant_channel::Position;

use super::sensed::{FieldId, TargetId};

/// What an application works out about the world. Places are in the frame of its map, which need not be that of the
/// world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimate {
    /// Where its station is.
    OwnPlace(Position),
    /// Where a target is.
    TargetPlace {
        /// The target.
        target: TargetId,
        /// Its place.
        place: Position,
    },
    /// The value of a field where the station is.
    FieldValue {
        /// The field.
        field: FieldId,
        /// The value, in the unit of the field.
        value: f64,
    },
}
