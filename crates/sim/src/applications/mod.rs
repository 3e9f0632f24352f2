//! The applications that every scenario needs: traffic of nodes, neighbour discovery, sinks, surveys of robots.

pub(crate) mod controller;
pub(crate) mod hello;
pub(crate) mod source;
pub(crate) mod standard;
pub(crate) mod survey;
pub(crate) mod traffic;
