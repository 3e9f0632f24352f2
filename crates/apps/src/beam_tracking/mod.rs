//! Beams that follow: a robot drives along a way and keeps a link of IEEE 802.11ad with one node at a time.
//!
//! Time goes in beacon intervals. Each begins with beacons of the robot (BTI) and, if it trains its beam, with slots in
//! which nodes answer with all their sectors (A-BFT) and a refinement of its sector (BRP). In the rest (DTI) the robot
//! sends A-MPDUs, which the node acknowledges. The machine that says when a beam is trained, the airtimes and the rates
//! are those of [`sextant_mac::dmg`]; the powers of all pairs of sectors are those of the channel that sweeps meet.
//!
//! A robot may sweep all of its sectors, or those round the one that points to a node on its map.
//!
//! No frame of this goes on the air of the simulator: there is no contention and no interference, sectors are measured
//! without error, and the medium belongs to the robot.

mod config;
mod link;
mod mission;
mod prediction;
mod robot;
mod settings;
mod station;
mod training;

pub use config::{BeamTrackingConfig, OnFallConfig, PredictedConfig, RetrainConfig};
