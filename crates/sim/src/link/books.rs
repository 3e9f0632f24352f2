//! The books of a network at the end: what its record is worked out from.

use sextant_channel::Dbm;
use sextant_mac::{EnergyMeter, EnergySpent, RadioState, RadioStates};

use crate::service::delays::Delays;
use crate::service::packets::{NetworkRecord, Packets};

/// The books of a network at the end: whole numbers, so that those of parts of a simulation can be added.
#[derive(Debug)]
pub(crate) struct Books {
    /// What became of the packets of each station.
    pub(super) packets: Vec<Packets>,
    /// Number of packets of each station that were due, where nodes may rest; otherwise zero.
    pub(super) due: Vec<u64>,
    /// Number of frames that were delivered to each station.
    pub(super) deliveries: Vec<u64>,
    /// Time from offer to first reception of the packets of each station that were received; empty without sinks.
    pub(super) delays: Vec<Delays>,
    /// Whether each station is in the network; `None` if all are.
    pub(super) members: Option<Vec<bool>>,
    /// Energy model of the radios.
    pub(super) radio_states: RadioStates,
    /// How the radio of each station was used.
    pub(super) radios: Vec<RadioUse>,
}

/// How a radio was used.
#[derive(Clone, Copy, Debug)]
pub(super) struct RadioUse {
    /// How long it was in each state.
    pub(super) meter: EnergyMeter,
    pub(super) tx_power: Dbm,
    /// The state in which it is as long as its station neither sends nor answers.
    pub(super) rests_in: RadioState,
}

impl RadioUse {
    fn spent(&self, states: &RadioStates) -> EnergySpent {
        self.meter.spent(states, self.tx_power)
    }

    /// What it would have used without sending or answering.
    fn at_rest(&self, states: &RadioStates) -> EnergySpent {
        self.meter.at_rest(self.rests_in, states, self.tx_power)
    }
}

impl Books {
    /// Adds those of another part of the same simulation, with the same end. No station did anything in both at once.
    pub(crate) fn add(&mut self, other: Self) {
        self.packets.iter_mut().zip(other.packets).for_each(|(sum, packets)| *sum += packets);
        self.deliveries.iter_mut().zip(other.deliveries).for_each(|(sum, count)| *sum += count);
        debug_assert_eq!(self.due, other.due, "the same schedules until the same end");
        debug_assert!(other.delays.is_empty(), "parts have no sinks");
        for (sum, radio) in self.radios.iter_mut().zip(other.radios) {
            sum.meter.add_activity(&radio.meter, radio.rests_in);
        }
    }

    /// The record of the network. Packets that were due and not offered are those that were not simulated. For each, the
    /// energy has what a packet of the network took on average, above that of a radio at rest.
    pub(crate) fn close(mut self) -> NetworkRecord {
        for (packets, due) in self.packets.iter_mut().zip(&self.due) {
            packets.not_simulated = due.saturating_sub(packets.offered);
        }
        let states = &self.radio_states;
        let mut energy: Vec<EnergySpent> = self.radios.iter().map(|radio| radio.spent(states)).collect();
        if let Some(each) = self.energy_of_a_packet(&energy) {
            #[expect(clippy::cast_precision_loss, reason = "far below 2^53 packets")]
            let missing = self.packets.iter().map(|packets| packets.not_simulated as f64);
            energy.iter_mut().zip(missing).for_each(|(energy, missing)| *energy += each * missing);
        }
        if let Some(members) = &self.members {
            let others = energy.iter_mut().zip(members).filter(|(_, is_member)| !**is_member);
            others.for_each(|(energy, _)| *energy = EnergySpent::default());
        }
        NetworkRecord { packets: self.packets, energy, deliveries: self.deliveries, delays: self.delays }
    }

    /// Mean energy of a packet that was offered, above that of a radio at rest; `None` if all were simulated, or none.
    fn energy_of_a_packet(&self, spent: &[EnergySpent]) -> Option<EnergySpent> {
        self.packets.iter().find(|packets| packets.not_simulated > 0)?;
        let (mut offered, mut above) = (0, EnergySpent::default());
        for ((packets, radio), &spent) in self.packets.iter().zip(&self.radios).zip(spent) {
            if packets.offered > 0 {
                offered += packets.offered;
                above += spent - radio.at_rest(&self.radio_states);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53 packets")]
        let each = 1.0 / offered as f64;
        (offered > 0).then(|| above * each)
    }
}
