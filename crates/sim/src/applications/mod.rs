//! The applications that every scenario needs: traffic of nodes, neighbour discovery, sinks, surveys of robots, mobile
//! anchors.

pub(crate) mod broadcast;
pub(crate) mod controller;
pub(crate) mod hello;
pub(crate) mod journey;
pub(crate) mod node_traffic;
pub(crate) mod robot;
mod slot;
pub(crate) mod source;
pub(crate) mod standard;
mod survey;
pub(crate) mod traffic;
