//! A node that tells others that it is there, and counts whom it hears.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{NodeId, SimTime};

use super::source::Source;
use super::traffic::{Next, Traffic};
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::Delivery;
use crate::service::network_id::NetworkId;
use crate::service::sweep::{Announcement, SweepKind};

/// Frames of a station that are at most this far apart are of one sweep.
const SWEEP: Duration = Duration::from_millis(2);

/// A node that takes part in neighbour discovery.
pub(crate) struct Hello {
    says: Says,
    /// What was received of each other node.
    pub(crate) heard: BTreeMap<NodeId, HeardHellos>,
}

/// What a node sends.
pub(crate) enum Says {
    /// Nothing: it only listens.
    Nothing,
    /// Frames to all.
    Frames(Source),
    /// Sweeps of its sectors.
    Sweeps(Announcer),
}

/// Sweeps of a node that announces itself, at the times of a traffic.
pub(crate) struct Announcer {
    network: NetworkId,
    traffic: Arc<Traffic>,
    count: u64,
    limit: u64,
}

/// What was received of another node.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HeardHellos {
    /// Number of packets: frames, or sweeps of which a frame was received.
    pub(crate) packets: u32,
    /// Sum of their powers (dBm); of a sweep, the power of its best frame.
    pub(crate) sum_dbm: f64,
    /// When the last frame was received, and the best power of its sweep (dBm).
    last: Option<(SimTime, f64)>,
}

impl Hello {
    pub(crate) fn new(says: Says) -> Self {
        Self { says, heard: BTreeMap::new() }
    }
}

impl Announcer {
    pub(crate) fn new(network: NetworkId, traffic: Arc<Traffic>, limit: u64) -> Self {
        Self { network, traffic, count: 0, limit }
    }

    /// Schedules the next sweep, if there is one.
    fn schedule(&self, port: &mut Port<'_>) {
        let Some(node) = port.node(port.station()).filter(|_| self.count < self.limit) else { return };
        let last = if self.count == 0 { SimTime::ZERO } else { port.now() };
        if let Next::At(due, _) = self.traffic.next(port.seed_of(self.network), node, self.count, last) {
            port.after(due.saturating_since(port.now()), Timer(0));
        }
    }

    fn sweep(&mut self, port: &mut Port<'_>) {
        self.count += 1;
        // The sweep before may still wait for the channel; then this one is left out, and is not counted as sent.
        let _ = port.sweep(self.network, SweepKind::Announce);
        self.schedule(port);
    }
}

impl HeardHellos {
    /// A frame of a sweep: only the best one counts.
    fn note_sweep(&mut self, now: SimTime, power_dbm: f64) {
        match &mut self.last {
            Some((last, best_dbm)) if now.saturating_since(*last) <= SWEEP => {
                *last = now;
                if power_dbm > *best_dbm {
                    self.sum_dbm += power_dbm - *best_dbm;
                    *best_dbm = power_dbm;
                }
            }
            last => {
                *last = Some((now, power_dbm));
                self.packets += 1;
                self.sum_dbm += power_dbm;
            }
        }
    }
}

impl Application for Hello {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match &mut self.says {
            Says::Nothing => {}
            Says::Frames(source) => source.started(port),
            Says::Sweeps(announcer) => announcer.schedule(port),
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match &mut self.says {
            Says::Nothing => {}
            Says::Frames(source) => source.timed(timer, port),
            Says::Sweeps(announcer) => announcer.sweep(port),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Some(sender) = port.node(delivery.from) {
            let heard = self.heard.entry(sender).or_default();
            heard.packets += 1;
            heard.sum_dbm += delivery.rssi.0;
        }
    }

    fn announced(&mut self, announcement: &Announcement, port: &mut Port<'_>) {
        if let Some(sender) = port.node(announcement.from) {
            self.heard.entry(sender).or_default().note_sweep(port.now(), announcement.rssi.0);
        }
    }
}
