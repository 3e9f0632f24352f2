//! Sextant simulates wireless sensor networks and works out where the nodes are from what robots and anchors heard.

pub mod columns;
pub mod mapping;
pub mod measure;
pub mod run;
pub mod scenario;
pub mod summary;
pub mod sweep;
