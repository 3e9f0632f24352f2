//! The coordinator of a beacon-enabled PAN: the beacons that open its superframes (IEEE 802.15.4-2006, 7.5.2.4).
//!
//! It has no clock: its caller says when a beacon is due, once per beacon interval and one turnaround early. The
//! radio is deaf from the start of the turnaround before a beacon to the end of the turnaround after it.

use std::time::Duration;

use sextant_kernel::{SettingError, SimTime};

use crate::frame::{Beacon, Endpoint, Frame, FrameBody, GuaranteedSlot, Superframe, Version};
use crate::slotted::guaranteed_span;
use crate::superframe::{BeaconEnabled, Contention, MIN_CAP_SYMBOLS, SLOTS, SuperframeTiming};
use crate::{Class, Phy, RadioState};

#[cfg(test)]
mod tests;

/// An event of the coordinator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The turnaround to transmitting is over: the first bit of the beacon goes out now.
    TransmitReady,
    /// The last bit of the beacon is out.
    TransmissionEnded,
    /// The turnaround to receiving is over.
    ReceiveReady,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::TransmitReady => Class::StartOfSignal,
            Self::TransmissionEnded | Self::ReceiveReady => Class::EndOfSignal,
        }
    }
}

/// The interface of the machine to its timer and its radio.
pub trait Radio {
    /// Sets the timer: `event` is due `span` from now.
    fn after(&mut self, span: Duration, event: Event);

    /// The radio changes its state now.
    fn enter(&mut self, state: RadioState);

    /// Puts the first bit of a beacon on the air; [`Event::TransmissionEnded`] is due [`Phy::airtime`] from now.
    fn start_beacon(&mut self, mpdu_octets: u8);
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Listening,
    TurningToTransmit,
    Transmitting,
    TurningToReceive,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Coordinator {
    phy: Phy,
    source: Endpoint,
    superframe: Superframe,
    timing: SuperframeTiming,
    guaranteed: Vec<GuaranteedSlot>,
    beacon_octets: u8,
    /// Sequence number of the beacon under way, or of the last beacon.
    sequence: u8,
    /// When the last beacon started.
    started: Option<SimTime>,
    state: State,
}

impl Coordinator {
    /// The coordinator at `source`. It gives its guaranteed slots to `devices`, in the order of the settings. Its
    /// next beacon has the number after `sequence`.
    ///
    /// # Errors
    /// If the guaranteed slots leave less than 440 symbols for contention (aMinCAPLength).
    ///
    /// # Panics
    /// If the number of devices is not the number of guaranteed slots.
    pub fn new(
        settings: &BeaconEnabled,
        phy: Phy,
        source: Endpoint,
        devices: &[u16],
        sequence: u8,
    ) -> Result<Self, SettingError> {
        assert_eq!(devices.len(), settings.gts().len(), "one device per slot");
        let mut first_slot = SLOTS;
        let mut give = |(&device, slots): (&u16, u8)| {
            first_slot -= slots;
            GuaranteedSlot { device, first_slot, slots, receive_only: false }
        };
        let guaranteed: Vec<_> =
            devices.iter().zip(settings.gts().iter().map(|gts| gts.slots)).map(&mut give).collect();
        let superframe = Superframe {
            beacon_order: settings.beacon_order(),
            superframe_order: settings.superframe_order(),
            final_cap_slot: first_slot - 1,
            battery_life_extension: settings.battery_life_extension(),
            pan_coordinator: true,
            association_permit: false,
        };
        let timing = SuperframeTiming::new(phy, superframe).expect("the orders were checked");
        let mut coordinator = Self {
            phy,
            source,
            superframe,
            timing,
            guaranteed,
            beacon_octets: 0,
            sequence,
            started: None,
            state: State::Listening,
        };
        let mut mpdu = Vec::new();
        coordinator.write_beacon(&mut mpdu);
        coordinator.beacon_octets = u8::try_from(mpdu.len()).expect("at most 127 octets");
        let beacon = phy.airtime(coordinator.beacon_octets);
        let cap = timing.cap_end().saturating_sub(beacon);
        if cap < phy.symbols(MIN_CAP_SYMBOLS) {
            let symbols = cap.as_nanos() / phy.symbol().as_nanos();
            let found = format!("{} slots, which leave {symbols} symbols for contention", SLOTS - first_slot);
            let allowed = format!("fewer, so that {MIN_CAP_SYMBOLS} symbols are left, or a higher superframe_order");
            return Err(SettingError::new("gts", found, allowed));
        }
        Ok(coordinator)
    }

    /// Timing of the superframes that its beacons open.
    #[must_use]
    pub const fn timing(&self) -> &SuperframeTiming {
        &self.timing
    }

    /// The guaranteed slots that its beacons give, in the order of the settings.
    #[must_use]
    pub fn guaranteed(&self) -> &[GuaranteedSlot] {
        &self.guaranteed
    }

    /// Whether the contention access period can carry a frame.
    #[must_use]
    pub fn contention_carries(&self, mpdu_octets: u8, ack_request: bool) -> bool {
        let contention: Contention = self.timing.contention(SimTime::ZERO, self.beacon_octets);
        contention.fits(contention.boundary(SimTime::ZERO), mpdu_octets, ack_request)
    }

    /// Whether its guaranteed slot number `index` can carry a frame.
    ///
    /// # Panics
    /// If there is no such slot.
    #[must_use]
    pub fn slot_carries(&self, index: usize, mpdu_octets: u8, ack_request: bool) -> bool {
        let slot = self.guaranteed[index];
        let length = self.timing.guaranteed_end(slot) - self.timing.slot_start(slot.first_slot);
        guaranteed_span(self.phy, mpdu_octets, ack_request) <= length
    }

    /// Whether a beacon is under way, so that the radio is deaf.
    #[must_use]
    pub const fn is_sending(&self) -> bool {
        !matches!(self.state, State::Listening)
    }

    /// End of the active part of the current superframe; `None` before the first beacon.
    #[must_use]
    pub fn active_end(&self) -> Option<SimTime> {
        self.started.map(|start| start + self.timing.active())
    }

    /// Time from a frame that ends now to its acknowledgement.
    #[must_use]
    pub fn ack_gap(&self, now: SimTime) -> Duration {
        match self.started {
            Some(start) if now < start + self.timing.active() => self.timing.ack_gap(now - start),
            _ => self.phy.turnaround(),
        }
    }

    /// A beacon starts one turnaround from now.
    ///
    /// # Panics
    /// If a beacon is under way.
    pub fn prepare(&mut self, radio: &mut impl Radio) {
        assert!(!self.is_sending(), "a beacon is under way");
        self.state = State::TurningToTransmit;
        self.sequence = self.sequence.wrapping_add(1);
        radio.enter(RadioState::Turnaround);
        radio.after(self.phy.turnaround(), Event::TransmitReady);
    }

    /// Handles an event.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, now: SimTime, event: Event, radio: &mut impl Radio) {
        self.state = match (self.state, event) {
            (State::TurningToTransmit, Event::TransmitReady) => {
                self.started = Some(now);
                radio.enter(RadioState::Transmit);
                radio.start_beacon(self.beacon_octets);
                State::Transmitting
            }
            (State::Transmitting, Event::TransmissionEnded) => {
                radio.enter(RadioState::Turnaround);
                radio.after(self.phy.turnaround(), Event::ReceiveReady);
                State::TurningToReceive
            }
            (State::TurningToReceive, Event::ReceiveReady) => {
                radio.enter(RadioState::Receive);
                State::Listening
            }
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        };
    }

    /// Replaces the content of `mpdu` with the MPDU of the beacon under way.
    pub fn write_beacon(&self, mpdu: &mut Vec<u8>) {
        let beacon = Beacon {
            superframe: self.superframe,
            gts_permit: false,
            guaranteed: self.guaranteed.clone(),
            pending_short: Vec::new(),
            pending_extended: Vec::new(),
            payload: &[],
        };
        let frame = Frame {
            version: Version::V2003,
            frame_pending: false,
            ack_request: false,
            sequence: self.sequence,
            destination: None,
            source: Some(self.source),
            body: FrameBody::Beacon(beacon),
        };
        frame.write(mpdu).expect("seven guaranteed slots and no payload fit");
    }
}
