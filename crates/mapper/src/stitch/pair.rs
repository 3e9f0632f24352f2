//! How the frames of two robots differ.

use std::fmt;

use sextant_channel::Position;
use sextant_kernel::Seed;
use sextant_kernel::text::counted;

use super::consensus::{Consensus, consensus, level_m, residual};
use super::frame_change::{FrameChange, Handedness};
use super::settings::StitchRules;
use super::shared::{OwnMap, SharedNode};
use super::tukey;

/// Two maps with fewer nodes in common are not compared.
const LEAST_SHARED: usize = 4;
/// A handedness is taken if the other one is less likely by this much, in twice the logarithm of the likelihood: odds of 400
/// to 1.
const DECISIVE: f64 = 12.0;
/// Maps agree if the residual is at most this share of the spread of their common nodes, however few these are.
const PLAIN_RESIDUAL: f64 = 0.3;
/// Inexact maps agree up to this share if so many nodes agree that chance is out of the question.
const MOST_RESIDUAL: f64 = 0.6;
/// A probability that is out of the question, also for the best of thousands of tries.
const NO_CHANCE: f64 = 1e-9;

/// How the frames of two robots differ.
#[derive(Clone, Debug, PartialEq)]
pub struct PairFit {
    /// The robots, by number among those of the team.
    pub robots: [usize; 2],
    /// Nodes with reliable places on both maps.
    pub shared: usize,
    /// What they tell.
    pub state: PairState,
}

/// What the common nodes of two maps tell.
#[derive(Clone, Debug, PartialEq)]
pub enum PairState {
    /// How the frame of the second robot becomes that of the first.
    Fitted {
        /// The change of frame.
        change: FrameChange,
        /// Nodes that agree with it.
        agreeing: usize,
        /// Root of the mean square distance of these between both maps (m).
        residual_m: f64,
    },
    /// Nothing reliable.
    Undecided(PairFault),
}

/// Why the common nodes of two maps do not tell how their frames differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairFault {
    /// There are too few.
    TooFew {
        /// So many there are.
        found: usize,
    },
    /// They are near a line or a point, so that the mirror image fits as well.
    Handedness,
    /// Fewer than half of them fit any change of frame.
    Disagree {
        /// Standard deviation of the best change of frame (m).
        residual_m: f64,
    },
}

impl fmt::Display for PairFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { found: 0 } => write!(f, "no node has a reliable place on both maps"),
            Self::TooFew { found } => {
                let nodes = counted(*found, "node");
                write!(f, "only {nodes} with reliable places on both maps; at least {LEAST_SHARED} are needed")
            }
            Self::Handedness => write!(f, "their common nodes are near a line, so a mirror image fits as well"),
            Self::Disagree { residual_m } => {
                write!(f, "their common nodes do not agree with any change of frame (residual {residual_m:.2} m)")
            }
        }
    }
}

impl PairFit {
    /// Compares the maps of two robots.
    pub(super) fn of(robots: [usize; 2], maps: [&OwnMap; 2], rules: &StitchRules, seed: Seed) -> Self {
        // The second map is brought onto the first.
        let nodes = maps[1].shared_with(maps[0]);
        Self { robots, shared: nodes.len(), state: compare(&nodes, rules, seed) }
    }
}

/// What the `nodes` on two maps tell.
fn compare(nodes: &[SharedNode], rules: &StitchRules, seed: Seed) -> PairState {
    let undecided = PairState::Undecided;
    if nodes.len() < LEAST_SHARED {
        return undecided(PairFault::TooFew { found: nodes.len() });
    }
    let fit = |handedness| consensus(nodes, handedness, rules.lengths, seed);
    let Some(straight) = fit(Handedness::Same) else { return undecided(PairFault::Handedness) };
    let best = if rules.mirrored {
        let Some(mirrored) = fit(Handedness::Mirrored) else { return undecided(PairFault::Handedness) };
        // Both by the deviation of the better one: the worse one would excuse itself.
        let deviation = straight.deviation.min(mirrored.deviation);
        let evidence = |of: &Consensus| -> f64 {
            nodes.iter().map(|node| tukey::evidence(residual(node, &of.change) / deviation)).sum()
        };
        let (of_straight, of_mirrored) = (evidence(&straight), evidence(&mirrored));
        if (of_straight - of_mirrored).abs() < DECISIVE {
            return undecided(PairFault::Handedness);
        }
        if of_straight < of_mirrored { straight } else { mirrored }
    } else {
        straight
    };
    let agrees = |node: &&SharedNode| tukey::weight(residual(node, &best.change) / best.deviation) > 0.0;
    let agreeing: Vec<&SharedNode> = nodes.iter().filter(agrees).collect();
    let squares: f64 = agreeing.iter().map(|node| level_m(best.change.apply(node.from) - node.onto).powi(2)).sum();
    let residual_m = (squares / agreeing.len().max(1) as f64).sqrt();
    if agreeing.len() < LEAST_SHARED || !is_agreement(residual_m / spread_m(&agreeing), agreeing.len()) {
        return undecided(PairFault::Disagree { residual_m });
    }
    PairState::Fitted { change: best.change, agreeing: agreeing.len(), residual_m }
}

/// Whether `nodes` agree whose residual is this share of their spread.
///
/// A residual of the share ρ is a correlation r = 1 − ρ²/2 of the places on both maps as complex numbers. Unrelated places have at
/// least that with the probability (1 − r²)ⁿ⁻². So maps of a few nodes must be exact, but many nodes tell the frame of a map
/// that is not: its error falls with the root of their number.
fn is_agreement(share: f64, nodes: usize) -> bool {
    let correlation = 1.0 - 0.5 * share * share;
    let by_chance = libm::pow(1.0 - correlation * correlation, nodes.saturating_sub(2) as f64);
    share <= PLAIN_RESIDUAL || (share <= MOST_RESIDUAL && by_chance <= NO_CHANCE)
}

/// Root of the mean square distance of nodes from their middle on the first map (m).
fn spread_m(nodes: &[&SharedNode]) -> f64 {
    let share = 1.0 / nodes.len().max(1) as f64;
    let middle = nodes.iter().fold(Position::ORIGIN, |sum, node| sum + node.from * share);
    let squares: f64 = nodes.iter().map(|node| level_m(node.from - middle).powi(2)).sum();
    (squares * share).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inexact_maps_agree_only_if_they_share_many_nodes() {
        for (share, nodes, agrees) in [
            (0.3, 4, true),
            (0.35, 4, false),
            (0.35, 10, false),
            (0.35, 20, true),
            (0.59, 12, false),
            (0.59, 40, true),
            (0.61, 4_000, false),
            (1.4, 4_000, false),
            (f64::NAN, 40, false),
        ] {
            assert_eq!(is_agreement(share, nodes), agrees, "{share} of the spread, {nodes} nodes");
        }
    }
}
