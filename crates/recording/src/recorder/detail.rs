//! How much a recording has.

/// How much a recording has. Neither leaves out anything of the reception log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Detail {
    /// A message for each reception, and lines from each stop to the nodes that were heard there.
    #[default]
    Full,
    /// The receptions of a stop in one message, and no such lines.
    Compact,
}
