//! The targets, by name.

mod bag;
mod capture;
mod code_book;
mod extends;
mod frames;
mod map_files;
mod mapping;
mod recording;
mod scenario;
mod simulation;
mod tables;
mod traces;

/// A function of octets with properties.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name: that of its folders in `fuzz/corpus` and `fuzz/crashes`.
    pub name: &'static str,
    /// What its octets are.
    pub input: &'static str,
    /// Longest input that is tried (octets).
    pub longest: usize,
    check: fn(&[u8]),
}

impl Target {
    /// Gives it an input. A longer one than it takes is ignored.
    ///
    /// # Panics
    /// If a property does not hold.
    pub fn run(&self, octets: &[u8]) {
        if octets.len() <= self.longest {
            (self.check)(octets);
        }
    }
}

/// A line of the table.
const fn entry(name: &'static str, input: &'static str, longest: usize, check: fn(&[u8])) -> Target {
    Target { name, input, longest, check }
}

/// All targets.
pub const TARGETS: [Target; 12] = [
    entry("bag", "a ROS bag in an MCAP file", 16384, bag::check),
    entry("capture", "a capture of a sniffer: pcap or pcapng", 4096, capture::check),
    entry("code-book", "an antenna: a code book, a MATLAB file, or antenna.toml", 4096, code_book::check),
    entry("extends", "scenario files that extend each other", 4096, extends::check),
    entry("frames", "a frame of IEEE 802.15.4 or 802.11, or a radiotap or TAP header before one", 512, frames::check),
    entry("map-files", "a map, true positions, an area, or the table of a sweep", 2048, map_files::check),
    entry("mapping", "choices that make a reception log", 512, mapping::check),
    entry("recording", "a recording of a run", 16384, recording::check),
    entry("scenario", "a scenario", 4096, scenario::check),
    entry("simulation", "choices that make a scenario", 256, simulation::check),
    entry("tables", "the CSV files of a robot's log, or a path in GPX, NMEA or TUM", 4096, tables::check),
    entry("traces", "a table of traffic or of nodes, or a mesh", 2048, traces::check),
];

/// The target with this name.
#[must_use]
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
