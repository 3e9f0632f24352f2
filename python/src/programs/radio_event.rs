//! What the radio of a station says to its program.

use pyo3::prelude::*;
use sextant::kernel::SimTime;
use sextant::sim::{self, Destination, NetworkId};

use crate::names::Names;

/// What the radio of a station says; what an event has not is `None`.
#[pyclass(frozen, get_all, module = "sextant")]
#[derive(Default)]
pub(crate) struct RadioEvent {
    network: u8,
    kind: &'static str,
    start_s: Option<f64>,
    end_s: Option<f64>,
    busy: Option<bool>,
    power_dbm: Option<f64>,
    sender: Option<String>,
    to: Option<String>,
    sequence: Option<u8>,
    payload: Option<Vec<u8>>,
    lqi: Option<u8>,
    acknowledged: Option<bool>,
}

impl RadioEvent {
    pub(super) fn new(network: NetworkId, event: &sim::RadioEvent<'_>, names: &Names) -> Self {
        let of = |kind| Self { network: network.0, kind, ..Self::default() };
        let began = |kind, start: SimTime| Self { start_s: Some(start.as_secs_f64()), ..of(kind) };
        match event {
            sim::RadioEvent::Ready => of("ready"),
            sim::RadioEvent::Assessed { busy, power } => {
                Self { busy: Some(*busy), power_dbm: Some(power.0), ..of("assessed") }
            }
            sim::RadioEvent::Began { start } => began("began", *start),
            sim::RadioEvent::Received(frame) => {
                let to = match frame.to {
                    Destination::All => None,
                    Destination::Station(station) => Some(names.name(station).to_owned()),
                };
                Self {
                    end_s: Some(frame.end.as_secs_f64()),
                    power_dbm: Some(frame.delivery.rssi.0),
                    sender: Some(names.name(frame.delivery.from).to_owned()),
                    to,
                    sequence: Some(frame.delivery.sequence),
                    payload: Some(frame.delivery.payload.to_vec()),
                    lqi: Some(frame.lqi),
                    acknowledged: Some(frame.acknowledged),
                    ..began("received", frame.start)
                }
            }
            sim::RadioEvent::Garbled { start } => began("garbled", *start),
            sim::RadioEvent::Ignored { start } => began("ignored", *start),
            sim::RadioEvent::WindowOver => of("window-over"),
            sim::RadioEvent::Sent { start } => began("sent", *start),
            sim::RadioEvent::Acknowledged { rssi } => Self { power_dbm: Some(rssi.0), ..of("acknowledged") },
            sim::RadioEvent::Unacknowledged => of("unacknowledged"),
        }
    }
}

#[pymethods]
impl RadioEvent {
    fn __repr__(&self) -> String {
        match (&self.sender, self.busy) {
            (Some(sender), _) => format!("RadioEvent(kind={:?}, sender={sender:?})", self.kind),
            (None, Some(busy)) => {
                format!("RadioEvent(kind={:?}, busy={})", self.kind, if busy { "True" } else { "False" })
            }
            (None, None) => format!("RadioEvent(kind={:?})", self.kind),
        }
    }
}
