//! Errors of metrics.

/// Reasons why a metric cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// Lists of different lengths.
    #[error("{truth} true places but {map} mapped ones; each node needs one of each")]
    Length {
        /// Number of true places.
        truth: usize,
        /// Number of entries of the map.
        map: usize,
    },
    /// The radius must be a positive number.
    #[error("the neighbourhood radius is {0} m; allowed: a finite number above 0")]
    Radius(f64),
    /// Directions need at least two sectors.
    #[error("an antenna of {0} sectors has no directions to compare; allowed: 2 sectors or more")]
    Sectors(u32),
    /// The work was ended from outside.
    #[error(transparent)]
    Interrupted(#[from] sextant_kernel::Interrupted),
    /// The places do not determine an ellipse.
    #[error("{0}, so that a neighbourhood has no image on the map")]
    Degenerate(&'static str),
}
