//! The radio of a station whose program commands it.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sextant::channel::Dbm;
use sextant::kernel::SimTime;
use sextant::sim::{Acknowledging, FrameId, Hearing, NetworkId, RadioError, RadioFrame, RadioPort, SendOutcome};

use super::port::{Port, span};
use crate::error::RunError;

/// The radio of a station in a network.
#[pyclass(frozen, module = "sextant")]
pub(crate) struct Radio {
    port: Py<Port>,
    network: NetworkId,
}

impl Radio {
    pub(super) fn new(port: Py<Port>, network: NetworkId) -> Self {
        Self { port, network }
    }

    /// Asks the radio of the library.
    fn ask<T>(&self, ask: impl FnOnce(&mut RadioPort<'_>) -> Result<T, RadioError>) -> PyResult<T> {
        let port = self.port.get();
        let answer = port.ask(|port| ask(&mut port.radio(self.network)?))?;
        answer.map_err(|why| match why {
            RadioError::NoSuchStation(station) => {
                RunError::new_err(format!("`{}` cannot receive the frame", port.name(station)))
            }
            why => RunError::new_err(why.to_string()),
        })
    }
}

/// An instant of the simulation.
fn instant(seconds: f64) -> PyResult<SimTime> {
    Ok(SimTime::ZERO + span(seconds)?)
}

#[pymethods]
impl Radio {
    /// The radio rests off. What it sends ends first; a frame that it receives is lost.
    fn off(&self) -> PyResult<()> {
        self.ask(|radio| {
            radio.off();
            Ok(())
        })
    }

    /// The radio rests idle: it sends sooner than from off. Returns when it is idle (s).
    fn idle(&self) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.idle().as_secs_f64()))
    }

    /// The receiver is on whenever the radio does nothing else. Returns when it is on (s).
    fn receive(&self) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.receive().as_secs_f64()))
    }

    /// Receives from ``from_s``, or as soon as possible, until ``until_s``; a frame that begins by then is heard to its end.
    #[pyo3(signature = (until_s, from_s=None))]
    fn listen(&self, until_s: f64, from_s: Option<f64>) -> PyResult<f64> {
        let (until, from) = (instant(until_s)?, from_s.map(instant).transpose()?);
        self.ask(|radio| Ok(radio.listen(from, until)?.as_secs_f64()))
    }

    /// Looks at the channel, for 8 symbols if no time is given; ``assessed`` follows.
    #[pyo3(signature = (seconds=None))]
    fn assess(&self, seconds: Option<f64>) -> PyResult<f64> {
        let span = seconds.map(span).transpose()?;
        self.ask(|radio| {
            let until = match span {
                None => radio.assess(),
                Some(span) => radio.assess_for(span),
            };
            Ok(until?.as_secs_f64())
        })
    }

    /// Sends a frame without channel access, at an instant or as soon as possible; ``sent`` follows.
    #[pyo3(signature = (payload, to=None, *, at_s=None, acknowledged=false, packet=None))]
    fn transmit(
        &self,
        payload: &[u8],
        to: Option<&str>,
        at_s: Option<f64>,
        acknowledged: bool,
        packet: Option<u32>,
    ) -> PyResult<f64> {
        let (to, at) = (self.port.get().destination(to)?, at_s.map(instant).transpose()?);
        let frame = RadioFrame { to, payload, acknowledged, packet: packet.map(FrameId) };
        self.ask(|radio| {
            let start = match at {
                None => radio.transmit(frame),
                Some(at) => radio.transmit_at(at, frame),
            };
            Ok(start?.as_secs_f64())
        })
    }

    /// Takes back the frame that is due, before the radio has turned around for it. Returns whether it did.
    fn cancel(&self) -> PyResult<bool> {
        self.ask(|radio| Ok(radio.cancel()))
    }

    /// Changes the channel. Returns when the radio is ready (s).
    fn tune(&self, channel: u8) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.tune(channel)?.as_secs_f64()))
    }

    /// Number of the channel.
    #[getter]
    fn channel(&self) -> PyResult<u8> {
        self.ask(|radio| Ok(radio.channel()))
    }

    /// Transmit power of what goes on air from now on (dBm), at most that of the settings.
    fn set_power(&self, dbm: f64) -> PyResult<()> {
        self.ask(|radio| radio.set_power(Dbm(dbm)))
    }

    /// Mean power at or above which the channel is busy (dBm).
    fn set_threshold(&self, dbm: f64) -> PyResult<()> {
        self.ask(|radio| radio.set_threshold(Dbm(dbm)))
    }

    /// How long the radio waits for an acknowledgement, from the end of a frame (s).
    fn set_ack_wait(&self, seconds: f64) -> PyResult<()> {
        let span = span(seconds)?;
        self.ask(|radio| radio.set_ack_wait(span))
    }

    /// Whether frames for other stations are told too.
    #[pyo3(signature = (*, all))]
    fn hear(&self, all: bool) -> PyResult<()> {
        let hearing = if all { Hearing::All } else { Hearing::Own };
        self.ask(|radio| {
            radio.hear(hearing);
            Ok(())
        })
    }

    /// Whether the radio acknowledges frames by itself; at first it does.
    #[pyo3(signature = (*, automatically))]
    fn acknowledge(&self, automatically: bool) -> PyResult<()> {
        let acknowledging = if automatically { Acknowledging::Automatic } else { Acknowledging::Off };
        self.ask(|radio| {
            radio.set_acknowledging(acknowledging);
            Ok(())
        })
    }

    /// ``sleep``, ``idle``, ``receive``, ``transmit`` or ``turnaround``.
    #[getter]
    fn state(&self) -> PyResult<&'static str> {
        self.ask(|radio| Ok(radio.state().name()))
    }

    /// When the first symbol of a frame could go out.
    #[getter]
    fn earliest_s(&self) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.earliest().as_secs_f64()))
    }

    /// Time from receiving to transmitting, and back (s).
    #[getter]
    fn turnaround_s(&self) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.phy().turnaround().as_secs_f64()))
    }

    /// Time on air of a frame of so many octets (s).
    fn airtime_s(&self, octets: u8) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.phy().airtime(octets).as_secs_f64()))
    }

    /// Energy that the radio has used so far, from the end of the warm-up (J).
    #[getter]
    fn energy_j(&self) -> PyResult<f64> {
        self.ask(|radio| Ok(radio.energy_j()))
    }

    /// A packet of so many octets, which counts as offered; ``transmit(.., packet=)`` and ``done`` name it.
    #[pyo3(signature = (octets, to=None))]
    fn offer(&self, octets: usize, to: Option<&str>) -> PyResult<u32> {
        let to = self.port.get().destination(to)?;
        self.ask(|radio| Ok(radio.offer(to, octets)?.0))
    }

    /// Ends a packet: ``sent``, ``acknowledged``, ``no-acknowledgement`` or ``channel-access-failure``.
    #[pyo3(signature = (packet, outcome="sent"))]
    fn done(&self, packet: u32, outcome: &str) -> PyResult<()> {
        let outcome = match outcome {
            "sent" => SendOutcome::Sent,
            "acknowledged" => SendOutcome::Acknowledged,
            "no-acknowledgement" => SendOutcome::NoAcknowledgement,
            "channel-access-failure" => SendOutcome::ChannelAccessFailure,
            other => {
                let allowed = "\"sent\", \"acknowledged\", \"no-acknowledgement\", \"channel-access-failure\"";
                return Err(PyValueError::new_err(format!("the outcome is {other:?}; allowed: {allowed}")));
            }
        };
        self.ask(|radio| radio.done(FrameId(packet), outcome))
    }

    /// Drops a packet for which the program has no room.
    fn drop_packet(&self, packet: u32) -> PyResult<()> {
        self.ask(|radio| radio.drop_packet(FrameId(packet)))
    }

    fn __repr__(&self) -> String {
        format!("sextant.Radio(network={})", self.network.0)
    }
}
