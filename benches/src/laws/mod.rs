//! Logs of robots made by laws of radio that no estimator assumes, one file a law. The same seed gives the same log.
//!
//! Where nothing else is said, a node sends ten packets while the robot listens, power falls with the logarithm of the
//! distance, links are shadowed independently, and packets fade.

mod carried;
mod cut_off;
mod directional;
mod excess_loss;
mod few_nodes;
mod folder;
mod heard_only;
mod independent_shadowing;
mod l_shaped_hall;
mod lapses;
mod line_path;
mod outages;
mod outside;
mod raised_stops;
mod rician_packets;
mod rooms;
mod rounded_strengths;
mod scan_windows;
mod shared_shadowing;
mod site;
mod survey;
mod two_floors;
mod two_ray;
mod two_slope;
mod walled_side;
mod walls;

use std::path::Path;

use sextant_channel::{LogError, Position, ReceptionLog};
use sextant_kernel::Seed;
use sextant_logs::RobotLogError;

use self::site::Site;

/// A log with the true places of its nodes.
#[derive(Clone, Debug)]
pub struct KnownLog {
    /// What kind of log it is: its law.
    pub family: String,
    /// Its name, which no other log has.
    pub name: String,
    /// What the robot recorded.
    pub log: ReceptionLog,
    /// Where the nodes are (m), as far as it is known.
    pub truth: Vec<Option<Position>>,
}

/// Why a log could not be made.
#[derive(Debug, thiserror::Error)]
pub enum LawError {
    /// The receptions contradict each other.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A folder could not be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The folder or file.
        path: std::path::PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A folder that was written could not be read.
    #[error(transparent)]
    Read(#[from] RobotLogError),
}

/// A law: its name, and the log that it makes of a seed.
pub type Law = (&'static str, fn(Seed) -> Result<ReceptionLogAt, LawError>);

/// A log, and where its nodes are (m).
pub type ReceptionLogAt = (ReceptionLog, Vec<Position>);

/// All laws.
pub const LAWS: &[Law] = &[
    (independent_shadowing::NAME, independent_shadowing::log),
    (shared_shadowing::NAME, shared_shadowing::log),
    (two_slope::NAME, two_slope::log),
    (walls::NAME, walls::log),
    (excess_loss::NAME, excess_loss::log),
    (directional::NAME, directional::log),
    (lapses::NAME, lapses::log),
    (scan_windows::NAME, scan_windows::log),
    (outages::PAIRS, outages::of_pairs),
    (outages::STOPS, outages::of_stops),
    (rounded_strengths::NAME, rounded_strengths::log),
    (heard_only::NAME, heard_only::log),
    (few_nodes::SINGLE, few_nodes::single),
    (few_nodes::FEW, few_nodes::few),
    (line_path::NAME, line_path::log),
    (raised_stops::NAME, raised_stops::log),
    (l_shaped_hall::NAME, l_shaped_hall::log),
    (outside::NAME, outside::log),
    (rooms::NAME, rooms::log),
    (walled_side::NAME, walled_side::log),
    (two_floors::NAME, two_floors::log),
    (carried::NAME, carried::log),
    (two_ray::NAME, two_ray::log),
    (rician_packets::NAME, rician_packets::log),
    (cut_off::NAME, cut_off::log),
];

/// The log that `law` makes of `seed`.
///
/// # Errors
/// If a file that it needs cannot be written and read.
pub fn made((family, log): &Law, seed: u64) -> Result<KnownLog, LawError> {
    let (log, nodes) = log(Seed(seed))?;
    let truth = nodes.into_iter().map(Some).collect();
    Ok(KnownLog { family: (*family).to_owned(), name: format!("{family}-{seed}"), log, truth })
}

/// Writes the log as a folder with `stops.csv`, `receptions.csv` and `nodes.csv`, which `sextant map` reads.
///
/// # Errors
/// If a file cannot be written.
pub fn write(known: &KnownLog, folder: &Path) -> Result<(), LawError> {
    let columns = if known.family == heard_only::NAME { folder::Columns::WithoutSent } else { folder::Columns::All };
    folder::write(&known.log, &known.truth, folder, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_law_makes_one_log_of_a_seed_in_which_most_nodes_are_heard() {
        for law in LAWS {
            let [first, again, other] = [1, 1, 2].map(|seed| made(law, seed).unwrap());
            assert!(first.log == again.log && first.truth == again.truth, "{}", law.0);
            assert!(first.log != other.log, "{}", law.0);
            let nodes = first.log.node_count();
            let mut heard: Vec<_> = first.log.receptions().iter().filter(|one| one.received > 0).collect();
            assert!(heard.iter().all(|one| one.rssi_dbm.is_some()), "{}", law.0);
            heard.dedup_by_key(|one| one.node);
            assert!(heard.len() * 10 >= nodes * 8, "{}: {} of {nodes}", law.0, heard.len());
            assert!((25..=90).contains(&first.log.stops().len()), "{}", law.0);
        }
    }

    #[test]
    fn a_log_is_the_same_when_it_was_written_and_read() {
        let folder = std::env::temp_dir().join(format!("laws-{}", std::process::id()));
        let known = made(&LAWS[0], 3).unwrap();
        write(&known, &folder).unwrap();
        let read = sextant_logs::read(&folder, &sextant_logs::ReadOptions::default()).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(read.log.receptions().iter().count(), known.log.receptions().iter().count());
        for (read, made) in read.log.receptions().iter().zip(known.log.receptions().iter()) {
            assert_eq!(
                (read.node, read.stop, read.received, read.sent),
                (made.node, made.stop, made.received, made.sent)
            );
            assert_eq!(read.rssi_dbm.is_some(), made.rssi_dbm.is_some());
        }
    }
}
