//! A device in a beacon-enabled PAN: it looks for a coordinator, follows its beacons, and sends in its superframes
//! (IEEE 802.15.4-2006, 7.5.4.1).
//!
//! A device without a coordinator keeps its receiver on until it hears a beacon. Then it wakes up for each beacon,
//! one turnaround early. If a beacon does not come, it sends nothing in this superframe and waits for the next
//! beacon; after four missed beacons in a row it has lost its coordinator. A device with a guaranteed slot sends all
//! its frames in that slot; other devices use slotted CSMA-CA.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::csma::{self, CsmaSettings, OutgoingFrame, Report};
use crate::frame::{Beacon, GuaranteedSlot};
use crate::slotted::{AccessWindow, SlottedCsma};
use crate::superframe::{BeaconEnabled, SuperframeTiming};
use crate::timing::MAX_MPDU_OCTETS;
use crate::{Class, Phy, RadioState};

#[cfg(test)]
mod tests;

/// Number of beacons missed in a row after which the coordinator is lost (aMaxLostBeacons).
const MAX_LOST_BEACONS: u8 = 4;

/// An event of a device that follows beacons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A beacon starts one turnaround from now: the receiver turns on.
    BeaconNear,
    /// Even the longest beacon would be over by now.
    BeaconMissed,
    /// The guaranteed slot of the device starts one turnaround from now.
    GuaranteedSlotNear,
    /// The active part of the superframe is over.
    ActivePartEnded,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        Class::Timer
    }
}

/// The interface of a device to its timers and its radio.
pub trait Radio: csma::Radio {
    /// Sets the second timer: `event` is due `span` from now. Never called while it is pending.
    fn track_after(&mut self, span: Duration, event: Event);

    /// Cancels the second timer, if it is pending.
    fn cancel_tracking(&mut self);
}

/// The coordinator as a device knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Coordinator {
    timing: SuperframeTiming,
    /// When its last beacon started, or should have.
    beacon: SimTime,
    /// Number of beacons missed in a row.
    missed: u8,
    /// The guaranteed slot from the last beacon.
    slot: Option<GuaranteedSlot>,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Device {
    phy: Phy,
    address: u16,
    inactive_state: RadioState,
    csma: SlottedCsma,
    /// `None` while the device looks for one.
    coordinator: Option<Coordinator>,
    /// The state of the radio while nothing is sent.
    base: RadioState,
}

impl Device {
    /// A device with this short address that looks for a coordinator.
    #[must_use]
    pub const fn new(settings: &BeaconEnabled, phy: Phy, address: u16) -> Self {
        let csma: CsmaSettings = settings.csma();
        Self {
            phy,
            address,
            inactive_state: settings.inactive_state(),
            csma: SlottedCsma::new(csma, phy),
            coordinator: None,
            base: Self::INITIAL_STATE,
        }
    }

    /// The initial state of the radio.
    pub const INITIAL_STATE: RadioState = RadioState::Receive;

    /// Whether it follows the beacons of a coordinator.
    #[must_use]
    #[cfg(test)]
    pub(crate) const fn is_synchronised(&self) -> bool {
        self.coordinator.is_some()
    }

    /// Whether a frame is under way, so that [`Device::start`] must wait for its [`Report`].
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.csma.is_busy()
    }

    /// Takes a frame to send; it waits for the next window.
    ///
    /// # Panics
    /// If a frame is under way.
    pub fn start(&mut self, now: SimTime, frame: OutgoingFrame, radio: &mut impl Radio) {
        let (resting, base) = (self.csma.resting_state(), self.base);
        self.csma.start(now, frame, &mut Resting { radio, resting, base });
    }

    /// Handles an event of the channel access; returns the report if the event ended the frame.
    ///
    /// # Panics
    /// If the event is impossible in the current state.
    pub fn handle_csma(&mut self, now: SimTime, event: csma::Event, radio: &mut impl Radio) -> Option<Report> {
        let (resting, base) = (self.csma.resting_state(), self.base);
        self.csma.handle(now, event, &mut Resting { radio, resting, base })
    }

    /// A beacon of `octets`; its last bit arrives now with a correct FCS.
    pub fn receive_beacon(&mut self, now: SimTime, octets: u8, beacon: &Beacon<'_>, radio: &mut impl Radio) {
        let Some(timing) = SuperframeTiming::new(self.phy, beacon.superframe) else { return };
        let start = now.saturating_sub(self.phy.airtime(octets));
        let is_mine = |slot: &&GuaranteedSlot| slot.device == self.address && !slot.receive_only;
        let slot = beacon.guaranteed.iter().find(is_mine).copied();
        self.coordinator = Some(Coordinator { timing, beacon: start, missed: 0, slot });
        radio.cancel_tracking();
        self.rest_in(self.csma.resting_state(), radio);
        match slot {
            Some(slot) => {
                let near = start + (timing.slot_start(slot.first_slot) - self.phy.turnaround());
                radio.track_after(near.saturating_since(now), Event::GuaranteedSlotNear);
            }
            None => {
                self.track_end(now, radio);
                self.open(now, AccessWindow::Contention(timing.contention(start, octets)), radio);
            }
        }
    }

    /// Handles an event of following beacons.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, now: SimTime, event: Event, radio: &mut impl Radio) {
        let Some(mut coordinator) = self.coordinator else { panic!("{event:?} without a coordinator") };
        match event {
            Event::GuaranteedSlotNear => {
                let slot = coordinator.slot.expect("a slot was given");
                self.track_end(now, radio);
                let end = coordinator.beacon + coordinator.timing.guaranteed_end(slot);
                self.open(now, AccessWindow::Guaranteed { end }, radio);
            }
            Event::ActivePartEnded => {
                self.rest_in(self.inactive_state, radio);
                self.track_beacon(now, coordinator, radio);
            }
            Event::BeaconNear => {
                self.rest_in(RadioState::Receive, radio);
                radio.track_after(self.phy.turnaround() + self.phy.airtime(MAX_MPDU_OCTETS), Event::BeaconMissed);
            }
            Event::BeaconMissed => {
                coordinator.beacon += coordinator.timing.beacon_interval();
                coordinator.missed += 1;
                if coordinator.missed == MAX_LOST_BEACONS {
                    // The receiver is on and stays on.
                    self.coordinator = None;
                } else {
                    self.coordinator = Some(coordinator);
                    self.rest_in(self.inactive_state, radio);
                    self.track_beacon(now, coordinator, radio);
                }
            }
        }
    }

    /// The next event is the end of the active part, or the next beacon if it comes at once.
    fn track_end(&self, now: SimTime, radio: &mut impl Radio) {
        let coordinator = self.coordinator.expect("a beacon was heard");
        if coordinator.timing.has_inactive_part() {
            let end = coordinator.beacon + coordinator.timing.active();
            radio.track_after(end.saturating_since(now), Event::ActivePartEnded);
        } else {
            self.track_beacon(now, coordinator, radio);
        }
    }

    fn track_beacon(&self, now: SimTime, coordinator: Coordinator, radio: &mut impl Radio) {
        let next = coordinator.beacon + coordinator.timing.beacon_interval();
        let near = next.saturating_since(now).saturating_sub(self.phy.turnaround());
        radio.track_after(near, Event::BeaconNear);
    }

    fn open(&mut self, now: SimTime, window: AccessWindow, radio: &mut impl Radio) {
        let (resting, base) = (self.csma.resting_state(), self.base);
        self.csma.open(now, window, &mut Resting { radio, resting, base });
    }

    /// The radio rests in `state` from now on; if it is in use, as soon as it is free.
    fn rest_in(&mut self, state: RadioState, radio: &mut impl Radio) {
        self.base = state;
        if !self.csma.is_on_air() {
            radio.enter(state);
        }
    }
}

/// The radio as channel access sees it: at rest, it is in the state that following beacons requires.
struct Resting<'a, R> {
    radio: &'a mut R,
    resting: RadioState,
    base: RadioState,
}

impl<R: csma::Radio> csma::Radio for Resting<'_, R> {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        self.radio.backoff_periods(max_inclusive)
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        self.radio.after(span, event);
    }

    fn cancel_timer(&mut self) {
        self.radio.cancel_timer();
    }

    fn enter(&mut self, state: RadioState) {
        self.radio.enter(if state == self.resting { self.base } else { state });
    }

    fn start_cca(&mut self) {
        self.radio.start_cca();
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        self.radio.start_transmission(frame);
    }
}
