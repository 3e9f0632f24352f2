//! Why the place of a node is not reliable.

use std::fmt;

#[cfg(feature = "config")]
use serde::Serialize;

/// Why the place of a node is not reliable, although the algorithm gives one. A node with a concern has not converged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "config", derive(Serialize))]
#[cfg_attr(feature = "config", serde(rename_all = "kebab-case"))]
pub enum Concern {
    /// The node is as likely at the edge of the area in which it was searched for: it may be farther away.
    AtEdge,
    /// The fit that places the node did not settle: more rounds would move the node.
    Unsettled,
    /// Receptions and silence say nothing: the node is about equally likely everywhere in the area in which it was
    /// searched for.
    NoEvidence,
}

impl Concern {
    /// The name in files: `at-edge`, `unsettled`, `no-evidence`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AtEdge => "at-edge",
            Self::Unsettled => "unsettled",
            Self::NoEvidence => "no-evidence",
        }
    }
}

impl fmt::Display for Concern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
