//! The program from outside: its words, what it writes, what it refuses; and the crates' edges.

mod architecture;
mod command_line;
mod comparators;
mod failing_disk;
mod figure;
#[cfg(unix)]
mod interrupt;
mod map;
mod pcap;
mod program;
mod purposes;
mod recording;
mod reproduce;
mod run;
mod scenario_errors;
mod sweep;
