//! The time of a run in which nodes compute a map.

use super::number::{Number, Unit, numbers};
use crate::summary::Summary;

numbers! { Summary {
    SIM_TIME_S "sim_time_s" Second |run| run.simulation.as_ref().map(|simulation| simulation.sim_time_s);
}}
