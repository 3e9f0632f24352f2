//! Strengths that pile up at one end of all that were measured.

use super::levels::Levels;

/// The strength at an end is a pile if it occurs at least so often, and so many times as often as each of the next ones.
const LEAST: u64 = 10;
const TIMES: u64 = 3;
/// How many of the next strengths are compared.
const NEXT: usize = 4;

/// A strength at an end that occurs far more often than the next ones.
pub(super) struct Pile {
    pub(super) level_dbm: f64,
    /// How often it occurs.
    pub(super) count: u64,
    /// The number of all strengths.
    pub(super) total: u64,
    /// How many times as often as any of the next ones it occurs.
    pub(super) times: u64,
}

impl Pile {
    /// The pile at the highest strength, if it is at least this share of all.
    pub(super) fn at_highest(levels: &Levels, least_share: f64) -> Option<Self> {
        Self::at_first(levels.possible().into_iter().rev(), levels.total(), least_share)
    }

    /// The same at the lowest.
    pub(super) fn at_lowest(levels: &Levels, least_share: f64) -> Option<Self> {
        Self::at_first(levels.possible().into_iter(), levels.total(), least_share)
    }

    /// The lowest strength, if it occurs at least so often and at least once in so many, and is farther below the next ones than
    /// `apart_db` and than these are from each other.
    pub(super) fn apart_at_lowest(levels: &Levels, [least, one_in]: [u64; 2], apart_db: f64) -> Option<Self> {
        let (total, possible) = (levels.total(), levels.possible());
        let (&(level_dbm, count), next) = possible.split_first()?;
        let next = next.get(..NEXT)?;
        let gap_db = next[0].0 - level_dbm;
        let is_apart = gap_db > apart_db.max(next[NEXT - 1].0 - next[0].0);
        let most = next.iter().map(|(_, count)| *count).max()?;
        let is_pile = count >= least && one_in * count >= total;
        (is_pile && is_apart).then(|| Self { level_dbm, count, total, times: count / most.max(1) })
    }

    fn at_first(mut from_end: impl Iterator<Item = (f64, u64)>, total: u64, least_share: f64) -> Option<Self> {
        let (level_dbm, count) = from_end.next()?;
        let next: Vec<u64> = from_end.take(NEXT).map(|(_, count)| count).collect();
        let most = next.iter().copied().max()?;
        let is_pile = count >= LEAST && count as f64 >= least_share * total as f64 && count >= TIMES * most;
        (is_pile && next.len() == NEXT).then(|| Self { level_dbm, count, total, times: count / most.max(1) })
    }
}
