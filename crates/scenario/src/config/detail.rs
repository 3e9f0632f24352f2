//! How much a recording has.

use serde::{Deserialize, Serialize};

/// Recordings of more nodes than this are compact, if the scenario does not say otherwise.
const MOST_NODES_IN_FULL: usize = 20_000;

/// How much is recorded, as written in a scenario. Neither leaves out anything of what a mapper needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DetailConfig {
    /// A message for each reception, and lines from each stop to the nodes that were heard there
    Full,
    /// The receptions of a stop in one message, and no such lines
    Compact,
}

impl DetailConfig {
    /// What is different in a compact recording, for people.
    pub const DIFFERENCE: &str = "one message for all receptions of a stop, and no lines to the nodes heard there";
    /// The setting that records all.
    pub const KEEP: &str = "recording.detail=full";

    /// What is recorded of a world with so many nodes, if the scenario does not say so.
    #[must_use]
    pub fn usual(nodes: usize) -> Self {
        if nodes > MOST_NODES_IN_FULL { Self::Compact } else { Self::Full }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_recordings_of_many_nodes_are_compact() {
        assert_eq!(DetailConfig::usual(MOST_NODES_IN_FULL), DetailConfig::Full);
        assert_eq!(DetailConfig::usual(MOST_NODES_IN_FULL + 1), DetailConfig::Compact);
    }
}
