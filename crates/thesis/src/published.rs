//! Published values.

/// A value of the thesis and its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// A number as printed, or a conclusion in a few words.
    pub value: String,
    /// The table, figure or section.
    pub source: String,
}

impl Published {
    /// The `value` from `source`.
    pub fn new(value: impl Into<String>, source: impl Into<String>) -> Self {
        Self { value: value.into(), source: source.into() }
    }
}
