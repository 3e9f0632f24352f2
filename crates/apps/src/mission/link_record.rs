//! What became of links that were kept.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::dmg::data::Mcs;

/// What became of the links of robots: sums over all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkRecord {
    /// The robots.
    pub robots: u64,
    /// Of these, those that got to the end of their way; ...
    pub arrived: u64,
    /// ... and when the last of them did.
    pub last_arrival: SimTime,
    /// Time of all beacon intervals, as far as the run has them.
    pub time: Duration,
    /// Of it, beacons, slots for answers and refinements.
    pub training: Duration,
    /// Of it, data time in which no scheme would have been received over the link, or there was none.
    pub outage: Duration,
    /// The same if the best pair of sectors of the best node had been known at any time.
    pub ideal_outage: Duration,
    /// Bits of payload that arrived.
    pub bits: u64,
    /// The same with the best pair of sectors of the best node at any time and without training.
    pub ideal_bits: u64,
    /// Data frames on air.
    pub frames: u64,
    /// Of these, those that were not received.
    pub lost_frames: u64,
    /// Trainings with all sectors.
    pub searches: u64,
    /// Trainings with the sectors round the predicted one.
    pub near_trainings: u64,
    /// Trainings that left the robot without a link.
    pub failed_trainings: u64,
    /// Answers that collided in a slot.
    pub collided: u64,
    /// Links that went on to another node.
    pub handovers: u64,
    /// Data time by the fastest scheme that the link could have carried; the first is without any.
    pub by_mcs: [Duration; Mcs::COUNT + 1],
    /// By how much links were weaker than the best pair of sectors (dB), times the time of data (s); ...
    pub loss_db_s: f64,
    /// ... and that time (s).
    pub loss_s: f64,
}

impl LinkRecord {
    /// Both together.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        self.robots += other.robots;
        self.arrived += other.arrived;
        self.last_arrival = self.last_arrival.max(other.last_arrival);
        self.time += other.time;
        self.training += other.training;
        self.outage += other.outage;
        self.ideal_outage += other.ideal_outage;
        self.bits += other.bits;
        self.ideal_bits += other.ideal_bits;
        self.frames += other.frames;
        self.lost_frames += other.lost_frames;
        self.searches += other.searches;
        self.near_trainings += other.near_trainings;
        self.failed_trainings += other.failed_trainings;
        self.collided += other.collided;
        self.handovers += other.handovers;
        self.by_mcs.iter_mut().zip(other.by_mcs).for_each(|(sum, time)| *sum += time);
        self.loss_db_s += other.loss_db_s;
        self.loss_s += other.loss_s;
        self
    }
}
