//! Why the place of a node is not reliable.

use std::fmt;

/// Why the place of a node is not reliable, although the algorithm gives one. A node with a concern has not converged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "config", derive(serde::Serialize))]
#[cfg_attr(feature = "config", serde(rename_all = "kebab-case"))]
pub enum Concern {
    /// The 95 % region of the node reaches an end of the area in which it was searched for that no setting gives: the node
    /// may be farther away. Or its best place is on the border of the area that a setting gives.
    AtEdge,
    /// The fit that places the node did not settle: more rounds would move the node.
    Unsettled,
    /// Receptions and silence say nothing: of the area in which the node was searched for, its posterior leaves at least
    /// four fifths, or the log does not tell how far nodes are heard.
    NoEvidence,
    /// The ranges leave a second place, such as the mirror image across a straight way, with at least a twentieth of the
    /// probability.
    TwoPlaces,
    /// The ranges of the node are fewer than a place and a bias need to be checked, or the places from which somebody listened for
    /// it are fewer than its place and its power need.
    TooFew,
}

impl Concern {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::AtEdge, Self::Unsettled, Self::NoEvidence, Self::TwoPlaces, Self::TooFew];

    /// The name in files: `at-edge`, `unsettled`, `no-evidence`, `two-places`, `too-few`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AtEdge => "at-edge",
            Self::Unsettled => "unsettled",
            Self::NoEvidence => "no-evidence",
            Self::TwoPlaces => "two-places",
            Self::TooFew => "too-few",
        }
    }
}

impl fmt::Display for Concern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
