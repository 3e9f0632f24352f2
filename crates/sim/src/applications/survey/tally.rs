//! What a robot heard in a slot in one network, by node.

use sextant_channel::{Dbm, RangeSample, Reception, SectorReport, SectorSnr, StopLog};
use sextant_kernel::NodeId;

use crate::service::sweep::SweepAnswer;

/// What a robot heard in a slot in one network, by node.
pub(super) struct Tally {
    slot: Vec<Slot>,
    heard: Vec<NodeId>,
    /// Number of sector sweeps in the slot.
    sweeps: u32,
    /// What nodes reported of all sectors in these.
    reports: Vec<SectorReport>,
    /// The ranges that were measured in the slot.
    ranges: Vec<RangeSample>,
    /// Number of packets of all earlier slots.
    pub(super) total: Vec<u32>,
}

/// Packets heard of one node in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    packets: u32,
    /// Packets that the node sent from the first to the last one heard, by their sequence numbers.
    sent: u32,
    rssi_sum_dbm: f64,
    last_sequence: u8,
    /// The sector of the robot that the node heard best, and its signal-to-noise ratio there (dB).
    best: Option<(Option<u8>, f64)>,
}

impl Tally {
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            slot: vec![Slot::default(); nodes],
            heard: Vec::new(),
            sweeps: 0,
            reports: Vec::new(),
            ranges: Vec::new(),
            total: vec![0; nodes],
        }
    }

    /// The slot of a node that was heard.
    fn of(&mut self, node: NodeId) -> &mut Slot {
        let slot = &mut self.slot[node.index()];
        if slot.packets == 0 {
            self.heard.push(node);
        }
        slot.packets += 1;
        slot
    }

    /// Counts the packet `sequence` of `node`, which was received in this slot.
    pub(super) fn note(&mut self, node: NodeId, sequence: u8, rssi: Dbm) {
        let slot = self.of(node);
        if slot.packets == 1 {
            slot.sent = 1;
        } else {
            // Sequence numbers are modulo 256: a gap of 256 packets or more looks shorter.
            slot.sent += u32::from(sequence.wrapping_sub(slot.last_sequence)).max(1);
        }
        slot.rssi_sum_dbm += rssi.0;
        slot.last_sequence = sequence;
    }

    /// Counts one more sector sweep, with the answers of these nodes.
    pub(super) fn note_sweep<'a>(&mut self, answers: impl Iterator<Item = (NodeId, &'a SweepAnswer)>) {
        self.sweeps += 1;
        for (node, SweepAnswer { sector, snr, rssi, sectors, .. }) in answers {
            let slot = self.of(node);
            slot.rssi_sum_dbm += rssi.0;
            if slot.best.is_none_or(|(_, best_db)| snr.0 > best_db) {
                slot.best = Some((*sector, snr.0));
            }
            let report = |&SectorSnr { sector, snr_db }: &SectorSnr| SectorReport {
                node,
                stop: 0,
                sector,
                snr_db: snr_db.into(),
            };
            self.reports.extend(sectors.iter().map(report));
        }
    }

    /// Keeps a range that was measured in this slot.
    pub(super) fn note_range(&mut self, sample: RangeSample) {
        self.ranges.push(sample);
    }

    /// Returns what was heard, by node, and empties the tally. Of sectors that a node reported in several sweeps, the mean
    /// counts.
    pub(super) fn take(&mut self) -> StopLog {
        self.heard.sort_unstable();
        let sweeps = std::mem::take(&mut self.sweeps);
        let heard = self.heard.drain(..).map(|node| {
            let Slot { packets, sent, rssi_sum_dbm, best, .. } = std::mem::take(&mut self.slot[node.index()]);
            self.total[node.index()] += packets;
            Reception {
                node,
                stop: 0,
                received: packets,
                sent: if sweeps > 0 { sweeps } else { sent },
                sector: best.and_then(|(sector, _)| sector),
                rssi_dbm: Some(rssi_sum_dbm / f64::from(packets)),
                snr_db: best.map(|(_, snr_db)| snr_db),
            }
        });
        let receptions = heard.collect();
        let reports = SectorReport::averaged(std::mem::take(&mut self.reports));
        StopLog { receptions, reports, ranges: std::mem::take(&mut self.ranges) }
    }
}
