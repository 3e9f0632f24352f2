//! The power of a link, item by item.

use sextant_channel::{Db, Dbm, Milliwatts, PathBudget, Position, Traced};
use sextant_kernel::SimTime;

use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::{Aim, Emission, Signal};
use super::{Air, Interface, ReceptionRules};
use crate::service::ideal::{SectorCounts, SectorPowers};

/// What the power of a link consists of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkItems {
    /// Loss between the two places.
    pub(crate) path: PathBudget,
    /// Gain by shadowing; `None` if each packet has its own.
    pub(crate) shadowing: Option<Db>,
    /// Gain of the transmitter towards the receiver.
    pub(crate) transmit_gain: Db,
    /// Gain of the receiver.
    pub(crate) receive_gain: Db,
    /// Gain by fading, if it is the same at all times.
    pub(crate) fading: Option<Db>,
    /// What was measured: it replaces all of the above.
    pub(crate) traced: Traced,
    /// Power at the receiver; without shadowing if each packet has its own, and without fading that changes in time.
    pub(crate) power: Dbm,
}

/// A radio, and where its station is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedRadio {
    pub(crate) radio: Interface,
    pub(crate) place: Position,
}

impl Air {
    /// The power of the link from one radio to another; `None` beyond the radius of communication.
    pub(crate) fn items(&mut self, emission: Emission, from: PlacedRadio, to: PlacedRadio) -> Option<LinkItems> {
        let signal = self.trial(emission, from);
        let listener = Listener { receiver: to.radio.receiver, station: to.radio.station, place: to.place };
        self.medium.items(&signal, &listener)
    }

    /// The power of a frame from one radio that begins `now` at another; `None` if it could not be received even if nothing
    /// else disturbed it.
    pub(crate) fn undisturbed(
        &mut self,
        now: SimTime,
        emission: Emission,
        from: PlacedRadio,
        to: PlacedRadio,
    ) -> Option<Milliwatts> {
        let signal = Signal { draw: self.draw_at(now), start: now, end: now, ..self.trial(emission, from) };
        let Interface { receiver, station } = to.radio;
        let power = self.medium.power_at(&signal, &Listener { receiver, station, place: to.place })?;
        (power >= self.rules(receiver).least_power()).then_some(power)
    }

    /// The powers of frames from one radio to another that begin `now`, with each sector of the two; `None` beyond the radius of
    /// communication.
    pub(crate) fn sector_powers(
        &mut self,
        now: SimTime,
        power: Dbm,
        [from, to]: [PlacedRadio; 2],
        counts: SectorCounts,
    ) -> Option<SectorPowers> {
        let emission = Emission { power, aim: Aim::Omnidirectional };
        let signal = Signal { draw: self.draw_at(now), start: now, end: now, ..self.trial(emission, from) };
        let Interface { receiver, station } = to.radio;
        self.medium.sector_powers(&signal, &Listener { receiver, station, place: to.place }, counts)
    }

    /// Whether the power of one radio at another is the same for all frames, as long as both stand: nothing moves or changes.
    pub(crate) fn powers_last(&self) -> bool {
        self.moving.is_empty() && self.roll.robots == 0 && self.medium.is_lasting()
    }

    /// A frame of no length that is not sent.
    fn trial(&self, emission: Emission, PlacedRadio { radio, place }: PlacedRadio) -> Signal {
        let Interface { receiver, station } = radio;
        let (start, end) = (SimTime::ZERO, SimTime::ZERO);
        Signal {
            packet: self.packets,
            draw: self.salt,
            source: station,
            sender: receiver,
            position: place,
            emission,
            start,
            end,
        }
    }

    /// The rules of a receiver.
    pub(crate) fn rules_of(&self, receiver: ReceiverId) -> ReceptionRules {
        *self.rules(receiver)
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{
        Channel, ChannelConfig, CorrelationConfig, Obstacle, ObstacleField, ReflectionsConfig, ShadowingConfig,
        SpatialConfig,
    };
    use sextant_kernel::{Seed, StationId};

    use super::*;
    use crate::air::{Aim, AirSettings, Holder, Mount};
    use crate::station::Roll;

    const PLACES: [[f64; 3]; 4] = [[0.0; 3], [7.0, 2.0, 0.0], [-3.0, 8.0, 1.0], [4.0, -6.0, 0.5]];

    fn air(config: ChannelConfig) -> Air {
        let wall: Obstacle = toml::from_str::<sextant_channel::ObstacleConfig>(
            "material = \"wood\"\nshape.box = { center_m = [3.0, 1.0, 0.0], size_m = [0.5, 6.0, 4.0] }",
        )
        .expect("an obstacle")
        .try_into()
        .expect("a good obstacle");
        let channel =
            Channel::new(config.try_into().expect("a good channel"), ObstacleField::new(vec![wall]), Seed(5));
        let settings = AirSettings {
            channel,
            changes: None,
            power: Dbm(0.0),
            noise: Dbm(f64::MIN),
            gain: Db(40.0),
            floor: Dbm(-300.0),
            sensing: std::time::Duration::ZERO,
            salt: 0,
            message_loss: 0.0,
            powers_vary: false,
            seed: Seed(5),
        };
        let roll = Roll { nodes: 2, robots: 1, sinks: 1 };
        let mut air = Air::new(settings, PLACES.into_iter().map(Position::from), roll);
        let rules = ReceptionRules {
            model: crate::air::ReceptionModel::Overlap,
            sensitivity: Dbm(-90.0).to_milliwatts(),
            noise: Dbm(-95.0).to_milliwatts(),
            preamble: std::time::Duration::ZERO,
            lock: 0.0,
            carrier: None,
            bit_rate_hz: 0.0,
            bit_error_rate: |_| 0.0,
        };
        air.add_receivers(vec![rules], std::iter::repeat_n(0, roll.len()), &[true; 4]);
        air
    }

    fn placed(station: usize) -> PlacedRadio {
        let station = StationId::from_index(station);
        let radio = Interface { receiver: ReceiverId(station.0), station };
        PlacedRadio { radio, place: Position::from(PLACES[station.index()]) }
    }

    #[test]
    fn the_items_of_a_link_sum_to_the_power_that_the_air_gives_to_a_frame() {
        let spatial = CorrelationConfig::Spatial(SpatialConfig { distance_m: 4.0 });
        let shadowings = [CorrelationConfig::PerLink, spatial];
        let mirrors =
            ReflectionsConfig { loss_db: Some(6.0), ground_z_m: Some(-2.0), most: 2, ..ReflectionsConfig::default() };
        for (shadowing, reflections) in shadowings.into_iter().flat_map(|s| [(s, None), (s, Some(mirrors))]) {
            let shadowing = Some(ShadowingConfig { sigma_db: Some(5.0), correlation: shadowing });
            for sectors in [0, 8] {
                let mut air = air(ChannelConfig { shadowing, reflections, ..ChannelConfig::default() });
                if sectors > 0 {
                    let antenna = "sectors = { azimuth_sectors = 8, quasi_omni_gain_dbi = 2.0 }";
                    let antenna: sextant_channel::AntennaConfig = toml::from_str(antenna).expect("an antenna");
                    let antenna = std::sync::Arc::new(antenna.try_into().expect("a good antenna"));
                    for station in 0..PLACES.len() {
                        let orientation = sextant_channel::Orientation::heading(0.3 * station as f64);
                        let mount = Mount {
                            antenna: std::sync::Arc::clone(&antenna),
                            orientation,
                            holder: Holder::World,
                            ripple: Vec::new(),
                        };
                        air.mount(placed(station).radio.receiver, mount);
                    }
                }
                for (a, b) in [(0, 1), (1, 0), (2, 1), (0, 3), (3, 2)] {
                    let aim = if sectors > 0 { Aim::Sector(3) } else { Aim::Omnidirectional };
                    let emission = Emission { power: Dbm(0.0), aim };
                    let (from, to) = (placed(a), placed(b));
                    let items = air.items(emission, from, to).expect("there is no limit");
                    let signal = air.trial(emission, from);
                    let listener =
                        Listener { receiver: to.radio.receiver, station: to.radio.station, place: to.place };
                    let power = air.medium.power_at(&signal, &listener).expect("there is no limit");
                    assert_eq!(items.power.to_milliwatts(), power, "{a} to {b}");
                    let shadowing = items.shadowing.expect("a draw of the link").0;
                    let gains = items.transmit_gain.0 + items.receive_gain.0 + shadowing;
                    assert!((items.path.mean_power(Dbm(0.0)).0 + gains - items.power.0).abs() < 1e-9);
                }
            }
        }
    }
}
