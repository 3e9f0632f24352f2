//! The power of signals between stations: what does not change from packet to packet is worked out once.

mod sectors;

use std::ops::Range;

use sextant_channel::{Channel, Db, Dbm, Milliwatts, Position, Traced};
use sextant_kernel::{SimTime, StationId};

use super::changes::Changes;
use super::items::LinkItems;
use super::listener::Listener;
use super::mounts::Mounts;
use super::receiver_id::ReceiverId;
use super::screens::Screens;
use super::signal::{Aim, Emission, Signal};
use super::ways::{End, Ways};
use sectors::left_over;

use crate::station::{Motion, Pose};

/// Number of links that are remembered: a power of two.
const LINKS: usize = 1 << 20;

/// The power between pairs of stations. That between two stations that stand is remembered, and that between a station
/// that moves and another as long as both are in their places. A link that is not remembered, or was forgotten because
/// another one took its slot, is worked out again, with the same result.
pub(super) struct Budget {
    channel: Channel,
    mounts: Mounts,
    /// Used if antennas have sectors and signals are reflected.
    ways: Ways,
    /// What the remembered links are sent with.
    emission: Emission,
    /// With antennas, a power below it counts as none.
    floor: Dbm,
    /// Whether shadowing changes with each packet.
    is_per_packet: bool,
    /// Whether a station may change its transmit power.
    powers_vary: bool,
    /// What changes links in time, if anything does.
    changes: Option<Box<Changes>>,
    /// Number of stations, which address the slots.
    stations: usize,
    /// The robots, which may move, ...
    mobile: Range<u32>,
    /// ... and the nodes that move, in their order.
    moving: Vec<StationId>,
    links: Vec<Remembered>,
    /// By station that moves, then by other station.
    mobile_links: Vec<RememberedMobile>,
}

/// A remembered link, in a quarter of a cache line.
#[derive(Clone, Copy, Debug, Default)]
struct Remembered {
    /// One plus the address of the link; zero if there is none.
    link: u64,
    /// Mean power (dBm) if each packet has its shadowing, or power (dBm) if antennas have sectors or links change in time, or
    /// else the power (mW). Not a number beyond the radius of communication.
    power: f64,
}

/// A remembered link of a station that moves.
#[derive(Clone, Copy, Debug)]
struct RememberedMobile {
    /// Where the two stations were.
    places: [Position; 2],
    /// Mean power if each packet has its shadowing, or else the power, without antennas (dBm). Not a number
    /// beyond the radius of communication.
    power: f64,
}

impl Budget {
    /// The budget of `stations` stations, of which `mobile` may move.
    pub(super) fn new(
        channel: Channel,
        changes: Option<Changes>,
        emission: Emission,
        floor: Dbm,
        stations: usize,
        mobile: Range<u32>,
    ) -> Self {
        let is_per_packet = channel.law().shadowing().is_per_packet();
        let slots = if stations.saturating_mul(stations) < LINKS { stations * stations } else { LINKS };
        let links = vec![Remembered::default(); slots];
        let nowhere = Position::new(f64::NAN, f64::NAN, f64::NAN);
        let unknown = RememberedMobile { places: [nowhere; 2], power: f64::NAN };
        let mobile_links = vec![unknown; mobile.len() * stations];
        let mounts = Mounts::default();
        Self {
            channel,
            mounts,
            ways: Ways::default(),
            emission,
            floor,
            is_per_packet,
            powers_vary: false,
            changes: changes.map(Box::new),
            stations,
            mobile,
            moving: Vec::new(),
            links,
            mobile_links,
        }
    }

    /// The same, where stations may change their transmit power.
    pub(super) fn with_varying_powers(self) -> Self {
        Self { powers_vary: true, ..self }
    }

    /// Whether stations may change their transmit power.
    pub(super) fn has_varying_powers(&self) -> bool {
        self.powers_vary
    }

    /// These nodes move too, in their order. Called before the first signal.
    pub(super) fn let_move(&mut self, nodes: Vec<StationId>) {
        let nowhere = Position::new(f64::NAN, f64::NAN, f64::NAN);
        let unknown = RememberedMobile { places: [nowhere; 2], power: f64::NAN };
        // Of more nodes nothing is remembered: they move, so that it would seldom help.
        if nodes.len().saturating_mul(self.stations) <= LINKS {
            self.mobile_links.resize((self.mobile.len() + nodes.len()) * self.stations, unknown);
        }
        self.moving = nodes;
    }

    pub(super) fn channel(&self) -> &Channel {
        &self.channel
    }

    /// The antennas, to mount more of them before the first signal, or to turn them.
    pub(super) fn mounts_mut(&mut self) -> &mut Mounts {
        &mut self.mounts
    }

    /// Where a listener that may drive is at `now`; its antenna is turned as it is then.
    pub(super) fn turned(&mut self, listener: &Listener<Motion>, now: SimTime) -> Listener<Position> {
        let &Listener { receiver, station, place } = listener;
        let Pose { position, heading_rad } = place.pose_at(now);
        self.mounts.turn(receiver, heading_rad);
        Listener { receiver, station, place: position }
    }

    /// The heading of the station that holds the antenna of a radio (rad); 0 if none does.
    pub(super) fn heading_rad(&self, receiver: ReceiverId) -> f64 {
        self.mounts.heading_rad(receiver)
    }

    /// Whether radios have antennas with sectors.
    #[inline]
    pub(super) fn has_antennas(&self) -> bool {
        !self.mounts.is_empty()
    }

    /// Power of a signal at a listener; `None` beyond the radius of communication.
    #[inline]
    pub(super) fn power_at(&mut self, signal: &Signal, listener: &Listener<Position>) -> Option<Milliwatts> {
        let &Listener { station, place, .. } = listener;
        if let Some(changes) = &self.changes {
            match changes.traced(signal, station) {
                Traced::Law => {}
                traced @ (Traced::Measured(_) | Traced::Silent) => {
                    return changes.strength(traced).map(Dbm::to_milliwatts);
                }
            }
        }
        if !self.remembers(signal) {
            let mean = self.mean(signal, place)?;
            return Some(self.milliwatts(self.with_shadowing(mean, signal, listener), signal, listener));
        }
        if let Some(mobile) = self.mobile_of(signal.source, station) {
            let known = self.mobile_power(mobile, signal, listener);
            if known.is_nan() {
                return None;
            }
            let shadowed =
                if self.is_per_packet { self.with_shadowing(Dbm(known), signal, listener) } else { Dbm(known) };
            return Some(self.milliwatts(shadowed, signal, listener));
        }
        // The listeners of a signal follow each other.
        let address = signal.source.index() * self.stations + station.index();
        let slot = self.slot(address);
        let mut remembered = self.links[slot];
        if remembered.link != address as u64 + 1 {
            remembered = Remembered { link: address as u64 + 1, power: self.lasting(signal, listener) };
            self.links[slot] = remembered;
        }
        if remembered.power.is_nan() {
            return None;
        }
        if self.is_per_packet {
            let shadowed = self.with_shadowing(Dbm(remembered.power), signal, listener);
            return Some(self.milliwatts(shadowed, signal, listener));
        }
        if self.is_in_decibels() {
            return Some(self.milliwatts(Dbm(remembered.power), signal, listener));
        }
        Some(Milliwatts(remembered.power))
    }

    /// Whether the power between two places is the same for all packets.
    pub(super) fn is_lasting(&self) -> bool {
        !self.is_per_packet && self.changes.is_none()
    }

    /// Whether the lasting part of a power is not all of it, so that it is remembered in decibels.
    #[inline]
    fn is_in_decibels(&self) -> bool {
        self.has_antennas() || self.changes.is_some()
    }

    /// What changes links in time, if anything does.
    pub(super) fn changes(&self) -> Option<&Changes> {
        self.changes.as_deref()
    }

    /// The bodies that hide links, if any does.
    pub(super) fn screens_mut(&mut self) -> Option<&mut Screens> {
        self.changes.as_mut()?.screens_mut()
    }

    /// Whether the power between the sender of a signal and a station is the same for all its signals: both stand, and the
    /// sender keeps its transmit power.
    pub(super) fn stays(&self, signal: &Signal, station: StationId) -> bool {
        self.is_lasting()
            && !self.powers_vary
            && !self.has_antennas()
            && self.mobile_of(signal.source, station).is_none()
    }

    /// Power of a signal at a listener without the gains of antennas, if powers last and there are antennas; `None`
    /// beyond the radius of communication.
    pub(super) fn level(&mut self, signal: &Signal, listener: &Listener<Position>) -> Option<Dbm> {
        let known = match self.mobile_of(signal.source, listener.station) {
            Some(link) if self.remembers(signal) => self.mobile_power(link, signal, listener),
            _ => self.lasting(signal, listener),
        };
        (!known.is_nan()).then_some(Dbm(known))
    }

    /// Whether the powers of such signals are remembered.
    #[inline]
    fn remembers(&self, signal: &Signal) -> bool {
        signal.emission.power == self.emission.power && signal.source.index() < self.stations
    }

    /// The slot of a link: its own if there is one for each, or else one that other links may take.
    fn slot(&self, address: usize) -> usize {
        if self.links.len() < LINKS {
            address
        } else {
            // Fibonacci hashing (Knuth 1998, section 6.4).
            #[expect(clippy::cast_possible_truncation, reason = "below the number of slots")]
            let slot =
                ((address as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - LINKS.trailing_zeros())) as usize;
            slot
        }
    }

    /// What is the same for all packets of a link.
    #[cold]
    fn lasting(&self, signal: &Signal, listener: &Listener<Position>) -> f64 {
        match self.mean(signal, listener.place) {
            None => f64::NAN,
            Some(mean) if self.is_per_packet => mean.0,
            Some(mean) if self.is_in_decibels() => self.with_shadowing(mean, signal, listener).0,
            Some(mean) => self.with_shadowing(mean, signal, listener).to_milliwatts().0,
        }
    }

    /// The place of a link among those of stations that move: the one that moves, and the other.
    #[inline]
    fn mobile_of(&self, source: StationId, listener: StationId) -> Option<usize> {
        let of = |moving: StationId, other: StationId| Some(self.number_of(moving)? * self.stations + other.index());
        of(listener, source).or_else(|| of(source, listener))
    }

    /// The number of a station among those that move.
    #[inline]
    fn number_of(&self, station: StationId) -> Option<usize> {
        if self.mobile.contains(&station.0) {
            return Some((station.0 - self.mobile.start) as usize);
        }
        if self.moving.is_empty() {
            return None;
        }
        self.moving.binary_search(&station).ok().map(|node| self.mobile.len() + node)
    }

    /// What is the same for all packets of a link of a station that moves, while both stand: see [`RememberedMobile`]. It
    /// is the same in both directions.
    fn mobile_power(&mut self, link: usize, signal: &Signal, listener: &Listener<Position>) -> f64 {
        let (source, place) = (signal.position, listener.place);
        if source.distance_m(place) > self.channel.law().max_range_m() {
            // Most nodes of a large network are far from a robot: nothing needs to be remembered of them.
            return f64::NAN;
        }
        if let Some(known) = self.mobile_links.get(link)
            && (known.places == [source, place] || known.places == [place, source])
        {
            return known.power;
        }
        let power = match self.mean(signal, place) {
            None => f64::NAN,
            Some(mean) if self.is_per_packet => mean.0,
            Some(mean) => self.with_shadowing(mean, signal, listener).0,
        };
        if let Some(known) = self.mobile_links.get_mut(link) {
            *known = RememberedMobile { places: [source, place], power };
        }
        power
    }

    fn mean(&self, signal: &Signal, place: Position) -> Option<Dbm> {
        self.channel.mean_power(signal.emission.power, signal.position, place)
    }

    /// The power at the listener, with what changes the link at the start of the signal and the gains of both antennas, if
    /// there are any; zero if it is negligible then. All powers of signals come through here, but for those that last and have
    /// no such gains.
    #[inline]
    pub(super) fn milliwatts(&mut self, power: Dbm, signal: &Signal, listener: &Listener<Position>) -> Milliwatts {
        let power = match &mut self.changes {
            Some(changes) => power + changes.gain(signal, listener) - self.hidden(signal, listener),
            None => power,
        };
        if !self.has_antennas() {
            return power.to_milliwatts();
        }
        let power = self.with_gains(power, signal, listener);
        if power < self.floor { Milliwatts(0.0) } else { power.to_milliwatts() }
    }

    fn with_shadowing(&self, mean: Dbm, signal: &Signal, listener: &Listener<Position>) -> Dbm {
        let &Listener { station, place, .. } = listener;
        mean + self.channel.shadowing(signal.source, signal.position, station, place, signal.draw)
    }

    /// The power with the gains of both antennas, from the power without.
    #[inline]
    fn with_gains(&mut self, power: Dbm, signal: &Signal, listener: &Listener<Position>) -> Dbm {
        let (transmit_gain, receive_gain) = self.gains(signal, listener);
        power + transmit_gain + receive_gain
    }

    /// Gain of the transmitter towards the listener, and that of the listener towards the transmitter.
    #[inline]
    fn gains(&mut self, signal: &Signal, listener: &Listener<Position>) -> (Db, Db) {
        if self.channel.reflects() {
            return self.gains_over_ways(signal, listener);
        }
        let apart = listener.place - signal.position;
        let length_m = apart.length_m();
        if length_m > 0.0 {
            let direction = apart * (1.0 / length_m);
            let transmit_gain = self.mounts.transmit_gain(signal.sender, signal.emission.aim, direction);
            (transmit_gain, self.mounts.receive_gain(listener.receiver, direction * -1.0))
        } else {
            (Db(0.0), self.mounts.receive_gain(listener.receiver, Position::ORIGIN))
        }
    }

    /// The power of a signal at a listener, item by item; `None` beyond the radius of communication.
    pub(super) fn items(&mut self, signal: &Signal, listener: &Listener<Position>) -> Option<LinkItems> {
        let mean = self.mean(signal, listener.place)?;
        let path = self.channel.budget(signal.position, listener.place)?;
        let shadowed = if self.is_per_packet { mean } else { self.with_shadowing(mean, signal, listener) };
        let lasting = self.changes.as_mut().filter(|changes| changes.fades_for_good());
        let fading = lasting.map(|changes| changes.fade(signal, listener));
        let traced = self.changes.as_ref().map_or(Traced::Law, |changes| changes.traced(signal, listener.station));
        let strength = self.changes.as_ref().and_then(|changes| changes.strength(traced));
        let (transmit_gain, receive_gain) = match self.has_antennas() {
            true => self.gains(signal, listener),
            false => (Db(0.0), Db(0.0)),
        };
        Some(LinkItems {
            path,
            shadowing: (!self.is_per_packet).then(|| shadowed - mean),
            transmit_gain,
            receive_gain,
            fading,
            traced,
            power: match traced {
                Traced::Law => shadowed + fading.unwrap_or_default() + transmit_gain + receive_gain,
                Traced::Measured(_) | Traced::Silent => strength.unwrap_or(Dbm::SILENCE),
            },
        })
    }

    /// Gains of the transmitter and of the listener over all ways of a signal: the mean of the gains in their directions,
    /// each with the share of the power that its way carries. What the listener adds is its gain.
    fn gains_over_ways(&mut self, signal: &Signal, listener: &Listener<Position>) -> (Db, Db) {
        let Self { channel, mounts, ways, changes, .. } = self;
        let screens = changes.as_ref().and_then(|changes| changes.screens());
        let from = End { station: signal.source, place: signal.position };
        let rays = ways.between(channel, from, End { station: listener.station, place: listener.place });
        let listens_alike = mounts.listens_alike(listener.receiver);
        let (mut all, mut with_gain, mut with_both) = (0.0, 0.0, 0.0);
        for ray in rays {
            let share = (Db(0.0) - ray.loss).to_factor();
            let aim = if ray.departure.length_m() > 0.0 { signal.emission.aim } else { Aim::Omnidirectional };
            all += share;
            let share = share * left_over(screens, ray, signal, listener);
            let sent = share * mounts.transmit_gain(signal.sender, aim, ray.departure).to_factor();
            with_gain += sent;
            if !listens_alike {
                with_both += sent * mounts.receive_gain(listener.receiver, ray.arrival).to_factor();
            }
        }
        let decibels = |ratio: f64| Db(10.0 * libm::log10(ratio));
        let transmit_gain = if all > 0.0 { decibels(with_gain / all) } else { Db(0.0) };
        let receive_gain = match listens_alike || with_gain <= 0.0 {
            true => mounts.receive_gain(listener.receiver, Position::ORIGIN),
            false => decibels(with_both / with_gain),
        };
        (transmit_gain, receive_gain)
    }
}
