//! Objective functions: what makes one parent better than another.

use std::time::Duration;

use super::link::ETX_UNIT;
use super::rank::Rank;

/// The greatest step of rank of a link that is used (RFC 6552, 4.1).
const MOST_STEP: u16 = 9;

/// What makes one parent better than another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Objective {
    /// Objective function zero (RFC 6552): the least rank.
    Of0(StepOfRank),
    /// Minimum rank with hysteresis (RFC 6719), by expected transmissions.
    Mrhof(Mrhof),
}

/// By how many least increases of rank a hop counts with objective function zero, with the rank factor 1 and the stretch 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOfRank {
    /// By three, over any link of at most four expected transmissions (RFC 6552, 6.2: DEFAULT_STEP_OF_RANK).
    Constant,
    /// By 3 ETX - 2, rounded, over links with at most nine (RFC 8180, 6.1.1).
    Etx,
}

/// The numbers of the minimum rank with hysteresis; costs are ETX in 128ths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mrhof {
    /// A parent is kept if no other way is better by at least so much (RFC 6719, 5: PARENT_SWITCH_THRESHOLD), ...
    pub hysteresis: u16,
    /// ... unless another one was better for longer than this time.
    pub hysteresis_time: Duration,
    /// Links that cost more are not used (MAX_LINK_METRIC).
    pub max_link_metric: u16,
    /// Ways that cost more are not used (MAX_PATH_COST).
    pub max_path_cost: u16,
}

impl Default for Mrhof {
    fn default() -> Self {
        Self {
            hysteresis: 192,
            hysteresis_time: Duration::from_secs(600),
            max_link_metric: 512,
            max_path_cost: 32_768,
        }
    }
}

impl StepOfRank {
    /// The step over a link of so many expected transmissions [1/128].
    #[must_use]
    pub fn of(self, etx: u16) -> u16 {
        match self {
            Self::Constant => 3,
            Self::Etx => {
                let thrice = (3 * u32::from(etx) + u32::from(ETX_UNIT) / 2) / u32::from(ETX_UNIT);
                u16::try_from(thrice.saturating_sub(2).max(1)).unwrap_or(u16::MAX)
            }
        }
    }
}

impl Objective {
    /// Its number in messages (objective code point).
    #[must_use]
    pub fn code(self) -> u16 {
        match self {
            Self::Of0(_) => 0,
            Self::Mrhof(_) => 1,
        }
    }

    /// The rank of a station below a parent of this rank over a link of so many expected transmissions [1/128].
    #[must_use]
    pub fn rank_via(self, parent: Rank, etx: u16, min_hop_rank_increase: u16) -> Rank {
        match self {
            Self::Of0(step) => parent.plus(u32::from(step.of(etx)) * u32::from(min_hop_rank_increase)),
            // A hop counts at least as the least increase (RFC 6550, 8.2.1).
            Self::Mrhof(_) => parent.plus(etx.max(min_hop_rank_increase).into()),
        }
    }

    /// What a way by such a parent costs: less is better.
    #[must_use]
    pub fn path_cost(self, parent: Rank, etx: u16, min_hop_rank_increase: u16) -> u16 {
        match self {
            Self::Of0(_) => self.rank_via(parent, etx, min_hop_rank_increase).0,
            Self::Mrhof(_) => parent.plus(etx.into()).0,
        }
    }

    /// Whether a link of so many expected transmissions [1/128] can be used.
    #[must_use]
    pub fn has_usable_link(self, etx: u16) -> bool {
        match self {
            Self::Of0(StepOfRank::Constant) => etx <= 4 * ETX_UNIT,
            Self::Of0(step) => step.of(etx) <= MOST_STEP,
            Self::Mrhof(mrhof) => etx <= mrhof.max_link_metric,
        }
    }

    /// Whether such a parent can be used.
    #[must_use]
    pub fn accepts(self, parent: Rank, etx: u16) -> bool {
        let is_short = match self {
            Self::Of0(_) => true,
            Self::Mrhof(mrhof) => parent.plus(etx.into()).0 <= mrhof.max_path_cost,
        };
        parent.is_finite() && is_short && self.has_usable_link(etx)
    }

    /// Whether a way with the cost `other`, which was better for so long, is so much better than that of the parent.
    #[must_use]
    pub fn is_worth_a_change(self, parent: u16, other: u16, better_for: Option<Duration>) -> bool {
        match self {
            Self::Of0(_) => other < parent,
            Self::Mrhof(mrhof) => {
                let is_much = u32::from(other) + u32::from(mrhof.hysteresis) <= parent.into();
                is_much || better_for.is_some_and(|span| span > mrhof.hysteresis_time)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MRHOF: Objective = Objective::Mrhof(Mrhof {
        hysteresis: 192,
        hysteresis_time: Duration::from_secs(600),
        max_link_metric: 512,
        max_path_cost: 32_768,
    });

    /// The ranks of a chain of links that take 4/3 transmissions (the example of RFC 8180).
    #[test]
    fn a_chain_of_links_with_four_thirds_of_a_transmission_has_these_ranks() {
        let four_thirds = 171;
        let ranks: Vec<u16> = std::iter::successors(Some(Rank(256)), |&rank| {
            Some(Objective::Of0(StepOfRank::Etx).rank_via(rank, four_thirds, 256))
        })
        .map(|rank| rank.0)
        .take(6)
        .collect();
        assert_eq!(ranks, [256, 768, 1280, 1792, 2304, 2816]);
    }

    #[test]
    fn objective_function_zero_adds_three_or_as_many_as_transmissions_say() {
        let chain = |step: StepOfRank, etx: u16| {
            let objective = Objective::Of0(step);
            let first = objective.rank_via(Rank(256), etx, 256);
            [first.0, objective.rank_via(first, etx, 256).0]
        };
        assert_eq!(chain(StepOfRank::Constant, 128), [1024, 1792]);
        assert_eq!(chain(StepOfRank::Constant, 400), [1024, 1792]);
        assert_eq!(chain(StepOfRank::Etx, 128), [512, 768]);
        assert_eq!(chain(StepOfRank::Etx, 256), [1280, 2304]);
        let accepts = |etx| Objective::Of0(StepOfRank::Etx).accepts(Rank(256), etx);
        // 3 ETX - 2 is nine at 11/3 of a transmission.
        assert!(accepts(469) && !accepts(512));
    }

    /// Direct with 2.5 transmissions, or two hops of 1.11 each, by the shares 0.4 and 0.9 of frames that arrive.
    #[test]
    fn a_hop_counts_at_least_as_the_least_increase() {
        let direct = MRHOF.path_cost(Rank(256), 320, 256);
        let relay = MRHOF.rank_via(Rank(256), 142, 256);
        let over_relay = MRHOF.path_cost(relay, 142, 256);
        assert_eq!((direct, relay.0, over_relay), (576, 512, 654), "the direct link wins");
        // With a least increase of one transmission, two hops cost 256 + 142 + 142.
        let relay = MRHOF.rank_via(Rank(256), 142, 128);
        assert_eq!(MRHOF.path_cost(relay, 142, 128), 540, "two hops win");
    }

    #[test]
    fn a_parent_is_kept_within_the_hysteresis_but_not_for_ever() {
        let minutes = |count: u64| Some(Duration::from_secs(60 * count));
        assert!(MRHOF.is_worth_a_change(800, 608, None));
        assert!(!MRHOF.is_worth_a_change(800, 609, minutes(10)));
        assert!(MRHOF.is_worth_a_change(800, 609, minutes(11)));
        assert!(MRHOF.accepts(Rank(32_256), 512) && !MRHOF.accepts(Rank(32_257), 512));
        assert!(!MRHOF.accepts(Rank(256), 513) && !MRHOF.accepts(Rank::INFINITE, 128));
    }
}
