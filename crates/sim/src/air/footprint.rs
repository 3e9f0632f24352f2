//! What each sector of a sender reaches from its place: worked out once, and used for every frame of its sweeps.

use sextant_channel::{Dbm, Milliwatts, Position};
use sextant_kernel::StationId;

use super::budget::Budget;
use super::cells::Cells;
use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::{Aim, Signal};

/// Links and powers that are remembered at most (about 100 MB). When there are more, all are forgotten: they are worked
/// out again, with the same result.
const MOST: usize = 1 << 21;

/// What the sectors of all senders reach among the receivers that stand. Only for powers that are the same for all
/// packets of a link.
#[derive(Debug)]
pub(super) struct Footprints {
    /// The receivers whose stations stand, whether they listen or not.
    standing: Cells<Listener<Position>>,
    /// By sender.
    known: Vec<Footprint>,
    /// Links and powers that are remembered.
    held: usize,
    most: usize,
}

/// What the sectors of one sender reach from its place.
#[derive(Debug, Default)]
struct Footprint {
    /// From where, with which heading (rad), and with which power; `None` if nothing is known.
    of: Option<(Position, f64, Dbm)>,
    /// The links to the receivers within the radius of communication, by receiver.
    links: Vec<Link>,
    /// By aim: all directions alike, then the sectors.
    beams: Vec<Beam>,
}

/// A link from the sender to a receiver that stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) listener: Listener<Position>,
    /// Power at the receiver without the gains of antennas.
    level: Dbm,
}

/// What one sector reaches.
#[derive(Debug, Default)]
struct Beam {
    is_known: bool,
    audible: Vec<Audible>,
}

/// A receiver at which a signal is not negligible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Audible {
    pub(super) receiver: ReceiverId,
    pub(super) station: StationId,
    pub(super) power: Milliwatts,
}

impl Footprints {
    /// Nothing is known yet. `standing` are all receivers whose stations stand.
    pub(super) fn new(standing: Cells<Listener<Position>>) -> Self {
        Self { standing, known: Vec::new(), held: 0, most: MOST }
    }

    /// Limits the number of links and powers that are remembered.
    #[cfg(test)]
    pub(super) fn remember_at_most(&mut self, most: usize) {
        self.most = most;
    }

    /// The links from the sender of a signal to all standing receivers within the radius of communication, and those
    /// of them at which the signal is not negligible with its power. Both by receiver.
    pub(super) fn of(&mut self, signal: &Signal, reach_m: f64, budget: &mut Budget) -> (&[Link], &[Audible]) {
        let (sender, aim) = (signal.sender.index(), index(signal.emission.aim));
        if self.known.len() <= sender {
            self.known.resize_with(sender + 1, Footprint::default);
        }
        let of = Some((signal.position, budget.heading_rad(signal.sender), signal.emission.power));
        let is_known = |footprint: &Footprint| footprint.of == of && footprint.knows(aim);
        if !is_known(&self.known[sender]) {
            if self.held > self.most {
                self.known.iter_mut().for_each(|footprint| *footprint = Footprint::default());
                self.held = 0;
            }
            let footprint = &mut self.known[sender];
            let before = footprint.size();
            if footprint.of != of {
                footprint.forget();
                footprint.of = of;
                find_links(&mut self.standing, signal, reach_m, budget, &mut footprint.links);
            }
            footprint.work_out(aim, signal, budget);
            self.held = (self.held + footprint.size()).saturating_sub(before);
        }
        let Footprint { links, beams, .. } = &self.known[sender];
        (links, &beams[aim].audible)
    }
}

/// The place of an aim among the beams of a sender.
fn index(aim: Aim) -> usize {
    match aim {
        Aim::Omnidirectional => 0,
        Aim::Sector(sector) => 1 + usize::from(sector),
    }
}

/// Replaces `links` with those to all standing receivers within the radius of communication, by receiver.
fn find_links(
    standing: &mut Cells<Listener<Position>>,
    signal: &Signal,
    reach_m: f64,
    budget: &mut Budget,
    links: &mut Vec<Link>,
) {
    links.clear();
    standing.near(signal.position, |cell| {
        let others = cell.iter().filter(|listener| listener.receiver != signal.sender);
        let near = others.filter(|listener| listener.place.distance_m(signal.position) <= reach_m);
        links.extend(near.filter_map(|&listener| {
            let level = budget.level(signal, &listener)?;
            Some(Link { listener, level })
        }));
    });
    links.sort_unstable_by_key(|link| link.listener.receiver);
}

impl Footprint {
    /// Links and powers that it holds.
    fn size(&self) -> usize {
        self.links.len() + self.beams.iter().map(|beam| beam.audible.len()).sum::<usize>()
    }

    fn knows(&self, aim: usize) -> bool {
        self.beams.get(aim).is_some_and(|beam| beam.is_known)
    }

    fn forget(&mut self) {
        for beam in &mut self.beams {
            beam.is_known = false;
            beam.audible.clear();
        }
        self.links.clear();
    }

    /// Works out one beam: that of `signal`.
    fn work_out(&mut self, aim: usize, signal: &Signal, budget: &mut Budget) {
        if self.beams.len() <= aim {
            self.beams.resize_with(aim + 1, Beam::default);
        }
        let Beam { is_known, audible } = &mut self.beams[aim];
        audible.extend(self.links.iter().filter_map(|&Link { listener, level }| {
            let Listener { receiver, station, .. } = listener;
            let power = budget.milliwatts(level, signal, &listener);
            (power.0 > 0.0).then_some(Audible { receiver, station, power })
        }));
        *is_known = true;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use sextant_channel::{
        Antenna, Channel, ChannelConfig, CorrelationConfig, Db, ObstacleField, Orientation, ReflectionsConfig,
        ShadowingConfig,
    };
    use sextant_kernel::{Seed, SimTime};

    use super::*;
    use crate::air::{
        Air, AirSettings, CarrierThresholds, Emission, Holder, Interface, Mount, ReceptionModel, ReceptionRules,
        Transmission,
    };
    use crate::service::outcome::Deafness;
    use crate::station::{Motion, Pose, Roll};

    const ROLL: Roll = Roll { nodes: 12, robots: 1, sinks: 2 };

    /// Where each station is at the start.
    fn places(seed: Seed) -> Vec<Position> {
        let coordinate =
            |station: usize, axis| 12.0 * seed.uniform(sextant_kernel::Purpose::new(1), [station as u64, axis, 0]);
        (0..ROLL.len()).map(|i| Position::new(coordinate(i, 0), coordinate(i, 1), coordinate(i, 2) / 4.0)).collect()
    }

    fn air(seed: Seed, places: &[Position], reflections: Option<ReflectionsConfig>, knows: bool) -> Air {
        let shadowing = ShadowingConfig { sigma_db: Some(4.0), correlation: CorrelationConfig::PerLink };
        let max_range_m = Some(9.0);
        let config =
            ChannelConfig { shadowing: Some(shadowing), reflections, max_range_m, ..ChannelConfig::default() };
        let settings = AirSettings {
            channel: Channel::new(config.try_into().unwrap(), ObstacleField::default(), seed),
            changes: None,
            power: Dbm(0.0),
            noise: Dbm(f64::MIN),
            gain: Db(40.0),
            floor: Dbm(-75.0),
            sensing: Duration::ZERO,
            salt: 0,
            message_loss: 0.0,
            powers_vary: false,
            seed,
        };
        let fixed = places.iter().enumerate().filter(|&(i, _)| i != ROLL.nodes).map(|(_, &place)| place);
        let mut air = Air::new(settings, fixed, ROLL);
        let rules = ReceptionRules {
            model: ReceptionModel::SirThreshold { least: 2.0 },
            sensitivity: Dbm(-62.0).to_milliwatts(),
            noise: Dbm(-70.0).to_milliwatts(),
            preamble: Duration::from_micros(4),
            lock: 0.2,
            carrier: Some(CarrierThresholds {
                signal: Dbm(-62.0).to_milliwatts(),
                energy: Dbm(-40.0).to_milliwatts(),
            }),
            bit_rate_hz: 0.0,
            bit_error_rate: |_| 0.0,
        };
        air.add_receivers(vec![rules], std::iter::repeat_n(0, ROLL.len()), &[true; 15]);
        let antenna = "sectors = { azimuth_sectors = 8, quasi_omni_gain_dbi = 2.0, gain_ripple_db = 1.5 }";
        let antenna: sextant_channel::AntennaConfig = toml::from_str(antenna).unwrap();
        let antenna: Arc<Antenna> = Arc::new(antenna.try_into().unwrap());
        for station in ROLL.stations() {
            let orientation = Orientation::heading(f64::from(station.0));
            let ripple = antenna.ripple(seed, station);
            let holder = if ROLL.is_robot(station) { Holder::Station } else { Holder::World };
            air.mount(
                interface(station).receiver,
                Mount { antenna: Arc::clone(&antenna), orientation, holder, ripple },
            );
        }
        if knows {
            let standing = ROLL.stations().filter(|&station| !ROLL.is_robot(station));
            air.know_standing(standing.map(|station| (interface(station), places[station.index()])));
        }
        air
    }

    fn interface(station: StationId) -> Interface {
        Interface { receiver: ReceiverId(station.0), station }
    }

    /// All that an air tells about random frames of all stations, among which radios fall asleep and a robot drives.
    fn told(seed: Seed, places: &[Position], mut air: Air) -> Vec<String> {
        let mut motions: Vec<Motion> = places.iter().map(|&place| Motion::standing(place)).collect();
        let draw = |step: u64, of: u64, below: u64| seed.bits(sextant_kernel::Purpose::new(2), [step, of, 0]) % below;
        let mut on_air: Vec<(SimTime, StationId, Transmission)> = Vec::new();
        let (mut arrivals, mut changes, mut told) = (Vec::new(), Vec::new(), Vec::new());
        for station in ROLL.stations() {
            let Interface { receiver, station } = interface(station);
            air.listen(SimTime::ZERO, receiver, station, &motions[station.index()]);
        }
        for step in 0..400 {
            let now = SimTime::ZERO + Duration::from_micros(7 * (step + 1));
            while let Some(first) = (0..on_air.len()).filter(|&i| on_air[i].0 <= now).min_by_key(|&i| on_air[i].0) {
                let (end, sender, transmission) = on_air.remove(first);
                air.end(end, &transmission, &mut arrivals);
                let received =
                    arrivals.iter().filter(|arrival| arrival.outcome != crate::service::outcome::FrameOutcome::Weak);
                told.push(format!("{end:?} {:?}", received.collect::<Vec<_>>()));
                if arrivals.is_empty() {
                    told.push(format!("{:?}", air.missed(&transmission)));
                }
                air.listen(end, interface(sender).receiver, sender, &motions[sender.index()]);
            }
            let station = StationId::from_index(usize::try_from(draw(step, 0, ROLL.len() as u64)).unwrap());
            let Interface { receiver, .. } = interface(station);
            if on_air.iter().any(|&(_, sender, _)| sender == station) {
                continue;
            }
            if ROLL.is_robot(station) && draw(step, 1, 2) == 0 {
                let place = Position::new(draw(step, 2, 12) as f64, draw(step, 3, 12) as f64, 0.0);
                let heading_rad = draw(step, 8, 6) as f64;
                motions[station.index()] = Motion::Standing(Pose { position: place, heading_rad });
                air.moves(receiver, station, &motions[station.index()]);
            }
            let motion = motions[station.index()];
            if draw(step, 4, 6) == 0 {
                air.deafen(now, receiver, station, &motion, Deafness::Asleep);
                continue;
            }
            air.deafen(now, receiver, station, &motion, Deafness::Transmitting);
            let sector = u8::try_from(draw(step, 5, 9)).unwrap();
            let aim = if sector == 8 { Aim::Omnidirectional } else { Aim::Sector(sector) };
            let to = (draw(step, 6, 2) == 0).then(|| ReceiverId(u32::try_from(draw(step, 7, 15)).unwrap()));
            let to = to.filter(|&to| to != receiver);
            let airtime = Duration::from_micros(15);
            let emission = Emission { power: Dbm(0.0), aim };
            air.turn(receiver, motion.pose_at(now).heading_rad);
            let transmission = air.begin(now, interface(station), to, motion.at(now), emission, airtime);
            on_air.push((now + airtime, station, transmission));
            air.take_carrier_changes(&mut changes);
            told.push(format!("{changes:?} {transmission:?}"));
        }
        told
    }

    #[test]
    fn what_is_worked_out_once_is_what_each_frame_would_find() {
        let ground =
            ReflectionsConfig { loss_db: Some(6.0), ground_z_m: Some(-2.0), most: 2, ..ReflectionsConfig::default() };
        for (seed, reflections) in [(Seed(1), None), (Seed(2), None), (Seed(3), None), (Seed(4), Some(ground))] {
            let places = places(seed);
            let one_by_one = told(seed, &places, air(seed, &places, reflections, false));
            assert!(one_by_one.iter().filter(|line| line.contains("Received")).count() > 20, "{one_by_one:#?}");
            assert!(one_by_one.iter().filter(|line| line.contains("Collided")).count() > 5, "{one_by_one:#?}");
            let at_once = told(seed, &places, air(seed, &places, reflections, true));
            assert_eq!(one_by_one, at_once, "{seed:?}");
            // The same if nearly all is forgotten again and again.
            let mut forgetful = air(seed, &places, reflections, true);
            forgetful.medium.remember_at_most(20);
            assert_eq!(told(seed, &places, forgetful), at_once, "{seed:?}");
        }
    }
}
