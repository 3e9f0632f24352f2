//! The robots and sinks that received a frame, for observers.

use crate::air::Arrival;
use crate::observer::HeardFrame;
use crate::service::outcome::FrameOutcome;
use crate::station::Roll;

/// Fills `told` with the robots and sinks among `arrivals` that received the frame.
pub(super) fn tell_collectors(arrivals: &[Arrival], roll: &Roll, told: &mut Vec<HeardFrame>) {
    let received = |arrival: &&Arrival| !roll.is_node(arrival.station) && arrival.outcome == FrameOutcome::Received;
    told.clear();
    told.extend(arrivals.iter().filter(received).map(|arrival| HeardFrame {
        collector: arrival.station.index() - roll.nodes,
        power: arrival.power.to_dbm(),
    }));
}
