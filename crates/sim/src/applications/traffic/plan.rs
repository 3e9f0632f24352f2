//! The traffic of all nodes of a network.

use sextant_kernel::{Files, NodeId, SettingError};

use super::{GroupConfig, Traffic, TrafficConfig};
use crate::world::layout::PlacedNode;

/// The traffic of all nodes of a network: which node sends what.
#[derive(Clone, Debug, PartialEq)]
pub struct TrafficPlan {
    groups: Vec<Group>,
    /// Number of the group of each node.
    group_of: Vec<Option<u16>>,
}

/// Nodes with the same traffic.
#[derive(Clone, Debug, PartialEq)]
struct Group {
    name: Option<String>,
    traffic: Traffic,
}

impl TrafficPlan {
    /// All of `nodes` nodes have the same traffic.
    #[must_use]
    pub fn all(traffic: Traffic, nodes: usize) -> Self {
        Self { groups: vec![Group { name: None, traffic }], group_of: vec![Some(0); nodes] }
    }

    /// None of `nodes` nodes sends anything.
    #[must_use]
    pub fn silent(nodes: usize) -> Self {
        Self::all(Traffic::silent(), nodes)
    }

    /// The plan as `config` says; paths are among `files`. Keys of errors stand in the table of the traffic.
    ///
    /// # Errors
    /// If a number is out of range, a group has no node or a node that is in another group, or a trace cannot be read.
    pub fn new(config: &TrafficConfig, nodes: &[PlacedNode], files: &Files) -> Result<Self, SettingError> {
        let TrafficConfig::Groups(groups) = config else {
            return Ok(Self::all(config.traffic(nodes, files, "traffic")?, nodes.len()));
        };
        if groups.is_empty() {
            return Err(SettingError::new("groups", "empty", "at least one group"));
        }
        let mut plan = Self { groups: Vec::new(), group_of: vec![None; nodes.len()] };
        for (i, group) in groups.iter().enumerate() {
            let table = format!("groups[{i}]");
            plan.add(i, group, nodes).map_err(|error| error.within(&table))?;
            let traffic = group.traffic.traffic(nodes, files, &format!("traffic.{table}.traffic"));
            let traffic = traffic.map_err(|error| error.within("traffic").within(&table))?;
            plan.groups.push(Group { name: Some(group.name.clone()), traffic });
        }
        Ok(plan)
    }

    fn add(&mut self, number: usize, group: &GroupConfig, nodes: &[PlacedNode]) -> Result<(), SettingError> {
        if group.name.trim().is_empty() || self.groups.iter().any(|other| other.name.as_ref() == Some(&group.name)) {
            let allowed = "a name of its own, of at least one letter";
            return Err(SettingError::new("name", format!("`{}`", group.name), allowed));
        }
        let number = u16::try_from(number).map_err(|_| SettingError::new("name", number, "at most 65536 groups"))?;
        let members = group.nodes.choose(nodes, |node| self.group_of[node].is_some())?;
        members.into_iter().for_each(|node| self.group_of[node] = Some(number));
        Ok(())
    }

    /// The traffic of a node; `None` if it sends nothing.
    #[must_use]
    pub fn of(&self, node: NodeId) -> Option<&Traffic> {
        let group = (*self.group_of.get(node.index())?)?;
        Some(&self.groups[usize::from(group)].traffic)
    }

    /// All kinds of traffic.
    pub fn kinds(&self) -> impl Iterator<Item = &Traffic> {
        self.groups.iter().map(|group| &group.traffic)
    }

    /// The named groups: name and nodes of each.
    pub fn named_groups(&self) -> impl Iterator<Item = (&str, Vec<NodeId>)> {
        self.groups.iter().enumerate().filter_map(|(i, group)| {
            let is_member = |&node: &usize| self.group_of[node] == u16::try_from(i).ok();
            let members = (0..self.group_of.len()).filter(is_member).map(NodeId::from_index).collect();
            Some((group.name.as_deref()?, members))
        })
    }

    /// Size of the largest frame (octets).
    #[must_use]
    pub fn mpdu_octets(&self) -> u8 {
        self.kinds().map(Traffic::mpdu_octets).max().unwrap_or(0)
    }

    /// Whether any frame goes to one robot or sink and requests an acknowledgement.
    #[must_use]
    pub fn is_acknowledged(&self) -> bool {
        self.kinds().any(Traffic::is_acknowledged)
    }
}
