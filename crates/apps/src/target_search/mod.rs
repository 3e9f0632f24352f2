//! Search for moving targets on a map of the nodes (Gunathillake 2018, chapter 6).
//!
//! Nodes detect targets within a radius and keep the times. The first ones tell a sink hop by hop, and the sink tells the
//! robots. A robot then asks the nodes around it for their detections, predicts where the target is, and drives there.

mod config;
mod message;

pub use config::{
    Aim, DetarskConfig, FilterConfig, Informants, OwnPlaceRule, PGConfig, ParticlesConfig, PathRule, Prediction,
    RobustKalmanConfig,
};
pub use message::{Claim, Detection, FirstDetection, GradientMessage, Message};
