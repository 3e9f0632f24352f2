//! The numbers of a summary, each under one name: what a sweep writes into columns and `reproduce` compares with the thesis.

pub mod map;
mod measure;
pub mod node_errors;
mod number;
pub mod run;

pub use measure::{Measure, all};
pub use number::{Number, Unit};
