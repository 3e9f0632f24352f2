//! Why a map cannot be measured.

/// Why a connectivity error cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// Lists of different lengths.
    #[error("{truth} true places but {map} mapped ones; each node needs one of both")]
    Length {
        /// Number of true places.
        truth: usize,
        /// Number of entries of the map.
        map: usize,
    },
    /// A radius that is no radius.
    #[error("the neighbourhood radius is {0} m; allowed: a finite number above 0")]
    Radius(f64),
    /// Whoever watches ended the work.
    #[error(transparent)]
    Interrupted(#[from] sextant_kernel::Interrupted),
    /// Places from which no ellipse follows.
    #[error("{0}, so that a neighbourhood has no image on the map")]
    Degenerate(&'static str),
}
