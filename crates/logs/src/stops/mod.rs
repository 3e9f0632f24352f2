//! Logs that have their stops: the tables of stops, receptions and sectors, and wide tables.

pub(crate) mod antenna_file;
mod heading;
mod no_nodes;
pub(crate) mod pair_notes;
pub(crate) mod pairs;
pub(crate) mod receptions;
pub(crate) mod sector_snrs;
pub(crate) mod sectors;
mod stated;
pub(crate) mod stop_table;
pub(crate) mod wide;
