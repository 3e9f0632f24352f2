//! What a sensor says in a recording.

/// What a sensor says of a target or of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sensation {
    /// The target is within the radius of detection from now on.
    Entered,
    /// The target is not within the radius of detection any more.
    Left,
    /// A sample of the field, in its unit.
    Sampled(f64),
}

impl Sensation {
    /// Its word in a message.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Entered => "entered",
            Self::Left => "left",
            Self::Sampled(_) => "sampled",
        }
    }

    /// The sample, if it is one.
    pub(crate) fn value(self) -> Option<f64> {
        match self {
            Self::Sampled(value) => Some(value),
            Self::Entered | Self::Left => None,
        }
    }

    /// The sensation with this word and value, if there is one.
    pub(crate) fn read(word: &str, value: Option<f64>) -> Option<Self> {
        match (word, value) {
            ("entered", None) => Some(Self::Entered),
            ("left", None) => Some(Self::Left),
            ("sampled", Some(value)) => Some(Self::Sampled(value)),
            _ => None,
        }
    }
}
