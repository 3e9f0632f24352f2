//! Frames on air: whom they reach when they begin, and what has become of them at their end.

use std::time::Duration;

use sextant_channel::{Milliwatts, Position};
use sextant_kernel::{SimTime, StationId};

use super::footprint::Audible;
use super::late::LateSteps;
use super::listener::Listener;
use super::receiver::EndedSignal;
use super::receiver_id::ReceiverId;
use super::signal::{Emission, Outline, Signal};
use super::{Air, Interface, note_carrier};
use crate::purpose;
use crate::service::outcome::{Deafness, FrameOutcome};

/// A receiver that a signal reaches, and its station.
type Whom = (ReceiverId, StationId);

/// Of whom it is asked what it heard of a transmission, at its end.
#[derive(Clone, Copy)]
pub(crate) enum Asked<'a> {
    /// This station.
    One(StationId),
    /// Those of these stations that may have received it.
    WhoReceives(&'a dyn Fn(StationId) -> bool),
    /// All.
    All,
}

/// A transmission under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmission {
    pub(super) signal: Outline,
    /// Number of its network among those of the band.
    network: usize,
    /// The receiver that it is for; `None` if it is for all.
    to: Option<ReceiverId>,
    /// Whether a station that it is for listened when it began, but beyond the radius of communication.
    beyond: bool,
    /// Whether a station that it is for listened when it began, but its power there was negligible.
    faint: bool,
}

/// The outcome of a transmission at one receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) station: StationId,
    pub(crate) power: Milliwatts,
    /// Smallest ratio of signal to interference and noise while the frame was followed, as a factor.
    pub(crate) sinr: f64,
    pub(crate) outcome: FrameOutcome,
    /// Whether the radio was locked on to it at its end; with the model `overlap`, whether nothing has disturbed it.
    pub(crate) was_followed: bool,
}

impl Air {
    /// The station of `sender` starts to send a frame, to the station of the receiver `to` or to all of its network.
    pub(crate) fn begin(
        &mut self,
        now: SimTime,
        Interface { receiver: sender, station: source }: Interface,
        to: Option<ReceiverId>,
        position: Position,
        emission: Emission,
        airtime: Duration,
    ) -> Transmission {
        let (packet, draw, end) = (self.packets, self.draw_at(now), now + airtime);
        let signal = Signal { packet, draw, source, sender, position, emission, start: now, end };
        self.packets += 1;
        self.medium.begin(signal);
        if let Some(history) = &mut self.history {
            history.add(signal);
        }
        let network = self.network(sender);
        let listening = match to {
            Some(to) => usize::from(self.is_listening(to)),
            // A radio that sends is deaf, so the sender is not among them.
            None => self.audience_listening[network] - self.too_far(&signal, network),
        };
        let mut reached = self.reached.spare();
        let (within, faint) = if self.late.is_some() {
            self.note_begin(&signal, to)
        } else {
            let within = match self.medium.has_footprints() {
                true => self.reach_footprint(&signal, to, &mut reached),
                false => self.reach_listeners(&signal, to, &mut reached),
            };
            let is_for = |&&(receiver, _): &&Whom| match to {
                Some(to) => receiver == to,
                None => self.in_audience[receiver.index()] && self.network(receiver) == network,
            };
            (within, within > reached.iter().filter(is_for).count())
        };
        self.reached.begin(signal.packet, reached);
        Transmission { signal: signal.outline(), network, to, beyond: listening > within, faint }
    }

    /// A signal begins: it reaches the listeners one by one. Returns the number of those within the radius of
    /// communication that it is for.
    fn reach_listeners(&mut self, signal: &Signal, to: Option<ReceiverId>, reached: &mut Vec<Whom>) -> usize {
        let network = self.network(signal.sender);
        let (is_only, stations) = (self.audiences.len() == 1, self.roll.len());
        let network_of = |receiver: ReceiverId| if is_only { 0 } else { receiver.index() / stations };
        let Self { medium, receivers, in_audience, rules, rules_of, carrier_changes, near, .. } = self;
        medium.listeners(signal, near);
        let mut within = 0;
        for listener in &*near {
            if let Some(power) = medium.power_at(signal, listener) {
                let &Listener { receiver, station, .. } = listener;
                let is_for = match to {
                    Some(to) => receiver == to,
                    None => in_audience[receiver.index()] && network_of(receiver) == network,
                };
                within += usize::from(is_for);
                // A negligible power is not even interference.
                if power.0 > 0.0 {
                    let rules = &rules[rules_of[receiver.index()] as usize];
                    let radio = &mut receivers[receiver.index()];
                    radio.begin(signal.start, signal.packet, power, None, rules);
                    note_carrier(radio, station, rules, carrier_changes);
                    reached.push((receiver, station));
                }
            }
        }
        within
    }

    /// The same for a signal whose footprint is known.
    fn reach_footprint(&mut self, signal: &Signal, to: Option<ReceiverId>, reached: &mut Vec<Whom>) -> usize {
        let mut mobile = std::mem::take(&mut self.mobile_audible);
        self.medium.mobile_audible(signal, &mut mobile);
        let Self { medium, receivers, in_audience, rules, rules_of, carrier_changes, .. } = self;
        let (links, audible) = medium.footprint(signal);
        let within = match to {
            Some(to) => {
                let stands = links.binary_search_by_key(&to, |link| link.listener.receiver).is_ok();
                let is_within = stands || mobile.iter().any(|audible| audible.receiver == to);
                usize::from(is_within && receivers[to.index()].is_listening())
            }
            None => {
                let standing = links.iter().map(|link| link.listener.receiver);
                let all = standing.chain(mobile.iter().map(|audible| audible.receiver));
                all.filter(|to| in_audience[to.index()] && receivers[to.index()].is_listening()).count()
            }
        };
        let mut reach = |&Audible { receiver, station, power }: &Audible| {
            let radio = &mut receivers[receiver.index()];
            if radio.is_listening() && power.0 > 0.0 {
                let rules = &rules[rules_of[receiver.index()] as usize];
                radio.begin(signal.start, signal.packet, power, None, rules);
                note_carrier(radio, station, rules, carrier_changes);
                reached.push((receiver, station));
            }
        };
        // By receiver.
        let mut moving = mobile.iter().peekable();
        for standing in audible {
            while let Some(audible) = moving.next_if(|audible| audible.receiver < standing.receiver) {
                reach(audible);
            }
            reach(standing);
        }
        moving.for_each(reach);
        self.mobile_audible = mobile;
        within
    }

    /// The same where receivers are told late: they need not be reached. Also returns whether the power is negligible at one that
    /// the signal is for.
    fn note_begin(&mut self, signal: &Signal, to: Option<ReceiverId>) -> (usize, bool) {
        if self.late.as_ref().is_some_and(LateSteps::is_full) {
            self.take_all_steps();
        }
        let Self { medium, receivers, in_audience, rules, rules_of, late: Some(late), .. } = self else {
            unreachable!("it was asked whether receivers are told late")
        };
        late.begin(*signal);
        let rules_at = |receiver: ReceiverId| &rules[rules_of[receiver.index()] as usize];
        let surroundings = medium.surroundings(&mut late.surroundings, signal, rules_at);
        let (mut within, mut faint) = (0, false);
        let mut count = |power: Milliwatts| {
            within += 1;
            faint |= power.0 <= 0.0;
        };
        match to {
            Some(to) if receivers[to.index()].is_listening() => {
                surroundings.power_at(to).into_iter().for_each(&mut count);
            }
            Some(_) => {}
            None => {
                let is_for = |receiver: ReceiverId| {
                    in_audience[receiver.index()] && receivers[receiver.index()].is_listening()
                };
                let all = surroundings.all.iter().filter(|audible| is_for(audible.receiver));
                all.for_each(|audible| count(audible.power));
            }
        }
        (within, faint)
    }

    /// All receivers that are told late take the steps so far.
    fn take_all_steps(&mut self) {
        for receiver in 0..self.receivers.len() {
            self.take_steps(ReceiverId(u32::try_from(receiver).expect("at most 2^32 receivers")));
        }
        if let Some(late) = &mut self.late {
            late.forget();
        }
    }

    /// Number of robots that listen in the audience of a network, but are too far from the sender to count.
    #[inline]
    fn too_far(&self, signal: &Signal, network: usize) -> usize {
        if self.hearing_m.is_infinite() {
            return 0;
        }
        let is_in = |receiver: ReceiverId| self.in_audience[receiver.index()] && self.network(receiver) == network;
        self.medium.mobile_beyond(signal, self.hearing_m).filter(|&receiver| is_in(receiver)).count()
    }

    /// A frame ends: fills `arrivals` with its outcome at each radio of its network that it reached, by receiver. For the radios
    /// of other networks in the band it was only a disturbance.
    pub(crate) fn end(&mut self, now: SimTime, transmission: &Transmission, arrivals: &mut Vec<Arrival>) {
        self.end_asking(now, transmission, Asked::All, arrivals);
    }

    /// The same, where only those that are `asked` matter: others may be left out.
    pub(crate) fn end_asking(
        &mut self,
        now: SimTime,
        transmission: &Transmission,
        asked: Asked<'_>,
        arrivals: &mut Vec<Arrival>,
    ) {
        if self.late.is_some() {
            return self.note_end(now, transmission, asked, arrivals);
        }
        let reached = self.reached.end(transmission.signal.packet);
        arrivals.clear();
        for &(receiver, station) in &reached {
            arrivals.extend(self.end_at(now, transmission, receiver, station));
        }
        self.reached.give_back(reached);
    }

    /// A frame ends at a receiver: its outcome, if it is told.
    #[inline]
    fn end_at(
        &mut self,
        now: SimTime,
        transmission: &Transmission,
        receiver: ReceiverId,
        station: StationId,
    ) -> Option<Arrival> {
        let &Transmission { signal, network, .. } = transmission;
        let seed = self.seed;
        let luck = || seed.uniform(purpose::RECEPTION, signal.draw_at(receiver));
        let rules = &self.rules[self.rules_of[receiver.index()] as usize];
        let radio = &mut self.receivers[receiver.index()];
        let EndedSignal { power, sinr, outcome, was_followed } = radio.end(now, signal.packet, rules, luck)?;
        note_carrier(radio, station, rules, &mut self.carrier_changes);
        // A signal that cannot be received is told only to the radio that it is for, and to collectors.
        let is_told = outcome != FrameOutcome::Weak
            || transmission.to.is_none_or(|to| to == receiver)
            || !(self.medium.has_footprints() && self.roll.is_node(station));
        if !is_told || self.network(receiver) != network {
            return None;
        }
        let is_lost = outcome == FrameOutcome::Received && self.loses(&signal, receiver, station);
        let outcome = if is_lost { FrameOutcome::Weak } else { outcome };
        Some(Arrival { station, power, sinr, outcome, was_followed })
    }

    /// The same where receivers are told late.
    fn note_end(&mut self, now: SimTime, transmission: &Transmission, asked: Asked<'_>, arrivals: &mut Vec<Arrival>) {
        arrivals.clear();
        let Outline { packet, sender, .. } = transmission.signal;
        let mut whom = self.reached.end(packet);
        self.find_asked(transmission, asked, &mut whom);
        for &(receiver, station) in whom.iter().filter(|(receiver, _)| *receiver != sender) {
            self.take_steps(receiver);
            arrivals.extend(self.end_at(now, transmission, receiver, station));
            if let Some(late) = &mut self.late {
                late.has_taken_next(receiver);
            }
        }
        let Self { medium, receivers, rules, rules_of, late: Some(late), .. } = self else { return };
        let Some((signal, began)) = late.end(now, packet) else { return };
        if matches!(asked, Asked::All) {
            let rules_at = |receiver: ReceiverId| &rules[rules_of[receiver.index()] as usize];
            let LateSteps { surroundings, marks, .. } = late;
            let surroundings = medium.surroundings(surroundings, &signal, rules_at);
            for &Audible { receiver, station, power } in &surroundings.all {
                let rules = rules_at(receiver);
                // Who heard it from its begin, and could not receive it: nothing else matters.
                let has_it = receivers[receiver.index()].is_listening() && marks.listens_since(receiver, began);
                if power.0 > 0.0 && power < rules.sensitivity && has_it {
                    let sinr = power.ratio(rules.noise);
                    let outcome = FrameOutcome::Weak;
                    arrivals.push(Arrival { station, power, sinr, outcome, was_followed: false });
                }
            }
            arrivals.sort_by_key(|arrival| arrival.station);
        }
        self.reached.give_back(whom);
    }

    /// Adds to those that began to listen to a transmission in its course the others that have to be asked about it, or keeps
    /// only those; by receiver.
    fn find_asked(&mut self, transmission: &Transmission, asked: Asked<'_>, whom: &mut Vec<Whom>) {
        if let Asked::One(station) = asked {
            whom.clear();
            whom.push((ReceiverId(station.0), station));
            return;
        }
        let Self { medium, rules, rules_of, late: Some(late), .. } = self else { return };
        let Some(signal) = late.signal(transmission.signal.packet) else { return };
        let rules_at = |receiver: ReceiverId| &rules[rules_of[receiver.index()] as usize];
        let surroundings = medium.surroundings(&mut late.surroundings, &signal, rules_at);
        whom.extend(surroundings.near.iter().map(|audible| (audible.receiver, audible.station)));
        if let Asked::WhoReceives(asks) = asked {
            whom.retain(|&(_, station)| asks(station));
        }
        whom.sort_unstable();
        whom.dedup();
    }

    /// The outcome of a transmission that ends now at the receivers that it is for, if it reached none of them.
    pub(crate) fn missed(&self, transmission: &Transmission) -> FrameOutcome {
        if transmission.faint && self.is_listened_to(transmission) {
            return FrameOutcome::Weak;
        }
        if transmission.beyond {
            return FrameOutcome::OutOfRange;
        }
        match &transmission.to {
            Some(to) => self.missed_by(transmission, std::iter::once(*to)),
            None => self.missed_by(transmission, self.audiences[transmission.network].iter().copied()),
        }
    }

    /// Whether a station that a transmission is for listens at its end.
    fn is_listened_to(&self, transmission: &Transmission) -> bool {
        match transmission.to {
            Some(to) => self.is_listening(to),
            None => self.audience_listening[transmission.network] > 0,
        }
    }

    /// The same at these `receivers`, none of which listened.
    pub(crate) fn missed_by(
        &self,
        transmission: &Transmission,
        receivers: impl Iterator<Item = ReceiverId>,
    ) -> FrameOutcome {
        let Outline { sender, start, .. } = transmission.signal;
        let others = receivers.filter(|&receiver| receiver != sender);
        let deafness = others.map(|receiver| self.receivers[receiver.index()].deafness_since(start)).max();
        FrameOutcome::NotListened(deafness.unwrap_or(Deafness::Off))
    }

    /// Whether a receiver loses a frame that it could receive.
    #[inline]
    fn loses(&self, signal: &Outline, receiver: ReceiverId, station: StationId) -> bool {
        let is_below = |purpose, share| self.seed.uniform(purpose, signal.draw_at(receiver)) < share;
        if self.message_loss > 0.0 && is_below(purpose::MESSAGE_LOSS, self.message_loss) {
            return true;
        }
        let success = self.medium.success(signal.source, station, signal.start);
        success < 1.0 && !is_below(purpose::LINK_SUCCESS, success)
    }
}

impl Transmission {
    /// The station that sends it.
    pub(crate) fn source(&self) -> StationId {
        self.signal.source
    }

    /// Its number in the air.
    pub(crate) fn number(&self) -> u64 {
        self.signal.packet
    }

    /// Start of its first symbol on air.
    pub(crate) fn start(&self) -> SimTime {
        self.signal.start
    }
}
