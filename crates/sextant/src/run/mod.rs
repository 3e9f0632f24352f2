//! A run: simulate, map, measure, apply, summarise. What else comes of it are observers.

mod battery;
mod bound;
mod capture;
mod discovery;
mod distributed;
mod ending;
mod error;
mod evaluation;
mod mac;
mod mapped_node;
mod message_energy;
mod mission;
mod observer;
mod operations;
mod outcome;
mod pipeline;
mod programs;
mod recorder;
mod routing;
mod scattering;
mod simulator;
mod stepped;
mod stop;
mod witness;

pub use bound::{LazyBound, NoBound, SurveyBound};
pub use capture::RunCapture;
pub use discovery::Discoveries;
pub use error::RunError;
pub use evaluation::Evaluation;
pub use mission::{Performance, UnalignedMap};
pub use observer::{MapEnd, MissionEnd, RunObserver, RunStart, SimulationStart, SurveyEnd};
pub use pipeline::{Run, Surveyed, run, run_on, run_with, survey};
pub use programs::{ProgramError, ProgrammedRobots, Programs};
pub use recorder::RunRecorder;
pub use simulator::{Simulated, Simulator};
pub use stepped::SteppedRun;
