//! A value of ours, and its published value.

use super::better::Better;
use super::computation::Computation;
use super::line::Line;
use super::ours::Ours;
use super::published::Published;

/// A value of ours, and its published value.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its description.
    pub what: String,
    /// How it is computed.
    pub ours: Computation,
    /// The printed unit.
    pub unit: String,
    /// The published value, in the printed unit.
    pub published: Option<Published>,
    /// Which values are better, if it is an error or a time of the method of the thesis, or a share that it wants.
    pub better: Option<Better>,
}

impl Quantity {
    /// The line of this quantity with the value `ours`.
    pub(crate) fn line(&self, ours: Ours) -> Line {
        let (what, published, unit) = (self.what.clone(), self.published.clone(), self.unit.clone());
        Line { what, published, unit, better: self.better, ours, reading: None }
    }
}
