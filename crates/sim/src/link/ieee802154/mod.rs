//! IEEE 802.15.4: all that knows this technology.

mod clock;
mod frame_queue;
mod mac;
pub(crate) mod network;
mod plan;
mod radio;
mod stack;
mod transceiver;

pub(crate) use clock::Clock;
pub use mac::Mac;
pub(crate) use plan::{Demand, Post, coordinator};
pub(crate) use radio::Levels;
pub use radio::Radio;
