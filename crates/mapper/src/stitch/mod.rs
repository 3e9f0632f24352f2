//! One map from the logs of robots whose frames of coordinates differ: each robot's log gives a map in its own frame, the
//! nodes on the maps of two robots tell how their frames differ, and the estimator maps the log of all in one frame.
//!
//! Robots know the vertical, so frames differ by a turn about it, an offset, the handedness and, if asked, the scale.

mod consensus;
mod frame_change;
mod frame_covariance;
mod frames;
mod joint;
mod logs;
mod members;
mod pair;
mod report;
mod settings;
mod shared;
mod stitched;
mod tree;
mod tukey;

pub use frame_change::{FrameChange, Handedness};
pub use frame_covariance::FrameCovariance;
pub use frames::{Frames, stitch};
pub use joint::FrameAgreement;
pub use logs::moved_log;
pub use pair::{PairFault, PairFit, PairState};
pub use report::{JoinedFrame, RobotFrame, RobotOutcome, Stitching};
pub use settings::{StitchConfig, StitchRules};
pub use shared::{OwnMap, PlacedNode};
pub use stitched::Stitched;
