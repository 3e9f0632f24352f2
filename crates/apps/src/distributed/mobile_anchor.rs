//! A mobile anchor: a robot that tells its place and the directions of its sectors at each stop.

use std::collections::VecDeque;
use std::sync::Arc;

use sextant_channel::{Position, SectorTable};
use sextant_kernel::SimTime;
use sextant_sim::{Broadcast, Pose};

use super::belief::Belief;
use super::config::DistributedMapping;
use super::message::{Beacon, Directions, Message};

/// Most earlier stops that a beacon tells, with and without sectors: with few rings of sectors they fit in a frame.
const MOST_EARLIER: [usize; 2] = [24, 5];

/// What a mobile anchor says at its stops. It has a compass, so it knows the directions of its sectors.
#[derive(Clone, Debug)]
pub struct MobileAnchor {
    settings: Arc<DistributedMapping>,
    directions: Option<Directions>,
    /// Its last stops, the latest one last.
    stops: VecDeque<Position>,
}

impl MobileAnchor {
    /// A mobile anchor with the sectors of `sectors` in equal rings of `per_ring`; without sectors if absent.
    #[must_use]
    pub fn new(settings: Arc<DistributedMapping>, sectors: Option<(&SectorTable, u8)>) -> Self {
        let directions = sectors.and_then(|(table, per_ring)| {
            let mut wedges = table.iter().filter_map(|sector| sector.wedge().ok()).step_by(per_ring.into());
            let first = wedges.next()?;
            let rings = std::iter::once(first).chain(wedges).map(|wedge| wedge.elevation_rad).collect();
            let azimuth_rad = first.azimuth_from_rad + 0.5 * first.azimuth_width_rad;
            Some(Directions { azimuth_rad, azimuth_sigma_rad: 0.0, sectors: per_ring, rings })
        });
        Self { settings, directions, stops: VecDeque::new() }
    }

    /// Size of the largest message that it sends (octets).
    #[must_use]
    pub fn largest_octets(&self) -> usize {
        let earlier = if self.settings.passes_on { self.most_earlier() } else { 0 };
        self.beacon(Position::ORIGIN, vec![Position::ORIGIN; earlier]).len()
    }

    /// Most earlier stops that a beacon tells.
    fn most_earlier(&self) -> usize {
        MOST_EARLIER[usize::from(self.directions.is_none())]
    }

    /// The octets of what it sends at `place`.
    fn beacon(&self, place: Position, earlier: Vec<Position>) -> Vec<u8> {
        let (belief, directions) = (Belief::exact(place), self.directions.clone());
        let mut octets = Vec::new();
        Message::Beacon(Beacon { belief, directions, earlier, others: Vec::new() }).write(&mut octets);
        octets
    }
}

impl Broadcast for MobileAnchor {
    fn message(&mut self, pose: &Pose, now: SimTime) -> Option<Vec<u8>> {
        if now >= SimTime::ZERO + self.settings.mobile_phase() {
            return None;
        }
        let octets = self.beacon(pose.position, self.stops.iter().copied().collect());
        if self.settings.passes_on {
            self.stops.push_back(pose.position);
            if self.stops.len() > self.most_earlier() {
                self.stops.pop_front();
            }
        }
        Some(octets)
    }
}
