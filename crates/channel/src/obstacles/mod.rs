//! Obstacles, and the ways of a signal through, along and around them.

pub(crate) mod crossing;
pub(crate) mod edge;
pub(crate) mod field;
pub(crate) mod mirror;
pub(crate) mod obstacle;
pub(crate) mod rays;
pub(crate) mod sight;
pub(crate) mod storey;
mod together;
pub(crate) mod wall;
