//! What a mission is after.

use sextant_sim::FieldId;

/// What a mission is after; it is scored by how far it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissionGoal {
    /// The targets of the world: it is over when all are captured.
    Targets,
    /// A place in a field.
    Field(SoughtField),
    /// A link that robots keep: it is over when their way is.
    Link,
    /// Neither: it is scored by nothing but what its stations count.
    Other,
}

/// The place in a field that a mission seeks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoughtField {
    /// The field.
    pub field: FieldId,
    /// The value that it wants to reach, in the unit of the field; `None` if it is the source itself.
    pub level: Option<f64>,
    /// The value at which a robot has arrived: the level less its tolerance.
    pub arrival_value: Option<f64>,
    /// The rate at which the value rises far below the level (1/s), if the law has a fixed one.
    pub climb_rate: Option<f64>,
}

impl MissionGoal {
    /// Whether it searches targets.
    #[must_use]
    pub fn is_targets(&self) -> bool {
        matches!(self, Self::Targets)
    }

    /// Whether its robots keep a link.
    #[must_use]
    pub fn is_link(&self) -> bool {
        matches!(self, Self::Link)
    }

    /// The place in a field that it seeks, if it does.
    #[must_use]
    pub fn field(&self) -> Option<SoughtField> {
        match self {
            Self::Field(sought) => Some(*sought),
            Self::Targets | Self::Link | Self::Other => None,
        }
    }
}
