//! A node that tells others that it is there, and counts whom it hears.

use std::collections::BTreeMap;

use sextant_kernel::NodeId;

use super::source::Source;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::Delivery;

/// A node that takes part in neighbour discovery.
pub(crate) struct Hello {
    /// What it sends; `None` if it only listens.
    source: Option<Source>,
    /// Number of packets received of each other node, and the sum of their powers (dBm).
    pub(crate) heard: BTreeMap<NodeId, (u32, f64)>,
}

impl Hello {
    pub(crate) fn new(source: Option<Source>) -> Self {
        Self { source, heard: BTreeMap::new() }
    }
}

impl Application for Hello {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Some(source) = &mut self.source {
            source.started(port);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if let Some(source) = &mut self.source {
            source.timed(timer, port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Some(sender) = port.node(delivery.from) {
            let (packets, sum_dbm) = self.heard.entry(sender).or_default();
            *packets += 1;
            *sum_dbm += delivery.rssi.0;
        }
    }
}
