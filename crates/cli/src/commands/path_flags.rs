//! Flags of paths that are estimated with places: of robots with odometry that drifts, and of tags among known receivers.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use sextant_mapper::PathError;

/// What is estimated besides the places of nodes.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Options for paths")]
pub(crate) struct PathFlags {
    /// Estimate the path of the robots together with the places of nodes, from ranges: odometry.csv or path.csv is taken as
    /// odometry that drifts. The map is that of the corrected log
    #[arg(long, group = "path_sought")]
    pub(crate) estimate_path: bool,
    /// How wrong odometry is, as standard deviations: KEY=NUMBER,.. where KEY is scale (1% by default), heading (its drift,
    /// 0.01 rad/m), wander (of the heading, 0.005 rad over a metre) or position (0.02 m over a metre)
    #[arg(long, value_name = "ERRORS", requires = "path_sought")]
    pub(crate) path_error: Option<PathError>,
    /// Write the estimated path to this file: CSV with the covariance of each place, or TUM if the name ends in .tum
    #[arg(long, value_name = "PATH.csv", requires = "estimate_path")]
    pub(crate) path_out: Option<PathBuf>,
    /// Places of nodes that are known: a CSV file with columns node,x_m,y_m[,z_m]. Two of them fix frame and scale of an
    /// estimated path. For --track, the receivers
    #[arg(long, value_name = "nodes.csv", requires = "path_sought")]
    pub(crate) known: Option<PathBuf>,
    /// Estimate the track of each moving tag among receivers at known places, instead of a map: from ranges, from strengths, or from
    /// both. LOG is a folder with ranges.csv (t_s,node,range_m[,tag]) or packets.csv (t_s,node,rssi_dbm[,tag], or
    /// t_s,receiver,node,rssi_dbm), such a file, a recording, or the log of a robot with stops, which is the tag. odometry.csv and
    /// tags.csv (tag,x_m,y_m[,z_m] on the robot) are used. --out gets the track, and --truth compares with a true path (t_s,x_m,y_m)
    #[arg(long, group = "path_sought", requires = "known", conflicts_with_all = ["estimate_path", "algorithm", "profile", "stitch", "tiles", "figure", "names", "area", "near_stops"])]
    pub(crate) track: bool,
    /// With --track: the height of the tags above the zero of the receivers' heights
    #[arg(long, value_name = "METRES", requires = "track", allow_hyphen_values = true)]
    pub(crate) antenna_height: Option<f64>,
    /// With --track, of receivers on a straight line: a place on the side of the tag
    #[arg(long, value_name = "X,Y", requires = "track", allow_hyphen_values = true)]
    pub(crate) side: Option<Side>,
}

/// A place on one side of a line of receivers (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side(pub(crate) [f64; 2]);

impl FromStr for Side {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            text.split(',').map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()));
        match numbers.collect::<Option<Vec<f64>>>().as_deref() {
            Some(&[x, y]) => Ok(Self([x, y])),
            _ => Err(format!("found `{text}`; allowed: two numbers of metres, X,Y")),
        }
    }
}

impl PathFlags {
    /// The files that these flags read.
    pub(super) fn files(&self) -> impl Iterator<Item = Option<&Path>> {
        std::iter::once(self.known.as_deref())
    }
}
