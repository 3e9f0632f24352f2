//! Where to listen next, as it is told.

use std::fmt;

use serde::Serialize;
use sextant_apps::next_stops::{LEAST_SHARE, PlanEnd, StopPlan};
use sextant_kernel::SimTime;
use sextant_kernel::text::counted;
use sextant_mapper::Outlook;

use super::on_earth;
use super::pace::Pace;
use crate::mapping::{ComputedMap, Input};

/// Of the nodes that gain at a stop, a table names at most so many.
const MOST_NAMES: usize = 4;

/// Where to listen next.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextStops {
    /// The algorithm of the map.
    pub algorithm: &'static str,
    /// The robot that drives.
    pub robot: String,
    /// Nodes whose errors are counted.
    pub nodes: usize,
    /// Those of them that were never heard.
    pub never_heard: usize,
    /// The expected error of a node on the map as it is (m): the root mean square, on average over the nodes.
    pub error_m: f64,
    /// The same after all stops (m).
    pub error_after_m: f64,
    /// Length of the way over all stops (m).
    pub way_m: f64,
    /// Time of driving and listening (s).
    pub time_s: f64,
    /// How fast the robot is.
    pub pace: Pace,
    /// Places that were looked at.
    pub places: usize,
    /// Why there are no more stops: `stops`, `way` or `nothing-more`.
    pub end: &'static str,
    /// The stops in the order of the way.
    pub stops: Vec<NextStop>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// A stop to drive to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextStop {
    /// Its name: `next1`, and so on.
    pub stop: String,
    /// When the robot begins to listen there, by the clock of the log (s).
    pub t_s: f64,
    /// Where it is (m).
    pub x_m: f64,
    /// Where it is (m).
    pub y_m: f64,
    /// Where it is (m).
    pub z_m: f64,
    /// Latitude and longitude (°), if the log has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat_lon: Option<[f64; 2]>,
    /// The corners of the way to it, the last of which is the stop (m).
    pub way: Vec<[f64; 2]>,
    /// Length of this way (m).
    pub way_m: f64,
    /// Time of driving there and listening (s).
    pub time_s: f64,
    /// By how much the expected error of a node falls, on average over the nodes (m).
    pub error_fall_m: f64,
    /// The same for a minute of driving and listening (m).
    pub error_fall_m_per_min: f64,
    /// The expected error of a node after the stop (m).
    pub error_m: f64,
    /// The nodes whose errors fall by 1 % or more.
    pub nodes: Vec<String>,
    /// The number of nodes never heard that are expected to be heard at it. Absent if all were heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found: Option<f64>,
}

/// What a plan is told with.
pub(super) struct Context<'a> {
    pub(super) input: &'a Input,
    pub(super) computed: &'a ComputedMap<'a>,
    pub(super) pace: Pace,
    pub(super) start_time: SimTime,
    pub(super) robot: String,
    pub(super) notes: Vec<String>,
}

impl NextStops {
    pub(super) fn new(plan: &StopPlan, outlook: &Outlook, context: Context<'_>) -> Self {
        let Context { input, computed, pace, start_time, robot, notes } = context;
        let names = input.log().names();
        let nodes = outlook.node_count();
        let mut time_s = start_time.as_secs_f64() + pace.listen_s;
        let mut stops = Vec::with_capacity(plan.stops.len());
        for (number, stop) in plan.stops.iter().enumerate() {
            let error_fall_m = stop.gain.fall_m / nodes as f64;
            stops.push(NextStop {
                stop: format!("next{}", number + 1),
                t_s: to_mm(time_s + stop.time_s - pace.listen_s),
                x_m: to_mm(stop.place.x_m),
                y_m: to_mm(stop.place.y_m),
                z_m: to_mm(stop.place.z_m),
                lat_lon: on_earth(input.plane.as_ref(), stop.place),
                way: stop.way.iter().map(|place| [to_mm(place.x_m), to_mm(place.y_m)]).collect(),
                way_m: stop.way_m,
                time_s: stop.time_s,
                error_fall_m,
                error_fall_m_per_min: 60.0 * error_fall_m / stop.time_s.max(f64::MIN_POSITIVE),
                error_m: stop.error_m,
                nodes: stop.gain.nodes.iter().map(|node| names[node.index()].clone()).collect(),
                found: (outlook.unheard_count() > 0).then_some(stop.gain.found),
            });
            time_s += stop.time_s;
        }
        Self {
            algorithm: computed.map.algorithm,
            robot,
            nodes,
            never_heard: outlook.unheard_count(),
            error_m: plan.error_m,
            error_after_m: stops.last().map_or(plan.error_m, |stop| stop.error_m),
            way_m: stops.iter().map(|stop| stop.way_m).sum(),
            time_s: stops.iter().map(|stop| stop.time_s).sum(),
            pace,
            places: plan.places,
            end: match plan.end {
                PlanEnd::Stops => "stops",
                PlanEnd::Way => "way",
                PlanEnd::NothingMore => "nothing-more",
            },
            stops,
            notes,
        }
    }

    /// What all stops bring, in a line.
    pub(super) fn total(&self) -> String {
        if self.stops.is_empty() {
            return self.nothing_more();
        }
        format!(
            "{} in {:.1} m and {:.1} min: the expected error falls from {:.3} to {:.3} m, by {:.0} %",
            counted(self.stops.len(), "stop"),
            self.way_m,
            self.time_s / 60.0,
            self.error_m,
            self.error_after_m,
            100.0 * (1.0 - self.error_after_m / self.error_m.max(f64::MIN_POSITIVE))
        )
    }

    fn nothing_more(&self) -> String {
        let other = if self.stops.is_empty() { "" } else { "other " };
        let share = 100.0 * LEAST_SHARE;
        format!(
            "nothing more is to be gained: at no {other}place do the errors of the nodes in reach fall by {share:.0} % or more"
        )
    }

    /// The stops as a table with the columns of `stops.csv`: `stop,t_s,x_m,y_m,z_m`, and `lat,lon` if the log has them.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let is_on_earth = self.stops.iter().any(|stop| stop.lat_lon.is_some());
        let mut text =
            String::from(if is_on_earth { "stop,t_s,x_m,y_m,z_m,lat,lon\n" } else { "stop,t_s,x_m,y_m,z_m\n" });
        for NextStop { stop, t_s, x_m, y_m, z_m, lat_lon, .. } in &self.stops {
            text += &format!("{stop},{t_s},{x_m},{y_m},{z_m}");
            if let Some([lat, lon]) = lat_lon {
                text += &format!(",{lat},{lon}");
            }
            text.push('\n');
        }
        text
    }
}

/// Metres to the millimetre, and seconds to the millisecond, without a sign of zero.
fn to_mm(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0 + 0.0
}

impl fmt::Display for NextStops {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let never =
            if self.never_heard > 0 { format!(", {} of them never heard", self.never_heard) } else { String::new() };
        writeln!(
            f,
            "map        {}: {}{never}, expected error {:.3} m",
            self.algorithm,
            counted(self.nodes, "node"),
            self.error_m
        )?;
        writeln!(f, "robot      {}: {}", self.robot, self.pace)?;
        if !self.stops.is_empty() {
            writeln!(
                f,
                "\n{:>7} {:>10} {:>10} {:>8} {:>8} {:>9} {:>9} {:>8}  nodes that gain",
                "stop", "x m", "y m", "way m", "time s", "gain m", "m/min", "error m"
            )?;
        }
        for stop in &self.stops {
            let more = stop.nodes.len().saturating_sub(MOST_NAMES);
            let mut names = stop.nodes[..stop.nodes.len() - more].join(", ");
            if more > 0 {
                names += &format!(" and {more} more");
            }
            if let Some(found) = stop.found.filter(|found| *found >= 0.05) {
                let new = format!("{found:.1} new");
                names = if names.is_empty() { new } else { format!("{names}, {new}") };
            }
            writeln!(
                f,
                "{:>7} {:>10.2} {:>10.2} {:>8.1} {:>8.1} {:>9.4} {:>9.4} {:>8.3}  {names}",
                stop.stop,
                stop.x_m,
                stop.y_m,
                stop.way_m,
                stop.time_s,
                stop.error_fall_m,
                stop.error_fall_m_per_min,
                stop.error_m
            )?;
        }
        if !self.stops.is_empty() {
            writeln!(f, "\n{}", self.total())?;
        }
        match self.end {
            "nothing-more" => writeln!(f, "{}", self.nothing_more()),
            "way" => writeln!(f, "the way is used up; other stops would bring more"),
            _ => Ok(()),
        }
    }
}
