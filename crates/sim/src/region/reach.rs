//! How far signals reach.

use sextant_channel::Dbm;
use sextant_kernel::NodeId;

use crate::applications::traffic::Traffic;
use crate::engine::bands::NEGLECTED_BELOW_NOISE;
use crate::network::Network;
use crate::setup::Setup;

/// How far the signals of nodes reach that send by themselves: the largest reach over all networks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// Beyond it no frame can be received (m): the least halo.
    pub reception_m: f64,
    /// Beyond it a signal is not even interference (m).
    pub interference_m: f64,
    /// Beyond it a signal does not make the channel busy (m).
    pub carrier_sense_m: f64,
}

impl Reach {
    /// Radius of a halo in which all that a listener hears is as if all nodes were simulated, but for chains of nodes that
    /// hold each other back (m).
    #[must_use]
    pub fn halo_m(&self) -> f64 {
        self.interference_m + self.carrier_sense_m
    }

    /// The larger reach of two networks.
    fn max(self, other: Self) -> Self {
        Self {
            reception_m: self.reception_m.max(other.reception_m),
            interference_m: self.interference_m.max(other.interference_m),
            carrier_sense_m: self.carrier_sense_m.max(other.carrier_sense_m),
        }
    }

    /// The reach in a network of so many nodes.
    fn of(network: &Network, nodes: usize) -> Self {
        let settings = network.technology.settings();
        let power = settings.radio().greatest_tx_power() + settings.greatest_gain();
        let busy_from = (0..nodes).map(|node| settings.radio().busy_from(Some(NodeId::from_index(node))).0);
        let busy_from = Dbm(busy_from.fold(settings.radio().busy_from(None).0, f64::min));
        // Measured links follow no law of distance.
        let reach_m = |floor| match network.link_trace {
            Some(_) => f64::INFINITY,
            None => network.channel.reach_m(power, floor),
        };
        Self {
            reception_m: reach_m(settings.radio().sensitivity()),
            interference_m: reach_m(settings.radio().noise_floor() - NEGLECTED_BELOW_NOISE),
            carrier_sense_m: reach_m(busy_from),
        }
    }
}

impl Setup {
    /// How far the signals of nodes reach that send by themselves.
    #[must_use]
    pub fn reach(&self) -> Reach {
        if !self.world.motions.is_empty() {
            // Nobody knows where nodes that move will be.
            return Reach {
                reception_m: f64::INFINITY,
                interference_m: f64::INFINITY,
                carrier_sense_m: f64::INFINITY,
            };
        }
        let sends = |network: &&Network| !network.traffic.kinds().all(Traffic::is_silent);
        let reaches = self.networks.iter().filter(sends).map(|network| Reach::of(network, self.world.nodes.len()));
        reaches.fold(Reach::default(), Reach::max)
    }
}
