//! The nodes that a robot has heard lately.

use std::collections::BTreeMap;

use sextant_channel::{Db, Position};
use sextant_kernel::{SimTime, StationId};

/// What a robot heard last of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardNode {
    /// The place of the node on the map (m).
    pub place: Position,
    /// Received power less transmit power.
    pub gain: Db,
    /// When.
    pub time: SimTime,
}

/// The nodes that a robot has heard lately.
#[derive(Clone, Debug, Default)]
pub struct Neighbourhood {
    heard: BTreeMap<StationId, HeardNode>,
}

impl Neighbourhood {
    /// A node was heard.
    pub fn hear(&mut self, station: StationId, heard: HeardNode) {
        self.heard.insert(station, heard);
    }

    /// Forgets nodes that were not heard since `time`.
    pub fn forget_before(&mut self, time: SimTime) {
        self.heard.retain(|_, heard| heard.time >= time);
    }

    /// The nodes, by station.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = (StationId, &HeardNode)> {
        self.heard.iter().map(|(&station, heard)| (station, heard))
    }

    /// The place of the robot on the map as the mean of those of the nodes, weighted by the ratio of received and
    /// transmit power (thesis, equation of the robot's coordinates, chapters 6 and 7). The ratio is linear: one in
    /// decibels would grow with the distance. `None` if nobody was heard.
    #[must_use]
    pub fn centroid(&self) -> Option<Position> {
        // Relative to the strongest one, so that no weight underflows.
        let strongest = self.heard.values().map(|heard| heard.gain.0).max_by(f64::total_cmp)?;
        let weigh = |heard: &HeardNode| Db(heard.gain.0 - strongest).to_factor();
        let total: f64 = self.heard.values().map(weigh).sum();
        let sum = self.heard.values().fold(Position::ORIGIN, |sum, heard| sum + heard.place * weigh(heard));
        Some(sum * (1.0 / total))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(x_m: f64, gain_db: f64) -> HeardNode {
        HeardNode { place: Position::new(x_m, 0.0, 0.0), gain: Db(gain_db), time: SimTime::ZERO }
    }

    #[test]
    fn a_node_ten_decibels_stronger_weighs_ten_times_as_much() {
        let mut neighbourhood = Neighbourhood::default();
        assert_eq!(neighbourhood.centroid(), None);
        neighbourhood.hear(StationId(0), heard(0.0, -400.0));
        neighbourhood.hear(StationId(1), heard(11.0, -390.0));
        assert!((neighbourhood.centroid().unwrap().x_m - 10.0).abs() < 1e-9);
    }
}
