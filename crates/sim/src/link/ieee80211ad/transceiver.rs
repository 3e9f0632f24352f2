//! The radio of one station, as its protocol machines see it.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{EventKey, StationId};
use sextant_mac::RadioState;
use sextant_mac::dmg::{self, MacAddress, SweepFrame};

use super::stack::{RadioStack, Role, SectorNumbers};
use crate::air::{Aim, Emission};
use crate::event::ieee80211ad::Event;
use crate::event::link::LinkEvent;
use crate::link::radios::Radios;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::station::Pose;

/// The radio of one station, as one of its machines sees it.
pub(super) struct Transceiver<'a> {
    pub(super) radios: &'a Radios<Dbm>,
    pub(super) stack: &'a mut RadioStack,
    pub(super) scene: &'a mut Scene,
    pub(super) station: StationId,
    pub(super) role: Role,
    /// The numbers of the sectors of the sweep under way.
    pub(super) numbers: SectorNumbers,
}

impl Transceiver<'_> {
    fn schedule(&mut self, span: Duration, event: dmg::Event) -> EventKey {
        let event = match self.role {
            Role::Initiator => Event::initiator(event),
            Role::Responder => Event::responder(event),
        };
        self.radios.after(span, self.station, LinkEvent::Ieee80211ad(event), self.scene)
    }

    /// Brings the receiver in line with the state of the radio.
    pub(super) fn tune(&mut self) {
        self.stack.meter.enter(self.stack.state, self.scene.now);
        let deafness = match self.stack.state {
            RadioState::Receive => None,
            // Also idle between two frames of its sweep.
            RadioState::Transmit | RadioState::Turnaround | RadioState::Idle => Some(Deafness::Transmitting),
            // Only a station that has died.
            RadioState::Sleep => Some(Deafness::Off),
        };
        self.radios.tune(self.station, deafness, &mut self.stack.deafness, self.scene);
    }
}

impl dmg::Radio for Transceiver<'_> {
    fn slots(&mut self, max_inclusive: u32) -> u32 {
        self.stack.draws += 1;
        self.scene.backoff(self.radios.network, self.station, self.stack.draws, max_inclusive)
    }

    fn after(&mut self, span: Duration, event: dmg::Event) {
        self.stack.timers[self.role as usize] = Some(self.schedule(span, event));
    }

    fn cancel_timer(&mut self) {
        if let Some(key) = self.stack.timers[self.role as usize].take() {
            self.scene.queue.cancel(key);
        }
    }

    fn enter(&mut self, state: RadioState) {
        self.stack.state = state;
        self.tune();
    }

    fn aim(&mut self, aim: dmg::Aim) {
        self.stack.aim = match aim {
            dmg::Aim::QuasiOmni => Aim::Omnidirectional,
            dmg::Aim::Sector(sector) => {
                Aim::Sector(self.numbers.of(sector).expect("a station sweeps its own sectors"))
            }
        };
    }

    fn start_transmission(&mut self, frame: SweepFrame, airtime: Duration) {
        let now = self.scene.now;
        let Pose { position: place, heading_rad } = self.scene.motions[self.station.index()].pose_at(now);
        let sender = self.radios.interface(self.station);
        let to = (frame.to != MacAddress::BROADCAST).then(|| frame.to.station()).flatten();
        let to = to.map(|to| self.radios.receiver(to));
        let emission = Emission { power: self.radios.power(), aim: self.stack.aim };
        let air = &mut self.scene.airs[self.radios.air];
        air.turn(sender.receiver, heading_rad);
        let transmission = air.begin(now, sender, to, place, emission, airtime);
        self.stack.on_air = Some((transmission, frame));
        self.schedule(airtime, dmg::Event::TransmissionEnded);
    }
}
