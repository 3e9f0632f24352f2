//! The books of a network at the end: what its record is worked out from.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::{EnergyMeter, EnergySpent, RadioState, RadioStates};

use crate::service::delays::Delays;
use crate::service::due_frames::DueFrames;
use crate::service::packets::{LeftPacket, NetworkRecord, Packets};
use crate::service::rhythm::Rhythm;
use crate::service::sleep::SleepUse;
use crate::service::slots::SlotUse;

/// The books of a network at the end: whole numbers, so that those of parts of a simulation can be added.
#[derive(Debug)]
pub(crate) struct Books {
    /// What became of the packets of each station.
    pub(super) packets: Vec<Packets>,
    /// Octets of the frames of each station that were offered.
    pub(super) octets: Vec<u64>,
    /// The frames of each station that were due, where nodes may rest; otherwise none.
    pub(super) due: Vec<DueFrames>,
    /// Number of frames that were delivered to each station.
    pub(super) deliveries: Vec<u64>,
    /// Time from offer to first reception of the packets of each station that were received; empty without sinks.
    pub(super) delays: Vec<Delays>,
    /// The packets that were sent and stayed in links.
    pub(super) left: Vec<LeftPacket>,
    /// Whether each station is in the network; `None` if all are.
    pub(super) members: Option<Vec<bool>>,
    /// Energy model of the radios.
    pub(super) radio_states: RadioStates,
    /// How the radio of each station was used.
    pub(super) radios: Vec<RadioUse>,
    /// What frames take that were not simulated.
    pub(super) spans: FrameSpans,
    /// How each station used its slots; empty if there are none.
    pub(super) slots: Vec<SlotUse>,
    /// How each station slept; empty if stations do not sleep between checks of the channel.
    pub(super) sleep: Vec<SleepUse>,
    /// When the radio of each station was on by plan; empty if there is no plan.
    pub(super) rhythms: Vec<Option<Rhythm>>,
}

/// What a frame takes that is sent once, on a channel that is not busy.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrameSpans {
    /// Airtime of what comes before the first octet of the MPDU.
    pub(super) header: Duration,
    /// Airtime of an octet.
    pub(super) octet: Duration,
    /// Time with the receiver on, to sense the channel, and turning around.
    pub(super) access: Duration,
}

impl FrameSpans {
    /// Airtime of all these frames together.
    fn airtime(self, frames: DueFrames) -> Duration {
        let nanos = |span: Duration, count: u64| (SimTime::ZERO + span).as_nanos().saturating_mul(count);
        let header = nanos(self.header, frames.frames);
        Duration::from_nanos(header.saturating_add(nanos(self.octet, frames.octets)))
    }
}

/// How a radio was used.
#[derive(Clone, Debug)]
pub(super) struct RadioUse {
    /// How long it was in each state.
    pub(super) meter: EnergyMeter,
    pub(super) tx_power: Dbm,
    /// How long it sent with another power, if a program chose it.
    pub(super) other_powers: Vec<(Dbm, Duration)>,
    /// The state in which it is as long as its station neither sends nor answers.
    pub(super) rests_in: RadioState,
}

/// How much more a radio uses that sends for these times with these powers and not with `tx_power` (J).
pub(super) fn more_j(other_powers: &[(Dbm, Duration)], states: &RadioStates, tx_power: Dbm) -> f64 {
    let power_w = |power| states.power_w(RadioState::Transmit, power);
    other_powers.iter().map(|&(power, span)| (power_w(power) - power_w(tx_power)) * span.as_secs_f64()).sum()
}

impl RadioUse {
    fn spent(&self, states: &RadioStates) -> EnergySpent {
        let mut spent = self.meter.spent(states, self.tx_power);
        spent.tx_j += more_j(&self.other_powers, states, self.tx_power);
        spent
    }

    /// What it would have used without sending or answering.
    fn at_rest(&self, states: &RadioStates) -> EnergySpent {
        self.meter.at_rest(self.rests_in, states, self.tx_power)
    }
}

impl Books {
    /// The same, with how each station used its slots.
    pub(super) fn with_slots(self, slots: Vec<SlotUse>) -> Self {
        Self { slots, ..self }
    }

    /// Energy that the radio of a station used (J).
    pub(crate) fn metered_j(&self, station: StationId) -> f64 {
        let is_member = self.members.as_ref().is_none_or(|members| members[station.index()]);
        if is_member { self.radios[station.index()].spent(&self.radio_states).total_j() } else { 0.0 }
    }

    /// The same, with how each station slept.
    pub(super) fn with_sleep(self, sleep: Vec<SleepUse>) -> Self {
        Self { sleep, ..self }
    }

    /// The same, with when the radio of each station was on by plan.
    pub(super) fn with_rhythms(self, rhythms: Vec<Option<Rhythm>>) -> Self {
        Self { rhythms, ..self }
    }

    /// Adds those of another part of the same simulation, with the same end. No station did anything in both at once.
    pub(crate) fn add(&mut self, other: Self) {
        self.packets.iter_mut().zip(other.packets).for_each(|(sum, packets)| *sum += packets);
        self.octets.iter_mut().zip(other.octets).for_each(|(sum, octets)| *sum += octets);
        self.deliveries.iter_mut().zip(other.deliveries).for_each(|(sum, count)| *sum += count);
        debug_assert_eq!(self.due, other.due, "the same schedules until the same end");
        self.left.extend(other.left);
        debug_assert!(other.delays.is_empty(), "parts have no sinks");
        debug_assert!(other.slots.is_empty() && other.sleep.is_empty(), "parts have no sinks");
        for (sum, radio) in self.radios.iter_mut().zip(other.radios) {
            sum.meter.add_activity(&radio.meter, radio.rests_in);
        }
    }

    /// The record of the network. Packets that were due and not offered are those that were not simulated: they count as
    /// offered, and for their energy there is an estimate.
    pub(crate) fn close(mut self) -> NetworkRecord {
        let states = &self.radio_states;
        let mut energy: Vec<EnergySpent> = self.radios.iter().map(|radio| radio.spent(states)).collect();
        let missing: Vec<DueFrames> = (self.packets.iter().zip(&self.octets).zip(&self.due))
            .map(|((packets, &octets), due)| due.without(DueFrames { frames: packets.offered, octets }))
            .collect();
        if let Some(estimate) = self.estimate() {
            for ((energy, radio), &missing) in energy.iter_mut().zip(&self.radios).zip(&missing) {
                *energy += self.missing_energy(&estimate, radio, missing);
            }
        }
        for (packets, missing) in self.packets.iter_mut().zip(missing) {
            packets.not_simulated = missing.frames;
            packets.offered += missing.frames;
        }
        if let Some(members) = &self.members {
            let others = energy.iter_mut().zip(members).filter(|(_, is_member)| !**is_member);
            others.for_each(|(energy, _)| *energy = EnergySpent::default());
        }
        let Self { packets, deliveries, delays, slots, sleep, rhythms, left, .. } = self;
        NetworkRecord { packets, energy, deliveries, delays, slots, sleep, rhythms, left }
    }

    /// What the packets that were simulated took on average; if there were none, what they take on a channel that is not
    /// busy. `None` if all were simulated.
    fn estimate(&self) -> Option<Estimate> {
        let mut stations = self.packets.iter().zip(&self.due).zip(&self.radios);
        let (_, radio) = stations.find(|((packets, due), _)| due.frames > packets.offered)?;
        let (mut offered, mut sent) = (0, 0);
        let mut access = EnergySpent::default();
        for (packets, radio) in self.packets.iter().zip(&self.radios).filter(|(packets, _)| packets.offered > 0) {
            offered += packets.offered;
            sent += packets.sent;
            access += radio.spent(&self.radio_states) - radio.at_rest(&self.radio_states);
            access += self.above_rest(radio, RadioState::Transmit, radio.meter.span(RadioState::Transmit)) * -1.0;
        }
        if offered == 0 {
            return Some(Estimate {
                access: self.above_rest(radio, RadioState::Receive, self.spans.access),
                sent: 1.0,
            });
        }
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53 packets")]
        let [each, sent] = [1.0 / offered as f64, sent as f64];
        Some(Estimate { access: access * each, sent: sent * each })
    }

    /// Energy of packets of a station that were not simulated, above that of its radio at rest: that of channel access as
    /// estimated, and that of the time that these very frames are on air.
    fn missing_energy(&self, estimate: &Estimate, radio: &RadioUse, missing: DueFrames) -> EnergySpent {
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53 packets")]
        let mut energy = estimate.access * missing.frames as f64;
        energy += self.above_rest(radio, RadioState::Transmit, self.spans.airtime(missing)) * estimate.sent;
        energy
    }

    /// Energy of a time in `state`, above that of the radio at rest.
    fn above_rest(&self, radio: &RadioUse, state: RadioState, span: Duration) -> EnergySpent {
        let mut meter = EnergyMeter::new(state, SimTime::ZERO);
        let &RadioUse { tx_power, rests_in, .. } = radio;
        meter.enter(rests_in, SimTime::ZERO + span);
        let radio = RadioUse { meter, tx_power, other_powers: Vec::new(), rests_in };
        radio.spent(&self.radio_states) - radio.at_rest(&self.radio_states)
    }
}

/// What a packet took on average.
struct Estimate {
    /// Energy besides that of the time on air, above that of a radio at rest.
    access: EnergySpent,
    /// Share of the packets that were on air.
    sent: f64,
}
