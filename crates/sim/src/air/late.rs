//! Receivers that are told late.
//!
//! In a network in which all stations listen, each signal reaches many receivers, and hardly any of them is asked what it heard:
//! a frame for one station is asked of that station. So the begin and the end of a signal are noted once. A receiver takes
//! these steps when it is asked: it does late what it would have done at once, and finds the same to the last bit. When no
//! signal is on air, all steps so far are over, and forgotten.

use std::collections::VecDeque;

use sextant_kernel::SimTime;

use super::ReceptionRules;
use super::medium::Medium;
use super::receiver::Receiver;
use super::receiver_id::ReceiverId;
use super::signal::Signal;
use super::surroundings::AllSurroundings;

/// When so many steps are noted, all receivers take them: the air may never be empty.
const MOST_STEPS: usize = 1 << 12;

/// A signal begins or ends.
#[derive(Clone, Copy, Debug)]
struct Step {
    time: SimTime,
    signal: Signal,
    kind: StepKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StepKind {
    Begin,
    End,
}

/// A signal on air, and the number of the step at which it began.
#[derive(Clone, Copy, Debug)]
struct OnAir {
    signal: Signal,
    began: u64,
}

/// What a receiver that listens knows of the steps.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    /// The number of the first step since it listens.
    since: u64,
    /// The number of the first step that it has not taken.
    next: u64,
}

/// What each receiver knows of the steps.
#[derive(Debug)]
pub(super) struct Marks(Vec<Mark>);

impl Marks {
    /// Whether a receiver that listens has done so without a break since this step.
    pub(super) fn listens_since(&self, receiver: ReceiverId, step: u64) -> bool {
        self.0[receiver.index()].since <= step
    }
}

/// The begins and ends of signals, and how far each receiver has taken them.
#[derive(Debug)]
pub(super) struct LateSteps {
    pub(super) surroundings: AllSurroundings,
    /// The last steps, ...
    steps: VecDeque<Step>,
    /// ... and the number of the first one. All signals that began before it and are on air are among the steps.
    first: u64,
    on_air: Vec<OnAir>,
    pub(super) marks: Marks,
}

/// A receiver, and what it needs to take steps.
pub(super) struct Taking<'a> {
    pub(super) id: ReceiverId,
    pub(super) receiver: &'a mut Receiver,
    pub(super) medium: &'a mut Medium,
    pub(super) rules: &'a [ReceptionRules],
    pub(super) rules_of: &'a [u32],
}

impl LateSteps {
    pub(super) fn new(surroundings: AllSurroundings, receivers: usize) -> Self {
        let marks = Marks(vec![Mark::default(); receivers]);
        Self { surroundings, steps: VecDeque::new(), first: 0, on_air: Vec::new(), marks }
    }

    /// The number of the next step.
    fn now(&self) -> u64 {
        self.first + self.steps.len() as u64
    }

    /// A receiver listens from now on.
    pub(super) fn listens(&mut self, receiver: ReceiverId) {
        let now = self.now();
        self.marks.0[receiver.index()] = Mark { since: now, next: now };
    }

    /// A receiver takes the steps that it has not taken.
    pub(super) fn take(&mut self, taking: Taking<'_>) {
        let Taking { id, receiver, medium, rules, rules_of } = taking;
        if !receiver.is_listening() {
            return;
        }
        let now = self.now();
        let Self { surroundings, steps, first, marks, .. } = self;
        let next = &mut marks.0[id.index()].next;
        if *next < *first {
            // The air was empty since.
            receiver.forget();
            *next = *first;
        }
        let own = &rules[rules_of[id.index()] as usize];
        let rules_at = |receiver: ReceiverId| &rules[rules_of[receiver.index()] as usize];
        let taken = usize::try_from(*next - *first).expect("fewer steps than fit in memory");
        for &Step { time, signal, kind } in steps.iter().skip(taken).filter(|step| step.signal.sender != id) {
            match kind {
                StepKind::Begin => {
                    let power = medium.surroundings(surroundings, &signal, rules_at).power_at(id);
                    if let Some(power) = power.filter(|power| power.0 > 0.0) {
                        receiver.begin(time, signal.packet, power, None, own);
                    }
                }
                // Nobody asks what it heard.
                StepKind::End => {
                    receiver.end(time, signal.packet, own, || 0.5);
                }
            }
        }
        *next = now;
    }

    /// A receiver has taken the next step already.
    pub(super) fn has_taken_next(&mut self, receiver: ReceiverId) {
        self.marks.0[receiver.index()].next = self.now() + 1;
    }

    /// A signal begins: the next step.
    pub(super) fn begin(&mut self, signal: Signal) {
        self.on_air.push(OnAir { signal, began: self.now() });
        self.steps.push_back(Step { time: signal.start, signal, kind: StepKind::Begin });
    }

    /// The signal of a packet that is on air.
    pub(super) fn signal(&self, packet: u64) -> Option<Signal> {
        self.on_air.iter().find(|on_air| on_air.signal.packet == packet).map(|on_air| on_air.signal)
    }

    /// The signal of a packet ends: the next step. Returns the signal, and the number of the step at which it began.
    pub(super) fn end(&mut self, now: SimTime, packet: u64) -> Option<(Signal, u64)> {
        let place = self.on_air.iter().position(|on_air| on_air.signal.packet == packet)?;
        let OnAir { signal, began } = self.on_air.remove(place);
        self.steps.push_back(Step { time: now, signal, kind: StepKind::End });
        if self.on_air.is_empty() {
            self.first = self.now();
            self.steps.clear();
        }
        Some((signal, began))
    }

    /// Whether so many steps are noted that all receivers must take them.
    pub(super) fn is_full(&self) -> bool {
        self.steps.len() >= MOST_STEPS
    }

    /// All receivers have taken all steps.
    pub(super) fn forget(&mut self) {
        self.first = self.now();
        self.steps.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_channel::{Channel, ChannelConfig, CorrelationConfig, Dbm, ObstacleField, Position, ShadowingConfig};
    use sextant_kernel::{Purpose, Seed, StationId};

    use super::*;
    use crate::air::{Aim, Air, AirSettings, Asked, Emission, Interface, ReceptionModel, Transmission};
    use crate::service::outcome::Deafness;
    use crate::station::{Motion, Roll};

    const POWER: Dbm = Dbm(-26.0);
    const ROLL: Roll = Roll { nodes: 18, robots: 0, sinks: 2 };

    fn places(seed: Seed) -> Vec<Position> {
        let coordinate = |station: usize, axis| 60.0 * seed.uniform(Purpose::new(1), [station as u64, axis, 0]);
        (0..ROLL.len()).map(|i| Position::new(coordinate(i, 0), coordinate(i, 1), 0.0)).collect()
    }

    fn interface(station: StationId) -> Interface {
        Interface { receiver: ReceiverId(station.0), station }
    }

    fn air(seed: Seed, model: ReceptionModel, places: &[Position]) -> Air {
        let shadowing = Some(ShadowingConfig { sigma_db: Some(4.0), correlation: CorrelationConfig::PerLink });
        let config = ChannelConfig { shadowing, max_range_m: Some(55.0), ..ChannelConfig::default() };
        let settings = AirSettings {
            channel: Channel::new(config.try_into().unwrap(), ObstacleField::default(), seed),
            changes: None,
            power: POWER,
            noise: Dbm(f64::MIN),
            gain: sextant_channel::Db(0.0),
            floor: Dbm(-110.0),
            sensing: Duration::ZERO,
            salt: 0,
            message_loss: 0.0,
            powers_vary: false,
            seed,
        };
        let mut air = Air::new(settings, places.iter().copied(), ROLL);
        let rules = |sensitivity| ReceptionRules {
            model,
            sensitivity: Dbm(sensitivity).to_milliwatts(),
            noise: Dbm(-72.0).to_milliwatts(),
            preamble: Duration::from_micros(4),
            lock: 0.2,
            carrier: None,
            bit_rate_hz: 250_000.0,
            bit_error_rate: |ratio| 0.1 * libm::exp(-ratio),
        };
        let group = |station: usize| u16::from(station.is_multiple_of(5));
        air.add_receivers(vec![rules(-66.0), rules(-62.0)], (0..ROLL.len()).map(group), &[true; 20]);
        air
    }

    /// All that an air tells about random frames of all stations, among which radios fall asleep. Steps share instants.
    fn told(seed: Seed, places: &[Position], mut air: Air, asks_few: bool) -> Vec<String> {
        let motions: Vec<Motion> = places.iter().map(|&place| Motion::standing(place)).collect();
        let draw = |step: u64, of: u64, below: u64| seed.bits(Purpose::new(2), [step, of, 0]) % below;
        let mut on_air: Vec<(SimTime, StationId, Transmission, Option<ReceiverId>)> = Vec::new();
        let (mut arrivals, mut told) = (Vec::new(), Vec::new());
        for station in ROLL.stations() {
            air.listen(SimTime::ZERO, interface(station).receiver, station, &motions[station.index()]);
        }
        for step in 0..3000 {
            let now = SimTime::ZERO + Duration::from_micros(5 * (step / 2 + 1));
            while let Some(first) = (0..on_air.len()).filter(|&i| on_air[i].0 <= now).min_by_key(|&i| on_air[i].0) {
                let (end, sender, transmission, to) = on_air.remove(first);
                let one = to.filter(|_| asks_few).map(|to| StationId(to.0));
                let asked = one.map_or(Asked::All, Asked::One);
                air.end_asking(end, &transmission, asked, &mut arrivals);
                arrivals.retain(|arrival| one.is_none_or(|one| one == arrival.station));
                told.push(format!("{transmission:?} {arrivals:?} {:?}", air.missed(&transmission)));
                air.listen(end, interface(sender).receiver, sender, &motions[sender.index()]);
            }
            let station = StationId::from_index(usize::try_from(draw(step, 0, ROLL.len() as u64)).unwrap());
            if on_air.iter().any(|&(_, sender, ..)| sender == station) {
                continue;
            }
            let (motion, receiver) = (motions[station.index()], interface(station).receiver);
            match draw(step, 4, 6) {
                0 => air.deafen(now, receiver, station, &motion, Deafness::Asleep),
                1 | 2 => air.listen(now, receiver, station, &motion),
                _ => {
                    air.deafen(now, receiver, station, &motion, Deafness::Transmitting);
                    let to = ReceiverId(u32::try_from(draw(step, 7, 20)).unwrap());
                    let to = (draw(step, 6, 3) > 0 && to != receiver).then_some(to);
                    let airtime = Duration::from_micros(5 * (1 + draw(step, 5, 3)));
                    let emission = Emission { power: POWER, aim: Aim::Omnidirectional };
                    let transmission = air.begin(now, interface(station), to, motion.at(now), emission, airtime);
                    on_air.push((now + airtime, station, transmission, to));
                }
            }
        }
        told
    }

    #[test]
    fn receivers_that_are_told_late_hear_the_same() {
        let models = [
            ReceptionModel::Overlap,
            ReceptionModel::SinrThreshold { least: 2.0 },
            ReceptionModel::SirThreshold { least: 2.0 },
            ReceptionModel::Ber,
        ];
        for (seed, model) in (1..).map(Seed).zip(models) {
            let places = places(seed);
            let at_once = told(seed, &places, air(seed, model, &places), false);
            for outcome in ["Received", "Collided", "Weak", "NotListened"] {
                let count = at_once.iter().filter(|line| line.contains(outcome)).count();
                assert!(count > 50, "{model:?}: {outcome} {count} times");
            }
            for (most, asks_few) in [(usize::MAX, false), (20, false), (usize::MAX, true)] {
                let at_once = told(seed, &places, air(seed, model, &places), asks_few);
                let mut late = air(seed, model, &places);
                late.tell_late(ROLL.stations().map(|station| (interface(station), places[station.index()])));
                late.late.as_mut().expect("all stand").surroundings.remember_at_most(most);
                let late = told(seed, &places, late, asks_few);
                for (at_once, late) in at_once.iter().zip(&late) {
                    assert_eq!(at_once, late, "{model:?}, {most} remembered, {asks_few}");
                }
            }
        }
    }
}
