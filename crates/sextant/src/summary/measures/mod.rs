//! The numbers of a summary by path. A sweep writes them as columns, and the reproduction of the thesis reads them.

mod derived;
mod known;
mod measure;
mod numbers;
mod subjects;
mod unit;

pub use measure::{Measure, UnknownMeasure, all};
pub use numbers::Numbers;
pub use subjects::{Feature, Subjects};
pub use unit::Unit;
