//! The nodes that know their positions.

mod optimised;

use serde::{Deserialize, Serialize};
use sextant_channel::{Anchor, ObstacleField};
use sextant_kernel::{NodeId, Seed, SettingError};

use super::choice::{at_most, drawn, named, number_of};
use super::layout::PlacedNode;
use crate::purpose;
pub use optimised::OptimisedAnchorsConfig;

/// The nodes that know their positions, as written in a scenario. Only maps that need anchors use them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AnchorsConfig {
    /// This share of the nodes, at random, rounded up: 0 to 1.
    Share(f64),
    /// This many nodes, at random.
    Count(usize),
    /// The nodes with these names.
    Names(Vec<String>),
    /// Those that tell most about the places of all nodes.
    Optimised(OptimisedAnchorsConfig),
}

impl Default for AnchorsConfig {
    /// One fifth of the nodes.
    fn default() -> Self {
        Self::Share(0.2)
    }
}

impl AnchorsConfig {
    /// The anchors among `nodes`, by node. Which of two nodes is drawn first does not depend on other nodes. Only the
    /// optimised choice looks at `obstacles`.
    ///
    /// # Errors
    /// If a share is outside 0 to 1, there are fewer nodes than requested anchors, a name is unknown or given
    /// twice, or a setting of the optimised choice is invalid.
    pub fn choose(
        &self,
        nodes: &[PlacedNode],
        obstacles: &ObstacleField,
        seed: Seed,
    ) -> Result<Vec<Anchor>, SettingError> {
        let anchor = |node: NodeId| Anchor { node, position: nodes[node.index()].position };
        let all = (0..nodes.len()).map(NodeId::from_index);
        let mut chosen = match self {
            Self::Share(share) => {
                let count = number_of(*share, nodes.len())?;
                drawn(all, purpose::ANCHORS, seed).take(count).collect::<Vec<_>>()
            }
            Self::Count(count) => drawn(all, purpose::ANCHORS, seed).take(at_most(*count, nodes.len())?).collect(),
            Self::Names(names) => named(names, nodes, "the name of a node", |_| true)?,
            Self::Optimised(optimised) => {
                let chosen = optimised.choose(nodes, obstacles).map_err(|error| error.within("optimised"))?;
                chosen.into_iter().map(NodeId::from_index).collect()
            }
        };
        chosen.sort_unstable();
        Ok(chosen.into_iter().map(anchor).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::Position;

    fn nodes(count: usize) -> Vec<PlacedNode> {
        (0..count)
            .map(|i| PlacedNode { name: format!("n{i}"), position: Position::new(i as f64, 0.0, 0.0) })
            .collect()
    }

    #[test]
    fn a_share_is_rounded_up_and_drawn_by_the_seed() {
        let chosen = |share, seed| {
            AnchorsConfig::Share(share).choose(&nodes(11), &ObstacleField::default(), Seed(seed)).unwrap()
        };
        assert_eq!(chosen(0.2, 1).len(), 3);
        assert_eq!(chosen(1.0, 1).len(), 11);
        assert_eq!(chosen(0.0, 1), []);
        assert_eq!(chosen(0.5, 4), chosen(0.5, 4));
        assert!((0..8).any(|seed| chosen(0.5, seed) != chosen(0.5, 9)));
        for anchor in chosen(0.5, 1) {
            assert!((anchor.position.x_m - f64::from(anchor.node.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn more_anchors_keep_the_first_ones() {
        let few = AnchorsConfig::Count(5).choose(&nodes(40), &ObstacleField::default(), Seed(2)).unwrap();
        let many = AnchorsConfig::Count(9).choose(&nodes(40), &ObstacleField::default(), Seed(2)).unwrap();
        assert!(few.iter().all(|anchor| many.contains(anchor)));
        assert!(many.windows(2).all(|pair| pair[0].node < pair[1].node));
    }

    #[test]
    fn invalid_names_and_numbers_are_rejected() {
        let names = |names: &[&str]| AnchorsConfig::Names(names.iter().map(|&name| name.to_owned()).collect());
        let refused =
            |config: AnchorsConfig| config.choose(&nodes(3), &ObstacleField::default(), Seed(1)).unwrap_err().key;
        assert_eq!(names(&["n2", "n0"]).choose(&nodes(3), &ObstacleField::default(), Seed(1)).unwrap().len(), 2);
        assert_eq!(refused(names(&["n2", "n3"])), "names[1]");
        assert_eq!(refused(names(&["n2", "n2"])), "names[1]");
        assert_eq!(refused(AnchorsConfig::Count(4)), "count");
        assert_eq!(refused(AnchorsConfig::Share(1.5)), "share");
        let optimised = OptimisedAnchorsConfig { share: None, count: Some(4), range_m: 7.0, sectors: 8 };
        assert_eq!(refused(AnchorsConfig::Optimised(optimised)), "optimised.count");
    }
}
