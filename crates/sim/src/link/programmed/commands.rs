//! What a program commands its radio.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::frame::DataFrame;
use sextant_mac::program::{Rest, Sending};
use sextant_mac::{Phy, RadioState};

use super::Links;
use super::packet::{Outgoing, RadioFrame};
use super::stack::{Acknowledging, Hearing};
use crate::link::ieee802154::header;
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::outcome::Deafness;
use crate::service::radio_error::RadioError;
use crate::service::report::Destination;

impl Links {
    /// Which frames a radio tells its program from now on.
    pub(crate) fn hear(&mut self, station: StationId, hearing: Hearing) {
        self.stacks[station.index()].hearing = hearing;
    }

    /// Whether a radio acknowledges frames by itself from now on.
    pub(crate) fn set_acknowledging(&mut self, station: StationId, acknowledging: Acknowledging) {
        self.stacks[station.index()].acknowledging = acknowledging;
    }

    /// Refuses the radio of a station that is not in the network.
    pub(crate) fn check_station(&self, station: StationId) -> Result<(), RadioError> {
        if self.has(station) { Ok(()) } else { Err(RadioError::NotThere) }
    }

    /// Refuses frames for stations that cannot receive them.
    pub(super) fn check_destination(&self, station: StationId, to: Destination) -> Result<(), RadioError> {
        match to {
            Destination::Station(to) if to == station || to.index() >= self.stacks.len() || !self.ledger.has(to) => {
                Err(RadioError::NoSuchStation(to))
            }
            Destination::Station(_) | Destination::All => Ok(()),
        }
    }

    /// Size of a frame with so many octets of payload (octets).
    pub(super) fn mpdu_octets(header: &DataFrame, found: usize) -> Result<u8, RadioError> {
        let allowed = header.max_payload_octets();
        match u8::try_from(found) {
            Ok(octets) if octets <= allowed => Ok(octets + header.overhead_octets()),
            _ => Err(RadioError::Oversized { found, allowed: allowed.into() }),
        }
    }

    /// Changes where the radio rests.
    pub(crate) fn rest(&mut self, station: StationId, rest: Rest, scene: &mut Scene) -> SimTime {
        self.stacks[station.index()].held_from = None;
        self.command(station, scene, |radio, now, timers| radio.rest(rest, now, timers))
    }

    /// Opens a window.
    pub(crate) fn open(
        &mut self,
        station: StationId,
        from: Option<SimTime>,
        until: SimTime,
        scene: &mut Scene,
    ) -> Result<SimTime, RadioError> {
        let opened = self.command(station, scene, |radio, now, timers| radio.open(from, until, now, timers))?;
        self.stacks[station.index()].held_from = None;
        Ok(opened)
    }

    /// Begins to look at the channel; returns when that is over.
    pub(crate) fn assess(
        &mut self,
        station: StationId,
        span: Duration,
        scene: &mut Scene,
    ) -> Result<SimTime, RadioError> {
        let (least, most) = (self.phy().symbol(), self.longest_assessment);
        if !(least..=most).contains(&span) {
            return Err(RadioError::Span { found: span, least, most });
        }
        let until = self.command(station, scene, |radio, now, timers| radio.assess(span, now, timers))?;
        self.stacks[station.index()].assessed_from = scene.now;
        self.note_assessment(station, scene.now);
        Ok(until)
    }

    /// Takes a frame to send, at an instant or as soon as possible; returns when its first symbol goes out.
    pub(crate) fn transmit(
        &mut self,
        station: StationId,
        at: Option<SimTime>,
        frame: RadioFrame<'_>,
        scene: &mut Scene,
    ) -> Result<SimTime, RadioError> {
        let RadioFrame { to, payload, acknowledged, packet } = frame;
        self.check_destination(station, to)?;
        if acknowledged && to == Destination::All {
            return Err(RadioError::AcknowledgedByAll);
        }
        let octets = Self::mpdu_octets(&header(self.pan, station, to), payload.len())?;
        let airtime = self.phy().airtime(octets);
        let stack = &self.stacks[station.index()];
        let sequence = match packet {
            None => stack.sequence.wrapping_add(1),
            Some(id) => {
                let open = stack.open.iter().find(|open| open.id == id);
                open.ok_or(RadioError::NoSuchPacket(id))?.sequence
            }
        };
        // A frame that is received now would be lost.
        if stack.followed.is_some() && at.is_none_or(|at| at <= stack.radio.earliest(scene.now)) {
            return Err(RadioError::ReceivingFrame);
        }
        let sending = Sending { at, airtime, awaited: acknowledged.then_some(sequence) };
        let start = self.command(station, scene, |radio, now, timers| radio.send(sending, now, timers))?;
        let payload = self.payloads.store(payload);
        let stack = &mut self.stacks[station.index()];
        if packet.is_none() {
            stack.sequence = sequence;
        }
        stack.outgoing = Some(Outgoing { to, payload, sequence, acknowledged, packet });
        Ok(start)
    }

    /// Takes back the frame that is due, if the radio has not turned around for it. Returns whether there was one.
    pub(crate) fn take_back(&mut self, station: StationId, scene: &mut Scene) -> bool {
        let was_due = self.command(station, scene, |radio, _, timers| radio.take_back(timers));
        if was_due && let Some(outgoing) = self.stacks[station.index()].outgoing.take() {
            self.payloads.free(outgoing.payload);
        }
        was_due
    }

    /// Changes the channel; returns when the radio is ready.
    pub(crate) fn tune(&mut self, station: StationId, number: u8, scene: &mut Scene) -> Result<SimTime, RadioError> {
        let channel = self.channels.iter().position(|&channel| channel == number);
        let channel = channel.ok_or(RadioError::Channel(number))?;
        let stack = &mut self.stacks[station.index()];
        if channel == stack.channel {
            return Ok(scene.now);
        }
        if stack.followed.is_some() {
            return Err(RadioError::ReceivingFrame);
        }
        let ready = self.command(station, scene, |radio, now, timers| radio.tune(now, timers))?;
        let stack = &mut self.stacks[station.index()];
        // It is deaf for what is still sent there, and in the new channel until `settle`.
        self.radios[stack.channel].tune(station, Some(Deafness::Off), &mut stack.deafness, scene);
        stack.channel = channel;
        self.settle(station, scene);
        Ok(ready)
    }

    /// The number of the channel of a radio.
    pub(crate) fn channel_of(&self, station: StationId) -> u8 {
        self.channels[self.stacks[station.index()].channel]
    }

    /// Changes the transmit power of what goes on air from now on.
    pub(crate) fn set_power(&mut self, station: StationId, power: Dbm) -> Result<(), RadioError> {
        let stack = &mut self.stacks[station.index()];
        if !(power >= Dbm(-200.0) && power <= stack.most_power) {
            return Err(RadioError::Power { found: power, most: stack.most_power });
        }
        stack.power = power;
        Ok(())
    }

    /// Changes how long the radio waits for an acknowledgement.
    pub(crate) fn set_ack_wait(&mut self, station: StationId, wait: Duration) -> Result<(), RadioError> {
        let set = self.stacks[station.index()].radio.set_ack_wait(wait);
        set.map_err(|least| RadioError::AckWait { found: wait, least })
    }

    /// Changes the threshold of carrier sense.
    pub(crate) fn set_threshold(&mut self, station: StationId, threshold: Dbm) -> Result<(), RadioError> {
        if !(-200.0..=100.0).contains(&threshold.0) {
            return Err(RadioError::Threshold(threshold));
        }
        self.stacks[station.index()].cca_threshold = threshold.to_milliwatts();
        Ok(())
    }

    /// Energy that a radio has used so far (J).
    pub(crate) fn energy_j(&mut self, station: StationId, now: SimTime) -> f64 {
        let states = &self.ledger.radio_states;
        self.stacks[station.index()].energy_j(states, now)
    }

    /// When the first symbol of a frame could go out.
    pub(crate) fn earliest(&self, station: StationId, now: SimTime) -> SimTime {
        self.stacks[station.index()].radio.earliest(now)
    }

    /// The number of the network.
    pub(crate) fn network(&self) -> NetworkId {
        self.radios[0].network
    }

    /// The physical layer.
    pub(crate) fn phy(&self) -> Phy {
        self.radios[0].phy()
    }

    /// The state of a radio.
    pub(crate) fn state(&self, station: StationId) -> RadioState {
        self.stacks[station.index()].radio.state()
    }
}
