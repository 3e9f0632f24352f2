//! What the radios of all stations of a network have in common.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{EventKey, StationId};
use sextant_mac::Phy;

use crate::air::{Interface, ReceiverId};
use crate::event::Event;
use crate::event::link::LinkEvent;
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::outcome::Deafness;

/// What all radios of a network have in common; `R` is what they are by their technology.
#[derive(Clone, Copy, Debug)]
pub(super) struct Radios<R> {
    pub(super) network: NetworkId,
    /// Number of the air of its band.
    pub(super) air: usize,
    /// Number of the first station's receiver.
    pub(super) first_receiver: u32,
    pub(super) radio: R,
}

impl Radios<Phy> {
    pub(super) fn phy(&self) -> Phy {
        self.radio
    }
}

impl Radios<Dbm> {
    pub(super) fn power(&self) -> Dbm {
        self.radio
    }
}

impl<R> Radios<R> {
    pub(super) fn receiver(&self, station: StationId) -> ReceiverId {
        ReceiverId(self.first_receiver + station.0)
    }

    pub(super) fn interface(&self, station: StationId) -> Interface {
        Interface { receiver: self.receiver(station), station }
    }

    /// An event of the links of a station.
    pub(super) fn event(&self, station: StationId, event: LinkEvent) -> Event {
        Event::Link(station, self.network, event)
    }

    /// Schedules an event of the links of a station.
    pub(super) fn after(&self, span: Duration, station: StationId, event: LinkEvent, scene: &mut Scene) -> EventKey {
        scene.after(span, self.event(station, event))
    }

    /// A station moves differently from now on.
    pub(super) fn moves(&self, station: StationId, scene: &mut Scene) {
        scene.airs[self.air].moves(self.receiver(station), station, &scene.motions[station.index()]);
    }

    /// Brings the receiver of a station in line with why it is deaf now; `known` is what its receiver knows.
    pub(super) fn tune(
        &self,
        station: StationId,
        deafness: Option<Deafness>,
        known: &mut Option<Deafness>,
        scene: &mut Scene,
    ) {
        if deafness != *known {
            *known = deafness;
            scene.tune(self.air, self.interface(station), deafness);
        }
    }
}
