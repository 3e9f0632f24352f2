//! The names of the files in the folder of a log.

pub(crate) const STOPS: &str = "stops.csv";
pub(crate) const RECEPTIONS: &str = "receptions.csv";
pub(crate) const CONTACTS: &str = "contacts.csv";
pub(crate) const SECTORS: &str = "sectors.csv";
pub(crate) const ANTENNA: &str = "antenna.toml";
pub(crate) const SECTOR_SNRS: &str = "sector_snrs.csv";
pub(crate) const RANGES: &str = "ranges.csv";
pub(crate) const PACKETS: &str = "packets.csv";
pub(crate) const PATH: &str = "path.csv";
/// A path that drifts.
pub(crate) const ODOMETRY: &str = "odometry.csv";
/// Where tags are on a robot.
pub(crate) const TAGS: &str = "tags.csv";

/// What is missing in an exported recording that is incomplete, in a sentence.
pub const INCOMPLETE: &str = "incomplete.txt";

/// The true places of nodes, and other names of them: for scores only.
pub(crate) const NODES: &str = "nodes.csv";
pub(crate) const NAMES: &str = "names.csv";
