//! The live view of a run: a server of the Foxglove WebSocket protocol that sends what is recorded.

mod feed;
mod keys;
mod pace;
mod server;

pub(crate) use server::{LiveView, Settings};
