//! The ledger of a network: what became of the packets of its stations, and who its stations are.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::{EnergySpent, RadioStates};

use super::settings::Placement;
use crate::service::delays::Delays;
use crate::service::packets::{NetworkRecord, Packets};
use crate::station::Roll;

/// The ledger of a network, whatever its technology.
pub(super) struct Ledger {
    /// What became of the packets of each station.
    pub(super) packets: Vec<Packets>,
    /// Number of frames that were delivered to each station.
    pub(super) deliveries: Vec<u64>,
    /// Time from offer to first reception of the packets of each station that were received; empty without sinks.
    pub(super) delays: Vec<Delays>,
    /// Packets that were offered before are not counted.
    pub(super) counted_from: SimTime,
    /// Whether each station is in the network; `None` if all are.
    members: Option<Vec<bool>>,
    /// Energy model of the radios.
    pub(super) radio_states: RadioStates,
}

impl Ledger {
    /// An empty ledger of all stations.
    pub(super) fn new(placement: &Placement, roll: Roll) -> Self {
        Self {
            packets: vec![Packets::default(); roll.len()],
            deliveries: vec![0; roll.len()],
            delays: vec![Delays::default(); if roll.sinks > 0 { roll.len() } else { 0 }],
            counted_from: SimTime::ZERO,
            members: placement.members.clone(),
            radio_states: placement.radio_states.clone(),
        }
    }

    /// Whether a station is in the network.
    #[inline]
    pub(super) fn has(&self, station: StationId) -> bool {
        self.members.as_ref().is_none_or(|members| members[station.index()])
    }

    /// What the network leaves behind; `spent` is the energy of each station, that of others than members included.
    pub(super) fn close(self, spent: impl IntoIterator<Item = EnergySpent>) -> NetworkRecord {
        let energy = spent.into_iter().enumerate();
        let energy =
            energy.map(|(i, spent)| if self.has(StationId::from_index(i)) { spent } else { EnergySpent::default() });
        let energy = energy.collect();
        NetworkRecord { packets: self.packets, energy, deliveries: self.deliveries, delays: self.delays }
    }
}
