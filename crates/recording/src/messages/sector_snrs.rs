//! The signal-to-noise ratios of all sectors at a stop in one message, as columns.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;
use sextant_channel::SectorReport;
use sextant_kernel::NodeId;

use super::descriptor::{self, Declaration};

/// The signal-to-noise ratios of the robot's sectors that nodes reported at a stop. The columns have one value for each
/// sector that a node reported, in the same order.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SectorSnrsMessage {
    /// Index of the stop.
    #[prost(uint32, tag = "1")]
    pub(crate) stop: u32,
    /// Indices of the nodes.
    #[prost(uint32, repeated, tag = "2")]
    pub(crate) node: Vec<u32>,
    /// Identities of the sectors, 0 to 255.
    #[prost(uint32, repeated, tag = "3")]
    pub(crate) sector: Vec<u32>,
    /// Signal-to-noise ratios at the nodes (dB).
    #[prost(double, repeated, tag = "4")]
    pub(crate) snr_db: Vec<f64>,
}

impl SectorSnrsMessage {
    /// The reports at the stop number `stop`.
    pub(crate) fn new(stop: u32, reports: &[SectorReport]) -> Self {
        Self {
            stop,
            node: reports.iter().map(|report| report.node.0).collect(),
            sector: reports.iter().map(|report| report.sector.into()).collect(),
            snr_db: reports.iter().map(|report| report.snr_db).collect(),
        }
    }

    /// The reports one by one; an error message if the columns do not fit together.
    pub(crate) fn reports(&self) -> Result<impl Iterator<Item = SectorReport>, String> {
        let count = self.node.len();
        for (name, found) in [("sector", self.sector.len()), ("snr_db", self.snr_db.len())] {
            if found != count {
                return Err(format!("`{name}` has {found} values; allowed: {count}, as many as nodes"));
            }
        }
        let sectors: Result<Vec<u8>, String> = (self.sector.iter())
            .map(|&sector| u8::try_from(sector).map_err(|_| format!("sector {sector}; allowed: 0 to 255")))
            .collect();
        let rows = self.node.iter().zip(sectors?).zip(&self.snr_db);
        Ok(rows.map(|((&node, sector), &snr_db)| SectorReport {
            node: NodeId(node),
            stop: self.stop,
            sector,
            snr_db,
        }))
    }
}

recorded! {
    "sextant_sector_snrs.proto";
    SectorSnrsMessage = "SectorSnrs": [
        "stop" = 1 Uint32, "node" = 2 Uint32s, "sector" = 3 Uint32s, "snr_db" = 4 Doubles,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_read_back_equal() {
        let report = |node, sector, snr_db| SectorReport { node: NodeId(node), stop: 5, sector, snr_db };
        let reports = vec![report(0, 255, -8.0), report(900_000, 0, 12.25), report(900_000, 1, 0.1)];
        let message = SectorSnrsMessage::new(5, &reports);
        assert_eq!(message.reports().unwrap().collect::<Vec<_>>(), reports);
    }

    #[test]
    fn columns_that_do_not_fit_together_are_rejected() {
        let message = SectorSnrsMessage { node: vec![1, 2], sector: vec![1, 2], ..SectorSnrsMessage::default() };
        let problem = message.reports().map(|_| ()).unwrap_err();
        assert!(problem.contains("`snr_db` has 0 values; allowed: 2"), "{problem}");
        let message = SectorSnrsMessage { stop: 0, node: vec![1], sector: vec![256], snr_db: vec![0.0] };
        assert!(message.reports().is_err());
    }
}
