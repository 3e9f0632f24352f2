//! What robots and nodes need that work on a map of the nodes: the map, polls of the nodes around a robot, the place of
//! the robot on the map, and messages that reach all nodes hop by hop.
//!
//! A robot knows its odometry and what it hears. It asks the nodes around it (`Request`); those answer with their
//! place on the map (`Answer`) and what they sensed. From the powers of the answers and its odometry it works out
//! where it is on the map (`PlaceOnMap`).

mod asking;
mod flood;
mod heard;
mod navigation_map;
mod place_on_map;
mod poll;
mod waiting_answers;

pub(crate) use asking::Asking;
pub(crate) use flood::{Flood, FloodKey};
pub(crate) use heard::{HeardNode, Neighbourhood};
pub use navigation_map::{MapFrame, NavigationMap};
pub(crate) use place_on_map::PlaceOnMap;
#[cfg(test)]
pub(crate) use poll::any;
pub(crate) use poll::{Answer, Request};
pub(crate) use waiting_answers::WaitingAnswers;
