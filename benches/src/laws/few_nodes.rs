//! Logs of a single node, and of few.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The names of the laws.
pub(super) const SINGLE: &str = "single-node";
pub(super) const FEW: &str = "few-nodes";

/// One node in the hall: a beacon, an animal.
pub(super) fn single(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    of(seed, 1)
}

/// Four nodes in the hall.
pub(super) fn few(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    of(seed, 4)
}

fn of(seed: Seed, nodes: u32) -> Result<ReceptionLogAt, LawError> {
    let mut site = Site::hall(seed, nodes);
    site.reach_m = site.reach_m.max(10.0);
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log = survey(&site, Listening::default(), &strength, &none_lost)?;
    Ok((log, site.nodes))
}
