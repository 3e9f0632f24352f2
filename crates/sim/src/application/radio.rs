//! The radio of a station whose program commands it: no channel access, no queue, no retries.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::program::Rest;
use sextant_mac::{Phy, RadioState};

use super::Port;
use crate::link::programmed::{Acknowledging, Hearing, Links, RadioFrame};
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::radio_error::RadioError;
use crate::service::report::{Destination, FrameId, SendOutcome};

/// The radio of a station in a network of [`Technology::Programmed`](crate::Technology::Programmed). It says what happens in
/// [`Application::radio`](super::Application::radio).
///
/// It *rests* off (as at the start), idle or with its receiver on, as the program says. A window, a frame or an acknowledgement
/// calls it away for a while. From idle to receiving, from receiving to sending and back it takes a turnaround (192 us at
/// 2450 MHz), from off the time to wake up; meanwhile it is deaf. To idle or off it takes no time.
pub struct RadioPort<'a> {
    links: &'a mut Links,
    scene: &'a mut Scene,
    station: StationId,
}

impl Port<'_> {
    /// The radio of the station in a network whose programs command their radios.
    ///
    /// # Errors
    /// If the network has a channel access of its own, or the station is not in it.
    ///
    /// # Panics
    /// If there is no such network.
    pub fn radio(&mut self, network: NetworkId) -> Result<RadioPort<'_>, RadioError> {
        let links = self.model.networks[network.index()].programmed().ok_or(RadioError::NotProgrammed)?;
        links.check_station(self.station)?;
        Ok(RadioPort { links, scene: &mut self.model.scene, station: self.station })
    }
}

impl RadioPort<'_> {
    /// The radio rests off from now on. What it sends ends first; a frame that it receives is lost.
    pub fn off(&mut self) {
        self.links.rest(self.station, Rest::Off, self.scene);
    }

    /// The radio rests idle from now on: it sends sooner than from off. What it sends ends first; a frame that it receives is
    /// lost. Returns when it is idle.
    pub fn idle(&mut self) -> SimTime {
        self.links.rest(self.station, Rest::Idle, self.scene)
    }

    /// The receiver is on from now on whenever the radio does nothing else. Returns when it is on.
    pub fn receive(&mut self) -> SimTime {
        self.links.rest(self.station, Rest::Receive, self.scene)
    }

    /// The receiver is on until an instant, from `from` or from as soon as possible if that is absent; a frame that has begun by
    /// then is heard to its end. [`RadioEvent::Ready`](crate::RadioEvent::Ready) and
    /// [`RadioEvent::WindowOver`](crate::RadioEvent::WindowOver) say when. A radio that rests with its receiver on goes on receiving afterwards. A new
    /// window replaces an earlier one, and so does [`off`](Self::off), [`idle`](Self::idle) or [`receive`](Self::receive).
    /// Returns the start.
    ///
    /// # Errors
    /// If the receiver cannot be on by then, or the window has no length.
    pub fn listen(&mut self, from: Option<SimTime>, until: SimTime) -> Result<SimTime, RadioError> {
        self.links.open(self.station, from, until, self.scene)
    }

    /// Looks at the channel from now on, with the receiver on, for the 8 symbols of a clear channel assessment.
    /// [`RadioEvent::Assessed`](crate::RadioEvent::Assessed) follows at the instant that is returned.
    ///
    /// # Errors
    /// If the receiver is not on for so long, or a frame is due.
    pub fn assess(&mut self) -> Result<SimTime, RadioError> {
        self.assess_for(self.links.phy().cca())
    }

    /// The same for `span`: 1 to 128 symbols.
    ///
    /// # Errors
    /// As [`assess`](Self::assess), and if it is shorter or longer.
    pub fn assess_for(&mut self, span: Duration) -> Result<SimTime, RadioError> {
        self.links.assess(self.station, span, self.scene)
    }

    /// Sends a frame as soon as possible, without looking at the channel. [`RadioEvent::Sent`](crate::RadioEvent::Sent) follows,
    /// and if the frame asks for an acknowledgement, whether that came. Returns when its first symbol goes out.
    ///
    /// # Errors
    /// If the radio has something else to send, receives a frame or looks at the channel, or the frame is not possible.
    pub fn transmit(&mut self, frame: RadioFrame<'_>) -> Result<SimTime, RadioError> {
        self.links.transmit(self.station, None, frame, self.scene)
    }

    /// The same, so that its first symbol goes out at an instant.
    ///
    /// # Errors
    /// As [`transmit`](Self::transmit), and if the radio cannot be ready by then.
    pub fn transmit_at(&mut self, at: SimTime, frame: RadioFrame<'_>) -> Result<SimTime, RadioError> {
        self.links.transmit(self.station, Some(at), frame, self.scene)
    }

    /// Takes back the frame that is due, as long as the radio has not turned around for it. Returns whether it did.
    pub fn cancel(&mut self) -> bool {
        self.links.take_back(self.station, self.scene)
    }

    /// Changes the channel: that of the settings, or one of their further channels. A receiver that is on is deaf for a
    /// turnaround. Returns when the radio is ready.
    ///
    /// # Errors
    /// If there is no such channel, or the radio sends something or receives a frame.
    pub fn tune(&mut self, channel: u8) -> Result<SimTime, RadioError> {
        self.links.tune(self.station, channel, self.scene)
    }

    /// Number of the channel.
    #[must_use]
    pub fn channel(&self) -> u8 {
        self.links.channel_of(self.station)
    }

    /// The transmit power of what goes on air from now on: at most that of the settings.
    ///
    /// # Errors
    /// If it is greater, or not finite.
    pub fn set_power(&mut self, power: Dbm) -> Result<(), RadioError> {
        self.links.set_power(self.station, power)
    }

    /// The mean power at or above which the channel is busy from now on.
    ///
    /// # Errors
    /// If it is out of range.
    pub fn set_threshold(&mut self, threshold: Dbm) -> Result<(), RadioError> {
        self.links.set_threshold(self.station, threshold)
    }

    /// How long the radio waits for an acknowledgement from now on, counted from the end of a frame: at first the
    /// macAckWaitDuration of the standard, 864 us at 2450 MHz.
    ///
    /// # Errors
    /// If an acknowledgement would not be over by then.
    pub fn set_ack_wait(&mut self, wait: Duration) -> Result<(), RadioError> {
        self.links.set_ack_wait(self.station, wait)
    }

    /// Which frames the radio tells from now on: at first, those for its station and for all.
    pub fn hear(&mut self, hearing: Hearing) {
        self.links.hear(self.station, hearing);
    }

    /// Whether the radio acknowledges frames by itself from now on: at first it does.
    pub fn set_acknowledging(&mut self, acknowledging: Acknowledging) {
        self.links.set_acknowledging(self.station, acknowledging);
    }

    /// The state of the radio.
    #[must_use]
    pub fn state(&self) -> RadioState {
        self.links.state(self.station)
    }

    /// When the first symbol of a frame could go out that is commanded now.
    #[must_use]
    pub fn earliest(&self) -> SimTime {
        self.links.earliest(self.station, self.scene.now)
    }

    /// The physical layer: how long things take.
    #[must_use]
    pub fn phy(&self) -> Phy {
        self.links.phy()
    }

    /// Energy that the radio has used so far, from the start or the end of the warm-up (J).
    #[must_use]
    pub fn energy_j(&mut self) -> f64 {
        self.links.energy_j(self.station, self.scene.now)
    }

    /// A random number of backoff periods, uniform from 0 to `most`: that which the unslotted CSMA-CA of the station would draw in this network at
    /// this instant.
    #[must_use]
    pub fn backoff_periods(&self, most: u32) -> u32 {
        self.scene.backoff(self.links.network(), self.station, self.scene.now.as_nanos(), most)
    }

    /// The program takes a packet that it will carry, of so many octets of payload: it counts as offered. Frames that name it are
    /// its transmissions. Packets make the counts, delays and traces of a simulation; nothing else depends on them.
    ///
    /// # Errors
    /// If the payload is too large, or the station that it is for cannot receive it.
    pub fn offer(&mut self, to: Destination, payload_octets: usize) -> Result<FrameId, RadioError> {
        self.links.open_packet(self.station, to, payload_octets, self.scene)
    }

    /// The program has ended its work on a packet, and this is what it knows. Whether the packet was received counts as it truly
    /// was.
    ///
    /// # Errors
    /// If the packet is not open.
    pub fn done(&mut self, packet: FrameId, outcome: SendOutcome) -> Result<(), RadioError> {
        self.links.close_packet(self.station, packet, Some(outcome), self.scene)
    }

    /// The program drops a packet, because it has no room for it.
    ///
    /// # Errors
    /// If the packet is not open.
    pub fn drop_packet(&mut self, packet: FrameId) -> Result<(), RadioError> {
        self.links.close_packet(self.station, packet, None, self.scene)
    }
}
