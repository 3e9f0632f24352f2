//! How a place is estimated from the likelihood of a node.

/// How the place is estimated from the likelihood of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum EstimateKind {
    /// The vertex of highest likelihood.
    #[default]
    Argmax,
    /// The mean of the vertices weighted by their likelihoods, with a covariance.
    PosteriorMean,
}

/// Which place represents several vertices that share the highest likelihood.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum TieRule {
    /// Their mean, if the vertex nearest to the mean is one of them. Otherwise they lie in separate places, and the
    /// one nearest to the mean is taken.
    #[default]
    Mean,
    /// The one with the lowest linear index.
    First,
}
