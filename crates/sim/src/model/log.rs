//! What robots heard and met, as it grows.

use sextant_channel::{Contact, Reception, ReceptionLog, ReceptionLogBuilder, Stop};
use sextant_kernel::NodeId;

/// What robots heard and met, as it grows.
#[derive(Default)]
pub(crate) struct Log {
    pub(crate) stops: Vec<Stop>,
    pub(crate) receptions: ReceptionLogBuilder,
    pub(crate) contacts: Vec<Contact>,
    heard: Vec<bool>,
    pub(crate) nodes_heard: usize,
}

impl Log {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { heard: vec![false; nodes], ..Self::default() }
    }

    /// Adds a stop with what was heard there, which is numbered now, and passes it to `tell` with its number.
    pub(crate) fn stop(
        &mut self,
        stop: Stop,
        mut receptions: Vec<Reception>,
        tell: impl FnOnce(u32, &Stop, &[Reception]),
    ) {
        let index = NodeId::from_index(self.stops.len()).0;
        for reception in &mut receptions {
            reception.stop = index;
            let known = &mut self.heard[reception.node.index()];
            self.nodes_heard += usize::from(!std::mem::replace(known, true));
        }
        tell(index, &stop, &receptions);
        self.stops.push(stop);
        self.receptions.extend(receptions);
    }

    /// The whole log of nodes and robots with these names.
    ///
    /// # Panics
    /// If a robot logged a node twice at a stop.
    pub(crate) fn build(self, nodes: Vec<String>, robots: Vec<String>) -> ReceptionLog {
        let log = self.receptions.build(nodes, self.stops, self.contacts);
        let log = log.expect("a robot logs each node at most once a stop");
        log.with_robots(robots).expect("each stop and contact is of a robot")
    }
}
