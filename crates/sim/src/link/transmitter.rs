//! The radio of a station, as one who sends without channel access sees it.

use sextant_channel::Dbm;

use crate::air::{Aim, Emission, Interface, PlacedRadio};
use crate::scene::Scene;
use crate::service::ideal::{SectorCounts, SectorPowers};

/// The radio of a station in a network.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmitter {
    /// Number of its air.
    pub(crate) air: usize,
    pub(crate) radio: Interface,
    /// Transmit power, without the antenna.
    pub(crate) tx_power: Dbm,
    /// Number of sectors of its antenna; `None` if that is omnidirectional.
    pub(crate) sectors: Option<u8>,
}

impl Transmitter {
    /// The power at `receiver`, in the same air, of a frame that begins now, from the best sector. `None` if the frame could
    /// not be received even if nothing else disturbed it.
    pub(crate) fn power_at(&self, receiver: Interface, scene: &mut Scene) -> Option<Dbm> {
        let place = |radio: Interface| PlacedRadio { radio, place: scene.place(radio.station) };
        let (from, to) = (place(self.radio), place(receiver));
        let heading_rad = scene.motions[receiver.station.index()].pose_at(scene.now).heading_rad;
        let air = &mut scene.airs[self.air];
        air.turn(receiver.receiver, heading_rad);
        let mut power = |aim| air.undisturbed(scene.now, Emission { power: self.tx_power, aim }, from, to);
        let best = match self.sectors {
            None => power(Aim::Omnidirectional),
            Some(sectors) => {
                (0..sectors).filter_map(|sector| power(Aim::Sector(sector))).reduce(|a, b| if b > a { b } else { a })
            }
        };
        best.map(|power| power.to_dbm())
    }

    /// The powers of frames to `peer`, in the same air, that begin now, with each sector of the two. `None` beyond the radius
    /// of communication, or if an antenna has no sectors.
    pub(crate) fn sector_powers(&self, peer: &Self, scene: &mut Scene) -> Option<SectorPowers> {
        let counts = SectorCounts { own: self.sectors?, peer: peer.sectors? };
        let radios = [self.radio, peer.radio];
        let ends = radios.map(|radio| PlacedRadio { radio, place: scene.place(radio.station) });
        let air = &mut scene.airs[self.air];
        for Interface { receiver, station } in radios {
            air.turn(receiver, scene.motions[station.index()].pose_at(scene.now).heading_rad);
        }
        air.sector_powers(scene.now, self.tx_power, ends, counts)
    }
}
