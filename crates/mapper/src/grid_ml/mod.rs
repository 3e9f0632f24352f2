//! Maximum likelihood on a grid under a reception profile: given or fitted, of one network or several, with antenna
//! sectors or without, in free space or among known obstacles.

mod bounded_search;
pub(crate) mod directions;
pub(crate) mod findings;
mod fitted;
mod fitted_ml_tm;
mod fitted_parts;
mod joint;
mod ml_tm;
mod ml_tm_parts;
mod ml_tm_settings;
mod mm_tm;
#[cfg(feature = "obstacles")]
mod obstacle_ml_tm;
mod sector_errors;
pub(crate) mod solver;

pub use fitted::{Fit, Fitted, NetworkFits};
pub use fitted_ml_tm::FittedMlTm;
pub use joint::{JointConfig, JointMlTm, JointNetworkConfig};
pub use ml_tm::{MlTm, MlTmConfig};
pub use mm_tm::MmTm;
#[cfg(feature = "obstacles")]
pub use obstacle_ml_tm::ObstacleMlTm;
