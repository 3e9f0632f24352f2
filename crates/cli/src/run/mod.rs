//! The pipeline of `run`: simulate, record, map, measure, summarise.

mod bound;
mod discovery;
mod evaluation;
mod fields;
mod gather;
mod mac;
mod message_energy;
mod outcome;
mod pipeline;
mod request;

pub use discovery::Discoveries;
pub use evaluation::{Evaluation, bound_m, evaluate};
pub use outcome::sum_up;
pub use pipeline::record;
pub use request::Request;
