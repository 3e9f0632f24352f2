//! The survey of one network: stops and what was heard there.

use serde::Serialize;
use sextant_channel::{NetworkLog, ReceptionLog, SectorConfig};
use sextant_kernel::NodeId;

use super::column::Column;
use super::frame::Frame;

/// What robots heard of one network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Survey {
    /// Name of the network, if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// The places where robots listened.
    pub stops: Stops,
    /// What they heard.
    pub receptions: Receptions,
    /// The sectors of the robots' antenna, if it has any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sectors: Vec<Sector>,
}

/// The places where robots listened.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stops {
    /// Start of listening (s); equal numbers if the log has no times.
    pub times_s: Column,
    /// Coordinates (m).
    pub places_m: Column,
    /// The robot, as its number.
    pub robots: Column,
}

/// Receptions by node, then by stop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Receptions {
    /// Where the receptions of each node begin, and the end of the last.
    pub first: Column,
    /// The stops.
    pub stops: Column,
    /// Packets received; absent if it is one of one everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub received: Option<Column>,
    /// Packets sent; absent with `received`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sent: Option<Column>,
    /// Mean signal strength (dBm), NaN where it was not measured; absent if it never was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rssi_dbm: Option<Column>,
    /// The sector with the best reception, 255 without; absent if there are no sectors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sectors: Option<Column>,
}

/// The directions of a sector (degrees).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sector {
    /// Its number in the log.
    pub sector: u8,
    /// Where it begins, counterclockwise from x.
    pub azimuth_from_deg: f64,
    /// Where it ends, counterclockwise from its beginning.
    pub azimuth_to_deg: f64,
}

/// Where robots met obstacles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contacts {
    /// When (s).
    pub times_s: Column,
    /// Coordinates (m).
    pub places_m: Column,
}

impl Survey {
    /// The survey in a log.
    pub(super) fn of(named: &NetworkLog, frame: &Frame) -> Self {
        let NetworkLog { network, log } = named;
        let sector = |sector: &SectorConfig| Sector {
            sector: sector.sector,
            azimuth_from_deg: sector.azimuth_from_deg,
            azimuth_to_deg: sector.azimuth_to_deg,
        };
        Self {
            network: network.clone(),
            stops: Stops {
                times_s: frame.times(log.stops().iter().map(|stop| stop.time)),
                places_m: frame.places(log.stops().iter().map(|stop| stop.position)),
                robots: Column::U32(log.stops().iter().map(|stop| stop.robot.0).collect()),
            },
            receptions: Receptions::of(log),
            sectors: log.sectors().into_iter().flat_map(|table| table.iter().map(sector)).collect(),
        }
    }
}

impl Receptions {
    fn of(log: &ReceptionLog) -> Self {
        let rows = log.receptions();
        let mut first = vec![0_u32];
        for node in (0..log.node_count()).map(NodeId::from_index) {
            let before = first.last().copied().unwrap_or(0);
            first.push(before.saturating_add(u32::try_from(log.of(node).len()).unwrap_or(u32::MAX)));
        }
        let is_plain = rows.iter().all(|row| row.received == 1 && row.sent == 1);
        let packets = |of: fn(&sextant_channel::Reception) -> u32| {
            (!is_plain).then(|| Column::U32(rows.iter().map(|row| of(&row)).collect()))
        };
        let has_strengths = rows.iter().any(|row| row.rssi_dbm.is_some());
        let has_sectors = rows.iter().any(|row| row.sector.is_some());
        Self {
            first: Column::U32(first),
            stops: Column::U32(rows.stops().to_vec()),
            received: packets(|row| row.received),
            sent: packets(|row| row.sent),
            rssi_dbm: has_strengths.then(|| Column::reals(rows.iter().map(|row| row.rssi_dbm.unwrap_or(f64::NAN)))),
            sectors: has_sectors.then(|| Column::U8(rows.iter().map(|row| row.sector.unwrap_or(u8::MAX)).collect())),
        }
    }
}
