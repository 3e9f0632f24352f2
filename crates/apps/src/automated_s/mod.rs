//! The automated S path: a survey without a map (thesis, section 3.4 and appendix C.1.2).

mod check;
mod knowledge;
mod lane;
mod layers;
mod rules;
mod settings;
mod shaft;
mod shift;
mod survey;
mod sweep;
mod task;
mod trip;
mod view;
mod visit;

pub use settings::{AutomatedSConfig, LayersConfig, Until};
pub use survey::AutomatedS;
