//! Errors of logs, and where in a log something is.

pub(crate) mod bag_error;
pub(crate) mod log_part;
pub(crate) mod path_error;
pub(crate) mod robot_log_error;
pub(crate) mod sniffer_error;
