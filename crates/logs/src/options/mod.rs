//! What the user says of a log: its form, its names of columns, what is wrong in it.

pub(crate) mod bag_options;
pub(crate) mod field_names;
pub(crate) mod file_template;
pub(crate) mod form_options;
pub(crate) mod missing;
pub(crate) mod noise_floor;
pub(crate) mod packet_delay;
pub(crate) mod read_options;
pub(crate) mod repair_options;
pub(crate) mod robot_frames;
pub(crate) mod sniffer_options;
