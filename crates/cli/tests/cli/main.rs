//! Tests of the program from outside: arguments, outputs and errors; and of the dependencies between crates.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]
// The messages that Python must find in a recording are one large `json!`.
#![recursion_limit = "256"]

mod antennas;
mod applications;
mod architecture;
mod bags;
mod batteries;
mod campaigns;
mod captures;
mod check;
mod command_line;
mod comparators;
mod distributed;
mod doctor;
mod drive;
mod explain;
mod export;
mod fading;
mod failing_disk;
mod faults;
mod figure;
#[cfg(unix)]
mod floorplan;
mod foreign_plans;
mod forms;
mod grid_sizes;
mod guide;
mod init;
#[cfg(unix)]
mod interrupt;
#[cfg(all(unix, feature = "foxglove"))]
mod live;
#[cfg(unix)]
mod live_page;
mod log_folders;
mod map;
mod map_figure;
mod metrics_page;
mod moving;
mod named_files;
mod network_pictures;
mod next;
mod odometry;
mod outcomes;
mod outdoor_paths;
mod own_radio;
mod packet_trace;
mod partial_truth;
mod parts;
mod pcap;
mod place_prior;
mod program;
mod purposes;
mod ranges;
mod recording;
mod repairs;
mod report;
mod reproduce;
mod rpl;
mod run;
mod safety;
mod scenario_errors;
mod schema;
mod sector_reports;
mod sector_sweeps;
mod sensing;
mod silent_settings;
mod sleeping;
mod slots;
mod standing_obstacles;
mod sweep;
mod table_forms;
mod teams;
mod tiles;
mod traffic;
mod two_nodes;
mod unheard;
mod unknown_files;
