//! What is read from recordings: runs, logs, worlds, courses, packets and traffic.

pub(crate) mod activity;
pub(crate) mod course;
pub(crate) mod known;
pub(crate) mod packets;
pub(crate) mod recorded_summary;
pub(crate) mod recording;
pub(crate) mod robot_names;
pub(crate) mod run;
pub(crate) mod traffic;
pub(crate) mod way;
pub(crate) mod world;
