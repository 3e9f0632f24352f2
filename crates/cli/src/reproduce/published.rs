//! What the thesis says.

/// What the thesis says, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// A number as printed, or a conclusion in a few words.
    pub value: String,
    /// The table, figure or section that says so.
    pub source: &'static str,
}

impl Published {
    /// The `value` that stands in `source`.
    pub fn new(value: impl Into<String>, source: &'static str) -> Self {
        Self { value: value.into(), source }
    }
}
