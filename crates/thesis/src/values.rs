//! The unit of the values of figures.

use serde::Deserialize;

/// The unit of the values of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Values {
    /// That of printed tables.
    #[default]
    Printed,
    /// Shares of 1, not of 100.
    Shares,
}
