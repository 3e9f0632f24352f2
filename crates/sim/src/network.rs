//! Networks: what the links of their stations have in common, checked.

use std::sync::Arc;

use sextant_channel::{ChannelLaw, RangingDevice};
use sextant_kernel::NodeId;
use sextant_mac::RadioStates;

use crate::applications::traffic::TrafficPlan;
use crate::link::Technology;
use crate::link_trace::NetworkTrace;

/// A network, checked. It is passed on as it is, from the scenario to the links.
#[derive(Clone, Debug)]
pub struct Network {
    /// Its name, if the scenario has several.
    pub name: Option<String>,
    /// The law of the radio channel.
    pub channel: ChannelLaw,
    /// The technology of its links, with the settings of radios, antennas and channel access.
    pub technology: Technology,
    /// Energy model of the radios.
    pub radio_states: RadioStates,
    /// Its links as they were measured; `None` if they follow the law of the channel.
    pub link_trace: Option<Arc<NetworkTrace>>,
    /// Traffic of the nodes.
    pub traffic: TrafficPlan,
    /// How robots measure the ranges to its nodes; `None` if they do not.
    pub ranging: Option<RangingDevice>,
    /// Whether each node is in the network; `None` if all nodes are. Robots and sinks name the networks that they are in.
    pub members: Option<Vec<bool>>,
}

impl Network {
    /// The only network, of all nodes, whose links follow the law of the channel. Robots measure no ranges.
    #[must_use]
    pub fn of(channel: ChannelLaw, technology: Technology, radio_states: RadioStates, traffic: TrafficPlan) -> Self {
        Self {
            name: None,
            channel,
            technology,
            radio_states,
            link_trace: None,
            traffic,
            ranging: None,
            members: None,
        }
    }

    /// Whether a node is in the network.
    #[must_use]
    pub fn has(&self, node: NodeId) -> bool {
        self.members.as_ref().is_none_or(|nodes| nodes[node.index()])
    }

    /// The key of one of its tables in a scenario.
    pub(crate) fn key(&self, table: &str) -> String {
        self.name.as_ref().map_or_else(|| table.to_owned(), |name| format!("networks.{name}.{table}"))
    }
}
