//! Paths of robots, the stops that they are cut into, and the files that they are read from.

pub(crate) mod estimated;
mod fix;
pub(crate) mod gpx;
pub(crate) mod headings;
pub(crate) mod nmea;
pub(crate) mod path_file;
pub(crate) mod paths;
pub(crate) mod robot_path;
pub(crate) mod slot;
pub(crate) mod tum;
