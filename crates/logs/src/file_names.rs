//! The names of the files in the folder of a log.

pub(super) const STOPS: &str = "stops.csv";
pub(super) const RECEPTIONS: &str = "receptions.csv";
pub(super) const CONTACTS: &str = "contacts.csv";
pub(super) const SECTORS: &str = "sectors.csv";
pub(super) const ANTENNA: &str = "antenna.toml";
pub(super) const SECTOR_SNRS: &str = "sector_snrs.csv";
pub(super) const PACKETS: &str = "packets.csv";
pub(super) const PATH: &str = "path.csv";

/// The true places of nodes, and other names of them: for scores only.
pub(super) const NODES: &str = "nodes.csv";
pub(super) const NAMES: &str = "names.csv";
