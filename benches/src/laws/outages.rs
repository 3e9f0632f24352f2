//! Silence that has nothing to do with power.

use sextant_channel::ReceptionLog;
use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{LOSSES, Listening, POWER, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The names of the laws.
pub(super) const PAIRS: &str = "outages-of-pairs";
pub(super) const STOPS: &str = "outages-of-stops";

/// Of all pairs of node and stop, 5 to 20 % are silent.
pub(super) fn of_pairs(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    log(seed, |node, stop| [node as u64, stop as u64, 0])
}

/// At 5 to 20 % of the stops nothing is heard: the receiver was off.
pub(super) fn of_stops(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    log(seed, |_, stop| [u64::MAX, stop as u64, 0])
}

fn log(seed: Seed, unit: fn(usize, usize) -> [u64; 3]) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let share = 0.05 + 0.15 * seed.uniform(POWER, [3, 0, 0]);
    let is_lost = |node: usize, stop: usize, _: u32| seed.uniform(LOSSES, unit(node, stop)) < share;
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log: ReceptionLog = survey(&site, Listening::default(), &strength, &is_lost)?;
    Ok((log, site.nodes))
}
