//! All receptions of a stop in one message, as columns.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;
use sextant_channel::{Dbm, Reception};
use sextant_kernel::NodeId;

use super::super::link_quality::link_quality;
use super::descriptor::{self, Declaration};

/// The value of a column of numbers where a reception has none.
const NONE: u32 = 256;

/// All receptions of a stop. The columns have one value for each reception, in the same order; a column is empty if no
/// reception has a value, and `received` and `sent` also if all are 1.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct StopReceptionsMessage {
    /// Index of the stop.
    #[prost(uint32, tag = "1")]
    pub(crate) stop: u32,
    /// Indices of the nodes.
    #[prost(uint32, repeated, tag = "2")]
    pub(crate) node: Vec<u32>,
    /// Packets received, at most `sent`.
    #[prost(uint32, repeated, tag = "3")]
    pub(crate) received: Vec<u32>,
    /// Packets that the nodes are known to have sent while the robot listened.
    #[prost(uint32, repeated, tag = "4")]
    pub(crate) sent: Vec<u32>,
    /// Antenna sectors with the best reception, 0 to 255; 256 for none.
    #[prost(uint32, repeated, tag = "5")]
    pub(crate) sector: Vec<u32>,
    /// Mean received signal strengths (dBm); NaN for none.
    #[prost(double, repeated, tag = "6")]
    pub(crate) rssi_dbm: Vec<f64>,
    /// Signal-to-noise ratios of the robot's own best packets (dB); NaN for none.
    #[prost(double, repeated, tag = "7")]
    pub(crate) snr_db: Vec<f64>,
    /// Link qualities of IEEE 802.15.4, as in a `Reception`; 256 for none.
    #[prost(uint32, repeated, tag = "8")]
    pub(crate) lqi: Vec<u32>,
}

impl StopReceptionsMessage {
    /// The receptions at the stop number `stop` of a radio with this sensitivity, if it has link qualities.
    pub(crate) fn new(stop: u32, receptions: &[Reception], sensitivity: Option<Dbm>) -> Self {
        let numbers = |value: &dyn Fn(&Reception) -> u32, usual: u32| {
            let is_needed = receptions.iter().any(|reception| value(reception) != usual);
            if is_needed { receptions.iter().map(value).collect() } else { Vec::new() }
        };
        let levels = |value: fn(&Reception) -> Option<f64>| {
            let is_needed = receptions.iter().any(|reception| value(reception).is_some());
            let level = |reception| value(reception).unwrap_or(f64::NAN);
            if is_needed { receptions.iter().map(level).collect() } else { Vec::new() }
        };
        let lqi = |reception: &Reception| {
            let heard = reception.rssi_dbm.zip(sensitivity);
            heard.map_or(NONE, |(dbm, sensitivity)| link_quality(Dbm(dbm), sensitivity).into())
        };
        Self {
            stop,
            node: receptions.iter().map(|reception| reception.node.0).collect(),
            received: numbers(&|reception| reception.received, 1),
            sent: numbers(&|reception| reception.sent, 1),
            sector: numbers(&|reception| reception.sector.map_or(NONE, u32::from), NONE),
            rssi_dbm: levels(|reception| reception.rssi_dbm),
            snr_db: levels(|reception| reception.snr_db),
            lqi: numbers(&lqi, NONE),
        }
    }

    /// The receptions one by one, each with its link quality; an error message if the columns do not fit together.
    pub(crate) fn rows(&self) -> Result<impl Iterator<Item = (Reception, Option<u32>)>, String> {
        let count = self.node.len();
        let columns = [
            ("received", self.received.len()),
            ("sent", self.sent.len()),
            ("sector", self.sector.len()),
            ("rssi_dbm", self.rssi_dbm.len()),
            ("snr_db", self.snr_db.len()),
            ("lqi", self.lqi.len()),
        ];
        if let Some((name, found)) = columns.into_iter().find(|&(_, found)| found != 0 && found != count) {
            return Err(format!("`{name}` has {found} values; allowed: {count}, as many as nodes, or none"));
        }
        if let Some(sector) = self.sector.iter().find(|sector| **sector > NONE) {
            return Err(format!("sector {sector}; allowed: 0 to 255, or {NONE} for none"));
        }
        let number = |column: &[u32], at: usize| column.get(at).copied();
        let level = |column: &[f64], at: usize| column.get(at).copied().filter(|level| !level.is_nan());
        Ok((0..count).map(move |at| {
            let reception = Reception {
                node: NodeId(self.node[at]),
                stop: self.stop,
                received: number(&self.received, at).unwrap_or(1),
                sent: number(&self.sent, at).unwrap_or(1),
                sector: number(&self.sector, at).and_then(|sector| u8::try_from(sector).ok()),
                rssi_dbm: level(&self.rssi_dbm, at),
                snr_db: level(&self.snr_db, at),
            };
            (reception, number(&self.lqi, at).filter(|lqi| *lqi < NONE))
        }))
    }
}

recorded! {
    "sextant_stop_receptions.proto";
    StopReceptionsMessage = "StopReceptions": [
        "stop" = 1 Uint32, "node" = 2 Uint32s, "received" = 3 Uint32s, "sent" = 4 Uint32s, "sector" = 5 Uint32s,
        "rssi_dbm" = 6 Doubles, "snr_db" = 7 Doubles, "lqi" = 8 Uint32s,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(node: u32) -> Reception {
        Reception::heard(NodeId(node), 7, 1, 1)
    }

    #[test]
    fn receptions_are_read_back_equal() {
        for receptions in [
            Vec::new(),
            vec![heard(3), heard(900_000)],
            vec![
                Reception { received: 2, sent: 5, rssi_dbm: Some(-71.3), ..heard(0) },
                Reception { sector: Some(255), ..heard(1) },
                Reception { sector: Some(0), snr_db: Some(-0.0), rssi_dbm: Some(-90.0), ..heard(2) },
                Reception { received: 0, sent: 0, ..heard(4) },
            ],
        ] {
            let message = StopReceptionsMessage::new(7, &receptions, Some(Dbm(-90.0)));
            let restored: Vec<_> = message.rows().unwrap().collect();
            let expected: Vec<_> = receptions
                .iter()
                .map(|each| (*each, each.rssi_dbm.map(|dbm| link_quality(Dbm(dbm), Dbm(-90.0)).into())))
                .collect();
            assert_eq!(restored, expected);
        }
    }

    #[test]
    fn usual_values_take_no_space() {
        let message = StopReceptionsMessage::new(7, &[heard(3), heard(4)], Some(Dbm(-90.0)));
        assert_eq!(message, StopReceptionsMessage { stop: 7, node: vec![3, 4], ..StopReceptionsMessage::default() });
    }

    #[test]
    fn columns_that_do_not_fit_together_are_rejected() {
        let message = StopReceptionsMessage { node: vec![1, 2], sent: vec![1], ..StopReceptionsMessage::default() };
        let problem = message.rows().map(|_| ()).unwrap_err();
        assert!(problem.contains("`sent` has 1 values; allowed: 2"), "{problem}");
        let message = StopReceptionsMessage { node: vec![1], sector: vec![257], ..StopReceptionsMessage::default() };
        assert!(message.rows().is_err());
    }
}
