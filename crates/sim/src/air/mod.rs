//! The air between the stations: the signals of one band, and all radios that listen to them.

mod budget;
mod carrier;
mod cells;
mod changes;
mod followed;
mod footprint;
mod history;
mod incoming;
mod interface;
mod items;
mod late;
mod listener;
mod medium;
mod mounts;
mod noise;
mod reached;
mod receiver;
mod receiver_id;
mod reception_model;
mod reception_rules;
mod screens;
mod sense;
mod signal;
mod surroundings;
mod transmission;
mod ways;

use std::time::Duration;

use sextant_channel::{Channel, Db, Dbm, Position};
use sextant_kernel::{Seed, SimTime, StationId};

use crate::service::outcome::Deafness;
use crate::station::{Motion, Roll};
use budget::Budget;
use footprint::Audible;
use history::History;
use late::{LateSteps, Taking};
use listener::Listener;
use medium::Medium;
use reached::Reached;
use receiver::Receiver;

pub(crate) use changes::{Changes, Links as ChangingLinks};
pub(crate) use interface::Interface;
pub(crate) use items::{LinkItems, PlacedRadio};
pub(crate) use mounts::{Holder, Mount};
pub(crate) use noise::Burst;
pub(crate) use receiver_id::ReceiverId;
pub use reception_model::{ReceptionConfig, ReceptionModel, ThresholdConfig};
pub(crate) use reception_rules::{CarrierThresholds, ReceptionRules};
pub(crate) use screens::Screens;
pub(crate) use sense::Sense;
pub(crate) use signal::{Aim, Emission};
pub(crate) use transmission::{Arrival, Asked, Transmission};

/// The channel became busy or idle at a receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarrierChange {
    pub(crate) station: StationId,
    pub(crate) is_busy: bool,
}

/// The air of one band. The audience of a network are the stations whose applications look at what is delivered to
/// them: a frame to all is for them.
pub(crate) struct Air {
    medium: Medium,
    receivers: Vec<Receiver>,
    /// Whether the station of each receiver is in the audience of its network.
    in_audience: Vec<bool>,
    /// The rules of the receivers, ...
    rules: Vec<ReceptionRules>,
    /// ... and which of them each receiver has.
    rules_of: Vec<u32>,
    roll: Roll,
    /// The nodes that move, in their order.
    moving: Vec<StationId>,
    /// The receivers of the audience of each network.
    audiences: Vec<Vec<ReceiverId>>,
    /// Number of receivers of each network that listen and are in its audience.
    audience_listening: Vec<usize>,
    packets: u64,
    salt: u64,
    /// Number of bursts of noise so far.
    bursts: u64,
    /// Share of the frames, received otherwise, that a receiver loses.
    message_loss: f64,
    seed: Seed,
    /// A robot that is farther from a sender does not count among those who could have heard it (m).
    hearing_m: f64,
    near: Vec<Listener<Position>>,
    /// The receivers that may drive and hear a signal that begins.
    mobile_audible: Vec<Audible>,
    reached: Reached,
    /// Changes of the carrier that have not been taken yet.
    carrier_changes: Vec<CarrierChange>,
    /// The last signals, if somebody asks who disturbed whom.
    history: Option<History>,
    /// The steps that receivers take late, if they need not take them at once.
    late: Option<LateSteps>,
}

/// Settings of the air.
pub(crate) struct AirSettings {
    pub(crate) channel: Channel,
    /// What changes links in time, if anything does.
    pub(crate) changes: Option<Changes>,
    /// Largest transmit power.
    pub(crate) power: Dbm,
    /// Largest power of an interferer; far below all others if there is none.
    pub(crate) noise: Dbm,
    /// Largest gain of both antennas of a link together.
    pub(crate) gain: Db,
    /// Signals below it may be neglected.
    pub(crate) floor: Dbm,
    /// Window of carrier sense.
    pub(crate) sensing: Duration,
    /// What the addresses of draws of this band have that others have not.
    pub(crate) salt: u64,
    /// Share of the frames, received otherwise, that a receiver loses.
    pub(crate) message_loss: f64,
    /// Whether stations may change their transmit power.
    pub(crate) powers_vary: bool,
    pub(crate) seed: Seed,
}

impl Air {
    pub(crate) fn new(settings: AirSettings, places: impl Iterator<Item = Position> + Clone, roll: Roll) -> Self {
        let AirSettings {
            channel,
            changes,
            power,
            noise,
            gain,
            floor,
            sensing,
            salt,
            message_loss,
            powers_vary,
            seed,
        } = settings;
        let first_robot = StationId::from_index(roll.nodes).0;
        let mobile = first_robot..StationId::from_index(roll.nodes + roll.robots).0;
        let emission = Emission { power, aim: Aim::Omnidirectional };
        let budget = Budget::new(channel, changes, emission, floor, roll.len(), mobile);
        let budget = if powers_vary { budget.with_varying_powers() } else { budget };
        Self {
            medium: Medium::new(budget, places, if noise > power { noise } else { power } + gain, floor, sensing),
            receivers: Vec::new(),
            in_audience: Vec::new(),
            rules: Vec::new(),
            rules_of: Vec::new(),
            roll,
            moving: Vec::new(),
            audiences: Vec::new(),
            audience_listening: Vec::new(),
            packets: 0,
            salt,
            bursts: 0,
            message_loss,
            seed,
            hearing_m: f64::INFINITY,
            near: Vec::new(),
            mobile_audible: Vec::new(),
            reached: Reached::default(),
            carrier_changes: Vec::new(),
            history: None,
            late: None,
        }
    }

    /// The same air, in which the nodes `moving` move, in their order. Called before the start.
    pub(crate) fn with_moving(mut self, moving: Vec<StationId>) -> Self {
        self.medium.let_move(moving.clone());
        self.moving = moving;
        self
    }

    /// Adds a network: a receiver for each station, with one of these `rules`, whose number `rules_of` tells; `audience`
    /// tells which stations are in the audience. Returns the number of the first receiver; the others follow in the order
    /// of the stations.
    pub(crate) fn add_receivers(
        &mut self,
        rules: Vec<ReceptionRules>,
        rules_of: impl Iterator<Item = u16>,
        audience: &[bool],
    ) -> u32 {
        let first = self.receivers.len();
        self.receivers.resize(first + self.roll.len(), Receiver::default());
        self.in_audience.extend(audience);
        self.medium.add_radios(self.roll.len());
        let first = u32::try_from(first).expect("at most 2^32 receivers");
        let of_audience = (first..).zip(audience).filter(|&(_, &is_member)| is_member);
        self.audiences.push(of_audience.map(|(receiver, _)| ReceiverId(receiver)).collect());
        self.audience_listening.push(0);
        let first_rules = u32::try_from(self.rules.len()).expect("at most 2^24 rules");
        self.rules_of.extend(rules_of.map(|number| first_rules + u32::from(number)));
        self.rules.extend(rules);
        first
    }

    /// The number of the network of a receiver.
    #[inline]
    fn network(&self, receiver: ReceiverId) -> usize {
        if self.audiences.len() == 1 { 0 } else { receiver.index() / self.roll.len() }
    }

    #[inline]
    fn rules(&self, receiver: ReceiverId) -> &ReceptionRules {
        &self.rules[self.rules_of[receiver.index()] as usize]
    }

    fn is_mobile(&self, station: StationId) -> bool {
        let index = station.index();
        let is_robot = index >= self.roll.nodes && index < self.roll.nodes + self.roll.robots;
        is_robot || !self.moving.is_empty() && self.moving.binary_search(&station).is_ok()
    }

    /// Whether a receiver listens.
    pub(crate) fn is_listening(&self, receiver: ReceiverId) -> bool {
        self.receivers[receiver.index()].is_listening()
    }

    /// The radio of a station starts to listen.
    pub(crate) fn listen(&mut self, now: SimTime, receiver: ReceiverId, station: StationId, motion: &Motion) {
        if self.is_listening(receiver) {
            return;
        }
        let network = self.network(receiver);
        self.audience_listening[network] += usize::from(self.in_audience[receiver.index()]);
        let place = motion.at(now);
        if let Some(late) = &mut self.late {
            late.listens(receiver);
        } else if self.is_mobile(station) {
            self.medium.join_mobile(receiver, station, *motion);
        } else {
            self.medium.join(receiver, station, place);
        }
        self.turn(receiver, motion.pose_at(now).heading_rad);
        let on_air = self.medium.on_air(now, place);
        self.receivers[receiver.index()].start(now);
        let rules = *self.rules(receiver);
        for signal in on_air.iter().filter(|signal| signal.sender != receiver) {
            if let Some(power) = self.medium.power_at(signal, &Listener { receiver, station, place })
                && power.0 > 0.0
            {
                let missed = Some(self.receivers[receiver.index()].deafness_since(signal.start));
                self.receivers[receiver.index()].begin(now, signal.packet, power, missed, &rules);
                self.reached.join(signal.packet, receiver, station);
            }
        }
        self.note_carrier(receiver, station, &rules);
    }

    /// Mounts the antenna of a radio.
    pub(crate) fn mount(&mut self, receiver: ReceiverId, mount: Mount) {
        self.medium.mounts_mut().add(receiver, mount);
    }

    /// The station of a radio, which listens or not, has this heading now (rad).
    pub(crate) fn turn(&mut self, receiver: ReceiverId, heading_rad: f64) {
        self.medium.mounts_mut().turn(receiver, heading_rad);
    }

    /// The body with this number, if it hides links, moves like this from now on; without a motion it is gone.
    pub(crate) fn body_moves(&mut self, body: usize, motion: Option<Motion>) {
        if let Some(screens) = self.medium.screens_mut() {
            screens.moves(body, motion);
        }
    }

    /// Says which radios stand for good, and where: those of all stations that never drive. Called before the start.
    pub(crate) fn know_standing(&mut self, standing: impl Iterator<Item = (Interface, Position)>) {
        let listener = |(Interface { receiver, station }, place)| Listener { receiver, station, place };
        self.medium.know_standing(standing.map(listener));
    }

    /// Tells receivers of signals when they are asked what they heard, if `all` radios stand for good, their powers last, and
    /// nobody asks before a frame ends. Called before the start.
    pub(crate) fn tell_late(&mut self, all: impl Iterator<Item = (Interface, Position)>) {
        let says_changes = self.rules.iter().any(|rules| rules.carrier.is_some());
        if says_changes || self.roll.robots > 0 || !self.moving.is_empty() || self.audiences.len() != 1 {
            return;
        }
        let listener = |(Interface { receiver, station }, place)| Listener { receiver, station, place };
        let receivers = self.receivers.len();
        let surroundings = self.medium.all_surroundings(all.map(listener));
        self.late = surroundings.map(|surroundings| LateSteps::new(surroundings, receivers));
    }

    /// A receiver that is told late takes the steps so far.
    fn take_steps(&mut self, id: ReceiverId) {
        let Self { late: Some(late), medium, receivers, rules, rules_of, .. } = self else { return };
        late.take(Taking { id, receiver: &mut receivers[id.index()], medium, rules, rules_of });
    }

    /// The changes of the carrier since the last call, in their order; `changes` is emptied first.
    pub(crate) fn take_carrier_changes(&mut self, changes: &mut Vec<CarrierChange>) {
        changes.clear();
        std::mem::swap(changes, &mut self.carrier_changes);
    }

    /// Notes whether the channel became busy or idle at a receiver.
    #[inline]
    fn note_carrier(&mut self, receiver: ReceiverId, station: StationId, rules: &ReceptionRules) {
        note_carrier(&mut self.receivers[receiver.index()], station, rules, &mut self.carrier_changes);
    }

    /// A station that listens, or not, moves differently from now on.
    pub(crate) fn moves(&mut self, receiver: ReceiverId, station: StationId, motion: &Motion) {
        if self.is_listening(receiver) {
            self.medium.join_mobile(receiver, station, *motion);
        }
    }

    /// The radio of a station stops listening, or stays deaf, from now on for this reason.
    pub(crate) fn deafen(
        &mut self,
        now: SimTime,
        receiver: ReceiverId,
        station: StationId,
        motion: &Motion,
        deafness: Deafness,
    ) {
        if self.is_listening(receiver) {
            let network = self.network(receiver);
            self.audience_listening[network] -= usize::from(self.in_audience[receiver.index()]);
            if self.late.is_some() {
                // Nobody looks for those that listen.
            } else if self.is_mobile(station) {
                self.medium.leave_mobile(receiver);
            } else {
                self.medium.leave(receiver, motion.at(now));
            }
        }
        self.receivers[receiver.index()].stop(now, deafness);
    }

    /// Whether carrier sense finds the channel busy.
    #[inline]
    pub(crate) fn is_busy(&mut self, sense: &Sense) -> bool {
        self.medium.is_busy(sense)
    }

    /// Whether it is certain already that carrier sense will find the channel busy.
    #[inline]
    pub(crate) fn will_be_busy(&mut self, sense: &Sense) -> bool {
        self.medium.will_be_busy(sense)
    }

    /// The end of the last window, not before that of `sense`, of which it is certain already that carrier sense will find the
    /// channel busy; `None` if that is not known for all windows together.
    #[inline]
    pub(crate) fn busy_until(&mut self, sense: &Sense) -> Option<SimTime> {
        self.medium.busy_until(sense)
    }

    /// Robots farther than `hearing_m` from a sender do not count among those who could have heard it from now on.
    pub(crate) fn limit_hearing(&mut self, hearing_m: f64) {
        self.hearing_m = hearing_m;
    }

    /// The address of the draws of a signal that begins now.
    fn draw_at(&self, now: SimTime) -> u64 {
        now.as_nanos() ^ self.salt
    }
}

/// Notes whether the channel became busy or idle at a receiver.
#[inline]
fn note_carrier(
    receiver: &mut Receiver,
    station: StationId,
    rules: &ReceptionRules,
    changes: &mut Vec<CarrierChange>,
) {
    if rules.carrier.is_some()
        && let Some(is_busy) = receiver.carrier_change(rules)
    {
        changes.push(CarrierChange { station, is_busy });
    }
}
