//! Nodes that a scenario chooses for a group.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use super::placed::PlacedNode;

/// The nodes of a group, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum NodesOfGroup {
    /// The nodes of these names.
    Names(Vec<String>),
    /// So many nodes: the first ones that are in no group before.
    Count(usize),
    /// All nodes that are in no group before.
    Others {},
}

impl NodesOfGroup {
    /// The numbers of the chosen ones among `nodes`, of which some are in a group before.
    ///
    /// # Errors
    /// If a name is unknown, given twice or of a node in a group before, there are too few nodes, or none is chosen. Keys
    /// begin with `nodes`.
    pub(crate) fn choose(
        &self,
        nodes: &[PlacedNode],
        is_taken: impl Fn(usize) -> bool,
    ) -> Result<Vec<usize>, SettingError> {
        let free = || (0..nodes.len()).filter(|&node| !is_taken(node));
        let members: Vec<usize> = match self {
            Self::Others {} => free().collect(),
            Self::Count(count) => {
                let members: Vec<_> = free().take(*count).collect();
                if members.len() < *count {
                    let allowed = format!("at most {}, the nodes in no group before", members.len());
                    return Err(SettingError::new("nodes.count", count, allowed));
                }
                members
            }
            Self::Names(names) => (names.iter().enumerate())
                .map(|(i, name)| {
                    let refuse =
                        |allowed| SettingError::new(format!("nodes.names[{i}]"), format!("`{name}`"), allowed);
                    let node = nodes.iter().position(|node| node.name == *name);
                    let node = node.ok_or_else(|| refuse("the name of a node"))?;
                    if is_taken(node) || names[..i].contains(name) {
                        return Err(refuse("a node that is in no group before"));
                    }
                    Ok(node)
                })
                .collect::<Result<_, _>>()?,
        };
        if members.is_empty() {
            return Err(SettingError::new("nodes", "no node", "at least one node"));
        }
        Ok(members)
    }
}
