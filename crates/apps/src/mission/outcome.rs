//! What a mission counted and believed.

use std::collections::BTreeMap;

use sextant_kernel::SimTime;

use super::link_record::LinkRecord;

/// What the stations of a mission leave behind. What truly happened is seen by observers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissionOutcome {
    /// What stations did, by name; what was never done is absent.
    pub steps: BTreeMap<&'static str, u64>,
    /// Messages that stations gave to their links, by kind; kinds without a message are absent.
    pub messages: BTreeMap<&'static str, u64>,
    /// Payload of all of them (octets).
    pub octets: u64,
    /// Arrivals of robots where they wanted to be, in the order of their robots.
    pub arrivals: Vec<MissionArrival>,
    /// What became of the links that robots kept, if they did.
    pub links: Option<LinkRecord>,
}

/// A robot believed to be where it wanted to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionArrival {
    /// The robot, by its number among those of the mission.
    pub robot: usize,
    /// When.
    pub time: SimTime,
    /// The value of the field that it believed to be at.
    pub value: f64,
}

impl MissionOutcome {
    /// The same without what is zero.
    #[must_use]
    pub(crate) fn without_zeros(mut self) -> Self {
        self.steps.retain(|_, count| *count > 0);
        self.messages.retain(|_, count| *count > 0);
        self
    }
}
