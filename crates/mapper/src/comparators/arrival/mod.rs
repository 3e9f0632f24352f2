//! Baselines that place each node by itself, from the directions or the times at which signals arrived.

mod angle_of_arrival;
mod time_of_arrival;

pub use angle_of_arrival::{AngleOfArrival, AngleOfArrivalConfig};
pub use time_of_arrival::{TimeDifference, TimeDifferenceConfig, TimeOfArrival, TimeOfArrivalConfig};
