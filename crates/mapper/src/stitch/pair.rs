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
/// Maps agree if the residual is at most this share of the spread of their common nodes.
const MOST_RESIDUAL: f64 = 0.3;

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
    if agreeing.len() < LEAST_SHARED || residual_m > MOST_RESIDUAL * spread_m(&agreeing) {
        return undecided(PairFault::Disagree { residual_m });
    }
    PairState::Fitted { change: best.change, agreeing: agreeing.len(), residual_m }
}

/// Root of the mean square distance of nodes from their middle on the first map (m).
fn spread_m(nodes: &[&SharedNode]) -> f64 {
    let share = 1.0 / nodes.len().max(1) as f64;
    let middle = nodes.iter().fold(Position::ORIGIN, |sum, node| sum + node.from * share);
    let squares: f64 = nodes.iter().map(|node| level_m(node.from - middle).powi(2)).sum();
    (squares * share).sqrt()
}
