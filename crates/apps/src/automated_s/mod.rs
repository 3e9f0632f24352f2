//! The automated S path: a survey without a map (thesis, section 3.4 and appendix C.1.2).

mod knowledge;
mod lane;
mod settings;
mod survey;
mod trip;

pub use settings::{AutomatedSConfig, Until};
pub use survey::AutomatedS;
