//! The automated S path: a survey without a map (thesis, section 3.4 and appendix C.1.2).

mod behind;
mod knowledge;
mod lane;
mod layers;
mod settings;
mod shift;
mod survey;
mod sweep;
mod trip;
mod visit;

pub use settings::{AutomatedSConfig, LayersConfig, Until};
pub use survey::AutomatedS;
