//! Energy by counting messages (Gunathillake 2018, eq. 3.17 to 3.19, chapter 4 for sector sweeps, and eq. 5.9 and 5.10 for
//! maps that are computed in the nodes).

use std::time::Duration;

use sextant_channel::Dbm;

use crate::dmg::timing::SSW_AIRTIME;
use crate::{Phy, RadioState, RadioStates};

/// Energy of one packet, if all packets have the same size: the thesis counts only packets, and no idle listening, no
/// carrier sense, no retries. [`EnergyMeter`](crate::EnergyMeter) counts those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MessageEnergy {
    /// Transmitting a packet (J).
    pub tx_j: f64,
    /// Receiving a packet (J).
    pub rx_j: f64,
}

impl MessageEnergy {
    /// Packets of `mpdu_octets` over `phy` with a radio that transmits at `tx_power`.
    #[must_use]
    pub fn of_packet(radio: &RadioStates, tx_power: Dbm, phy: Phy, mpdu_octets: u8) -> Self {
        Self::of_airtime(radio, tx_power, phy.airtime(mpdu_octets))
    }

    /// SSW frames of IEEE 802.11ad with a radio that transmits at `tx_power`.
    #[must_use]
    pub fn of_ssw_frame(radio: &RadioStates, tx_power: Dbm) -> Self {
        Self::of_airtime(radio, tx_power, SSW_AIRTIME)
    }

    /// Frames that take `airtime` with a radio that transmits at `tx_power`.
    #[must_use]
    pub fn of_airtime(radio: &RadioStates, tx_power: Dbm, airtime: Duration) -> Self {
        let joules = |state| radio.power_w(state, tx_power) * airtime.as_secs_f64();
        Self { tx_j: joules(RadioState::Transmit), rx_j: joules(RadioState::Receive) }
    }

    /// Maximum-likelihood maps: each of `nodes` transmits a packet at each of `samples` time samples, and only the
    /// robot receives: `E = N n E_tx` (eq. 3.17) (J).
    #[must_use]
    pub fn ml_tm_j(&self, nodes: f64, samples: f64) -> f64 {
        nodes * samples * self.tx_j
    }

    /// Localisation by signal strengths: each of `anchors` transmits a packet, and each other node receives those of
    /// the `heard` anchors in its neighbourhood: `E = M E_tx + (N − M) m E_rx` (eq. 3.18) (J).
    #[must_use]
    pub fn rssi_j(&self, nodes: f64, anchors: f64, heard: f64) -> f64 {
        anchors * self.tx_j + (nodes - anchors) * heard * self.rx_j
    }

    /// Maps of hop counts: for each of `anchors` each of `nodes` transmits `transmitted` packets and receives
    /// `received`: `E = N M (p E_tx + q E_rx)` (eq. 3.19) (J). A flood in which each node repeats what it hears first
    /// has p = 1 and q the number of neighbours.
    #[must_use]
    pub fn tpm_j(&self, nodes: f64, anchors: f64, transmitted: f64, received: f64) -> f64 {
        nodes * anchors * (transmitted * self.tx_j + received * self.rx_j)
    }

    /// Millimetre wave maps: each of `nodes` receives the sweeps of the robot, `sweeps_heard` on average, and answers
    /// each from all of its `sectors`: `E = N (n E_rx + n s E_tx)` (J). The thesis counts one reception per sweep,
    /// although a node may decode several of its frames.
    #[must_use]
    pub fn mmtm_j(&self, nodes: f64, sweeps_heard: f64, sectors: f64) -> f64 {
        nodes * sweeps_heard * (self.rx_j + sectors * self.tx_j)
    }

    /// Maps computed in the nodes, with static anchors: each of `anchors` sends twice from all of its `sectors`, once for
    /// the directions of the sectors and once as a beacon. Each of `nodes` and each anchor receives from the `heard`
    /// anchors in its neighbourhood: `E = 2 N_A s E_tx + (N + N_A) m E_rx` (eq. 5.9) (J). The thesis calls the number of
    /// anchors M in the text and N_A in the formula.
    #[must_use]
    pub fn dmmtm_ss_j(&self, nodes: f64, anchors: f64, sectors: f64, heard: f64) -> f64 {
        2.0 * anchors * sectors * self.tx_j + (nodes + anchors) * heard * self.rx_j
    }

    /// Maps computed in the nodes, with mobile anchors too: what [`dmmtm_ss_j`](Self::dmmtm_ss_j) counts and, for each of
    /// `nodes`, the reception of a mobile anchor at `stops_heard` stops and an answer from all sectors:
    /// `N (n E_rx + n s E_tx)` (eq. 5.10) (J). In this simulation nodes do not answer mobile anchors.
    #[must_use]
    pub fn dmmtm_hs_j(&self, nodes: f64, anchors: f64, sectors: f64, heard: f64, stops_heard: f64) -> f64 {
        self.dmmtm_ss_j(nodes, anchors, sectors, heard) + self.mmtm_j(nodes, stops_heard, sectors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_are_counted_by_the_formulas() {
        let energy = MessageEnergy { tx_j: 3.0, rx_j: 2.0 };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}, not {expected}");
        near(energy.ml_tm_j(10.0, 4.0), 120.0);
        near(energy.rssi_j(10.0, 2.0, 1.5), 2.0 * 3.0 + 8.0 * 1.5 * 2.0);
        near(energy.tpm_j(10.0, 2.0, 1.0, 6.0), 20.0 * (3.0 + 12.0));
        near(energy.mmtm_j(10.0, 5.0, 8.0), 10.0 * (5.0 * 2.0 + 5.0 * 8.0 * 3.0));
        // Four anchors send twice from eight sectors (192 J); 104 stations receive from 2.5 anchors (520 J).
        near(energy.dmmtm_ss_j(100.0, 4.0, 8.0, 2.5), 192.0 + 520.0);
        // A hundred nodes hear half a stop (100 J) and answer it from eight sectors (1200 J).
        near(energy.dmmtm_hs_j(100.0, 4.0, 8.0, 2.5, 0.5), 712.0 + 100.0 + 1200.0);
        near(energy.dmmtm_hs_j(100.0, 4.0, 8.0, 2.5, 0.0), 712.0);
    }

    #[test]
    fn an_ssw_frame_uses_the_energy_of_its_airtime() {
        // 14.909 us at 0.6 W and 0.4 W.
        let energy = MessageEnergy::of_ssw_frame(&RadioStates::mmwave_60_ghz(), Dbm(20.0));
        assert!((1e6 * energy.tx_j - 8.9454).abs() < 1e-9 && (1e6 * energy.rx_j - 5.9636).abs() < 1e-9);
    }

    #[test]
    fn a_packet_of_twenty_octets_uses_the_energy_of_the_data_sheet() {
        // 832 us at 17.4 mA and 18.8 mA, 3 V: 43.4 and 46.9 uJ.
        let energy = MessageEnergy::of_packet(&RadioStates::cc2420(), Dbm(0.0), Phy::Oqpsk2450, 20);
        assert!((1e6 * energy.tx_j - 43.4).abs() < 0.05 && (1e6 * energy.rx_j - 46.9).abs() < 0.05);
    }
}
