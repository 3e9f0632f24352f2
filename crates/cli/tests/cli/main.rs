//! Tests of the program from outside: arguments, outputs and errors; and of the dependencies between crates.

mod applications;
mod architecture;
mod bags;
mod captures;
mod check;
mod command_line;
mod comparators;
mod distributed;
mod doctor;
mod drive;
mod explain;
mod failing_disk;
mod faults;
mod figure;
mod forms;
mod guide;
mod init;
#[cfg(unix)]
mod interrupt;
#[cfg(all(unix, feature = "live"))]
mod live;
mod map;
mod map_figure;
mod named_files;
mod odometry;
mod outcomes;
mod partial_truth;
mod parts;
mod pcap;
mod place_prior;
mod program;
mod purposes;
mod recording;
mod repairs;
mod reproduce;
mod run;
mod scenario_errors;
mod schema;
mod sector_sweeps;
mod sensing;
mod sweep;
mod traffic;
