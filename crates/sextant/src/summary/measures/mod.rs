//! The numbers of a summary by name. A sweep writes them as columns, and `reproduce` compares them with the thesis.

pub mod application;
pub mod distributed;
pub mod map;
mod measure;
pub mod node_errors;
mod number;
pub mod over_time;
pub mod position_errors;
pub mod run;
pub mod scattering;
pub mod time;

pub use measure::{Measure, Subjects, all};
pub use number::{Number, Unit};
