//! Receivers miss packets whatever their strength.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{LOSSES, Listening, POWER, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "lapses";

/// A share of the packets, 10 to 40 % from log to log, is lost.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let share = 0.1 + 0.3 * seed.uniform(POWER, [2, 0, 0]);
    let is_lost = |node: usize, stop: usize, packet| {
        seed.uniform(LOSSES, [node as u64, stop as u64, u64::from(packet)]) < share
    };
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log = survey(&site, Listening::default(), &strength, &is_lost)?;
    Ok((log, site.nodes))
}
