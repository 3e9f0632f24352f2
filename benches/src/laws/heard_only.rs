//! A log that has only what was heard, without the packets sent.

use sextant_kernel::{NodeId, Seed};
use sextant_logs::{self as robot_log, ReadOptions};

use super::folder::{self, Columns};
use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "heard-only";

/// A log without the column `sent`, as it is read from its files: what it says of silence is up to the reader.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let made = survey(&site, Listening::default(), &strength, &none_lost)?;
    let folder = std::env::temp_dir().join(format!("heard-only-{}-{}", seed.0, std::process::id()));
    folder::write(&made, &[], &folder, Columns::WithoutSent)?;
    let read = robot_log::read(&folder, &ReadOptions::default());
    std::fs::remove_dir_all(&folder).map_err(|source| LawError::Write { path: folder, source })?;
    let log = read?.log;
    // Nodes that were never heard are not in the files.
    let nodes = log.names().iter().map(|name| {
        let number = made.names().iter().position(|other| other == name);
        site.nodes[number.map_or(0, |number| NodeId::from_index(number).index())]
    });
    let nodes = nodes.collect();
    Ok((log, nodes))
}
