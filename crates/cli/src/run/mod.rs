//! The pipeline of `run`: simulate, record, map, measure, summarise.

mod application;
mod bound;
mod discovery;
mod distributed;
mod evaluation;
mod fields;
mod gather;
mod mac;
mod mapped_node;
mod maps;
mod message_energy;
mod outcome;
mod pipeline;
mod request;
mod simulator;
mod witness;

pub use application::{MadeMap, apply};
pub use discovery::Discoveries;
pub use distributed::evaluate_distributed;
pub use evaluation::{Evaluation, bound_m, evaluate};
pub use outcome::sum_up;
pub use pipeline::record;
pub use request::Request;
pub use simulator::{Simulated, Simulator};
