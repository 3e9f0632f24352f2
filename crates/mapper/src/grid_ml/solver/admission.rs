//! Which vertices a search looks at.

/// Which vertices are in the search set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Vertices within R and in the sector of every stop that received. The caller gives only such vertices to the
    /// scorer.
    WithinAll,
    /// Vertices within R and in the sector of any stop that received. The scorer checks this.
    WithinAny,
}
