//! What programs are told.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sextant::channel::Position;
use sextant::sim::{self, Destination, SendOutcome};

use crate::names::Names;

/// Where a station is and where it looks.
#[pyclass(frozen, get_all, module = "sextant")]
#[derive(Clone, Copy)]
pub(crate) struct Pose {
    x_m: f64,
    y_m: f64,
    z_m: f64,
    heading_rad: f64,
}

impl Pose {
    pub(super) fn new(place: Position, heading_rad: f64) -> Self {
        Self { x_m: place.x_m, y_m: place.y_m, z_m: place.z_m, heading_rad }
    }
}

#[pymethods]
impl Pose {
    fn __repr__(&self) -> String {
        let Self { x_m, y_m, z_m, heading_rad } = self;
        format!("Pose(x_m={x_m}, y_m={y_m}, z_m={z_m}, heading_rad={heading_rad})")
    }
}

/// A place that a robot can be told.
pub(super) fn checked_place(x_m: f64, y_m: f64, z_m: f64) -> PyResult<Position> {
    let is_good = |value: f64| value.abs() <= Position::FARTHEST_M;
    if is_good(x_m) && is_good(y_m) && is_good(z_m) {
        Ok(Position::new(x_m, y_m, z_m))
    } else {
        Err(PyValueError::new_err(format!("the place is {x_m}, {y_m}, {z_m}; allowed: metres from -1e9 to 1e9")))
    }
}

/// A frame that was received.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct Delivery {
    network: u8,
    sender: String,
    sequence: u8,
    payload: Vec<u8>,
    rssi_dbm: f64,
    sector: Option<u8>,
    snr_db: Option<f64>,
}

impl Delivery {
    pub(super) fn new(delivery: &sim::Delivery<'_>, names: &Names) -> Self {
        Self {
            network: delivery.network.0,
            sender: names.name(delivery.from).to_owned(),
            sequence: delivery.sequence,
            payload: delivery.payload.to_vec(),
            rssi_dbm: delivery.rssi.0,
            sector: delivery.sector,
            snr_db: delivery.snr.map(|snr| snr.0),
        }
    }
}

#[pymethods]
impl Delivery {
    fn __repr__(&self) -> String {
        let Self { sender, payload, rssi_dbm, .. } = self;
        format!("Delivery(sender={sender:?}, payload={} octets, rssi_dbm={rssi_dbm:.1})", payload.len())
    }
}

/// The end of a frame.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct SendReport {
    network: u8,
    frame: u32,
    to: Option<String>,
    outcome: &'static str,
    attempts: u32,
    transmissions: u32,
    offered_s: f64,
}

impl SendReport {
    pub(super) fn new(network: u8, report: &sim::SendReport, names: &Names) -> Self {
        let to = match report.to {
            Destination::All => None,
            Destination::Station(station) => Some(names.name(station).to_owned()),
        };
        let outcome = match report.outcome {
            SendOutcome::Sent => "sent",
            SendOutcome::Acknowledged => "acknowledged",
            SendOutcome::NoAcknowledgement => "no-acknowledgement",
            SendOutcome::ChannelAccessFailure => "channel-access-failure",
        };
        let (frame, attempts, transmissions) = (report.frame.0, report.attempts, report.transmissions);
        Self { network, frame, to, outcome, attempts, transmissions, offered_s: report.offered.as_secs_f64() }
    }
}

#[pymethods]
impl SendReport {
    fn __repr__(&self) -> String {
        format!("SendReport(frame={}, outcome={:?}, transmissions={})", self.frame, self.outcome, self.transmissions)
    }
}

/// What a sensor says.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct Sensed {
    kind: &'static str,
    target: Option<u16>,
    field: Option<u16>,
    value: Option<f64>,
}

impl From<&sim::Sensed> for Sensed {
    fn from(sensed: &sim::Sensed) -> Self {
        match *sensed {
            sim::Sensed::Entered(target) => {
                Self { kind: "entered", target: Some(target.0), field: None, value: None }
            }
            sim::Sensed::Left(target) => Self { kind: "left", target: Some(target.0), field: None, value: None },
            sim::Sensed::Sampled { field, value } => {
                Self { kind: "sampled", target: None, field: Some(field.0), value: Some(value) }
            }
        }
    }
}

#[pymethods]
impl Sensed {
    fn __repr__(&self) -> String {
        match (self.target, self.field, self.value) {
            (Some(target), ..) => format!("Sensed(kind={:?}, target={target})", self.kind),
            (None, Some(field), Some(value)) => format!("Sensed(kind={:?}, field={field}, value={value})", self.kind),
            (None, ..) => format!("Sensed(kind={:?})", self.kind),
        }
    }
}

/// How a drive ended.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct DriveEnd {
    outcome: &'static str,
    contact: Option<(f64, f64, f64)>,
}

impl From<sim::DriveEnd> for DriveEnd {
    fn from(end: sim::DriveEnd) -> Self {
        match end {
            sim::DriveEnd::Arrived => Self { outcome: "arrived", contact: None },
            sim::DriveEnd::Blocked(at) => Self { outcome: "blocked", contact: Some((at.x_m, at.y_m, at.z_m)) },
        }
    }
}

#[pymethods]
impl DriveEnd {
    fn __repr__(&self) -> String {
        format!("DriveEnd(outcome={:?})", self.outcome)
    }
}

/// What a node answered to a sector sweep.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct SweepAnswer {
    sender: String,
    sector: Option<u8>,
    snr_db: f64,
    rssi_dbm: f64,
    node_sector: u8,
    sectors: Vec<(u8, f32)>,
}

impl SweepAnswer {
    pub(super) fn new(answer: &sim::SweepAnswer, names: &Names) -> Self {
        Self {
            sender: names.name(answer.from).to_owned(),
            sector: answer.sector,
            snr_db: answer.snr.0,
            rssi_dbm: answer.rssi.0,
            node_sector: answer.node_sector,
            sectors: answer.sectors.iter().map(|sector| (sector.sector, sector.snr_db)).collect(),
        }
    }
}

#[pymethods]
impl SweepAnswer {
    fn __repr__(&self) -> String {
        format!("SweepAnswer(sender={:?}, sector={:?}, snr_db={})", self.sender, self.sector, self.snr_db)
    }
}

/// A frame with which another station announces itself.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct Announcement {
    network: u8,
    sender: String,
    sector: Option<u8>,
    snr_db: f64,
    rssi_dbm: f64,
}

impl Announcement {
    pub(super) fn new(announcement: &sim::Announcement, names: &Names) -> Self {
        Self {
            network: announcement.network.0,
            sender: names.name(announcement.from).to_owned(),
            sector: announcement.sector,
            snr_db: announcement.snr.0,
            rssi_dbm: announcement.rssi.0,
        }
    }
}

#[pymethods]
impl Announcement {
    fn __repr__(&self) -> String {
        format!("Announcement(sender={:?}, sector={:?}, snr_db={})", self.sender, self.sector, self.snr_db)
    }
}
