//! What a sensor says to the application of its node.

/// Number of a target in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TargetId(pub u16);

/// Number of a scalar field in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FieldId(pub u16);

/// What a sensor says to the application of its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sensed {
    /// A target is within the radius of detection from now on.
    Entered(TargetId),
    /// A target is not within the radius of detection any more.
    Left(TargetId),
    /// A sample of a field, with its offset and its noise.
    Sampled {
        /// The field.
        field: FieldId,
        /// The sample, in the unit of the field.
        value: f64,
    },
}

/// How often the sensors of all nodes said what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sensations {
    /// A target entered the radius of detection of a node.
    pub entered: u64,
    /// A target left it.
    pub left: u64,
    /// A node sampled a field.
    pub sampled: u64,
    /// A target passed the radius of detection of a node, in its sight, and the sensor missed it.
    pub missed: u64,
    /// Of those that entered, a target that was not there.
    pub false_alarms: u64,
}

impl Sensations {
    /// Counts one more.
    pub(crate) fn add(&mut self, sensed: &Sensed) {
        *match sensed {
            Sensed::Entered(_) => &mut self.entered,
            Sensed::Left(_) => &mut self.left,
            Sensed::Sampled { .. } => &mut self.sampled,
        } += 1;
    }
}

impl TargetId {
    /// The target number `index`.
    pub(crate) fn from_index(index: usize) -> Self {
        Self(u16::try_from(index).expect("at most 65536 targets"))
    }

    /// The number, to look up the target in a list.
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl FieldId {
    /// The field number `index`.
    pub(crate) fn from_index(index: usize) -> Self {
        Self(u16::try_from(index).expect("at most 65536 fields"))
    }

    /// The number, to look up the field in a list.
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}
