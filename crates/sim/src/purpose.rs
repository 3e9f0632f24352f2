//! What a simulation draws random numbers for. Never renumber: each number belongs to one purpose of the whole
//! program.

use sextant_kernel::{Purpose, Seed, StationId};

use crate::service::network_id::NetworkId;

/// Places of nodes.
pub(crate) const LAYOUT: Purpose = Purpose::new(1);
/// Phase and jitter of the nodes' traffic.
pub(crate) const TRAFFIC: Purpose = Purpose::new(2);
/// Backoff of CSMA-CA.
pub(crate) const BACKOFF: Purpose = Purpose::new(3);
/// Loss by bit errors.
pub(crate) const RECEPTION: Purpose = Purpose::new(5);
/// First sequence number of a node.
pub(crate) const SEQUENCE: Purpose = Purpose::new(6);
/// Choice of anchors.
pub(crate) const ANCHORS: Purpose = Purpose::new(9);
/// Phases, backoffs and losses of neighbour discovery.
pub(crate) const DISCOVERY: Purpose = Purpose::new(10);
/// Draws of applications.
pub(crate) const APPLICATION: Purpose = Purpose::new(12);
/// Channels of the bands after the first one.
pub(crate) const BAND: Purpose = Purpose::new(11);
/// Ways of targets.
pub(crate) const TARGETS: Purpose = Purpose::new(13);
/// Offsets, noise and phases of sensors.
pub(crate) const SENSING: Purpose = Purpose::new(14);
/// Traffic in the networks after the first one.
pub(crate) const NETWORK: Purpose = Purpose::new(15);
/// Headings of the antennas of nodes.
pub(crate) const HEADING: Purpose = Purpose::new(17);
/// Answers to a steered antenna that has moved on.
pub(crate) const MISALIGNMENT: Purpose = Purpose::new(18);
/// Losses of frames that were received otherwise.
pub(crate) const MESSAGE_LOSS: Purpose = Purpose::new(19);
/// Tilts of the antennas of nodes.
pub(crate) const TILT: Purpose = Purpose::new(21);
/// Ways of nodes that move.
pub(crate) const NODE_MOTION: Purpose = Purpose::new(53);
/// Frames that arrive over links in bursts of loss, or as they were measured.
pub(crate) const LINK_SUCCESS: Purpose = Purpose::new(52);
/// Nodes that die, and when.
pub(crate) const DEATHS: Purpose = Purpose::new(22);
/// Anchors that lie, and in which direction.
pub(crate) const LYING: Purpose = Purpose::new(24);
/// Rates of the clocks of nodes.
pub(crate) const CLOCK: Purpose = Purpose::new(26);
/// Phases of interferers.
pub(crate) const INTERFERENCE: Purpose = Purpose::new(27);
/// Rounds and bands of a simulation: what tells frames apart that are sent at the same time in different ones.
pub(crate) const ROUND: Purpose = Purpose::new(28);
/// Noise of the odometry of robots.
pub(crate) const ODOMETRY: Purpose = Purpose::new(16);
/// Passages of targets that sensors miss, and their false alarms.
pub(crate) const SENSOR_ERRORS: Purpose = Purpose::new(34);
/// Phases and waits of stations that sleep between checks of the channel.
pub(crate) const SLEEP: Purpose = Purpose::new(64);
/// Instants of the beacons of slotted networks, and the channels of their scans.
pub(crate) const SLOTS: Purpose = Purpose::new(60);
/// Capacities of batteries.
pub(crate) const BATTERIES: Purpose = Purpose::new(70);
/// Generators of programs of the user.
const PROGRAM: Purpose = Purpose::new(33);

/// 128 random bits for the controller or the application of a station: a seed for a generator of its own, such as that of
/// another language. It depends on the seed of the run and on the station alone, and nothing else is drawn from it.
#[must_use]
pub fn program_seed(seed: Seed, station: StationId) -> u128 {
    let half = |number| u128::from(seed.bits(PROGRAM, [station.0.into(), number, 0]));
    half(0) << 64 | half(1)
}

/// The seed of the traffic in a network: that of all in the first network, so that more networks change nothing there.
pub(crate) fn traffic_seed(seed: Seed, network: NetworkId) -> Seed {
    match network.0 {
        0 => seed,
        number => Seed(seed.bits(NETWORK, [number.into(), 0, 0])),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn each_seed_and_station_has_its_own_program_seed() {
        let pairs = || (0..20).flat_map(|seed| (0..50).map(move |station| (Seed(seed), StationId(station))));
        let seeds: BTreeSet<u128> = pairs().map(|(seed, station)| program_seed(seed, station)).collect();
        let halves: BTreeSet<u128> =
            seeds.iter().flat_map(|bits| [bits >> 64, bits & u128::from(u64::MAX)]).collect();
        assert_eq!((seeds.len(), halves.len()), (1000, 2000));
        assert_eq!(program_seed(Seed(3), StationId(4)), program_seed(Seed(3), StationId(4)));
    }

    /// By a program in Python of the same definition. Programs of users rely on it.
    #[test]
    fn a_program_seed_never_changes() {
        assert_eq!(program_seed(Seed(7), StationId(3)), 0xC27D_C514_C12B_7EA0_A2F0_F050_37D8_CFF5);
    }
}
