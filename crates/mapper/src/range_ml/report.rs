//! How the law of ranges reads.

use std::fmt::Write;

use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::text::{counted, listed};

use super::explained::Explained;
use super::places::Place;
use crate::learned::{Finding, Line, Section, Unconverged};
use crate::topology_map::TopologyMap;

/// A unit of ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeUnit {
    /// What it is.
    pub name: &'static str,
    /// How many of it are a metre.
    pub of_metre: f64,
}

/// What was learned of the ranges of a log with the places of its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeFit {
    /// Number of ranges of the nodes that were placed.
    pub ranges: usize,
    /// Number of groups of these: ranges at one place count once.
    pub groups: usize,
    /// Number of nodes that were placed by them.
    pub nodes: usize,
    /// By how much all ranges are too long (m).
    pub bias_m: f64,
    /// Its standard deviation (m).
    pub bias_deviation_m: f64,
    /// Whether the log does not tell this bias: it is what was taken before the log was seen.
    pub bias_is_assumed: bool,
    /// The share by which all ranges are too long.
    pub scale: f64,
    /// Its standard deviation.
    pub scale_deviation: f64,
    /// How late the ranges are by the clock of the path (s).
    pub delay_s: f64,
    /// Its standard deviation (s).
    pub delay_deviation_s: f64,
    /// Standard deviation of what the ranges of a node have in common beyond that (m).
    pub node_bias_m: f64,
    /// The law of the errors that are left.
    pub errors: RangeErrorLaw,
    /// Mean logarithm of the density of the errors of groups (per m).
    pub log_density: f64,
    /// How many independent ranges a group is worth.
    pub worth: f64,
    /// Standard deviation of the mean errors over directions from a node (m).
    pub by_direction_m: f64,
    /// By how much errors by direction usually move a place along an axis beyond that (m): its region holds this.
    pub moved_by_direction_m: f64,
    /// What the places gain over constant ranges.
    pub(super) explained: Explained,
    /// The nodes whose ranges a constant explains clearly better than any place.
    pub unexplained: Vec<String>,
    /// The nodes of which the ranges do not tell how far they are beside their stops.
    pub beside: Vec<String>,
    /// Whether bias or scale is far beyond what was thought possible.
    pub is_beyond_prior: bool,
    /// How far nodes are above or below a level path (m), if that explains the ranges clearly better than bias and scale.
    pub higher_m: Option<f64>,
    /// Whether the search ended by itself.
    pub settled: bool,
    /// The nodes whose ranges leave several places.
    pub ambiguous: Vec<AmbiguousNode>,
    /// The unit in which the ranges fit places clearly better than in metres.
    pub unit: Option<RangeUnit>,
}

/// A node whose ranges leave several places, as the mirror images across a straight way.
#[derive(Clone, Debug, PartialEq)]
pub struct AmbiguousNode {
    /// Its name.
    pub node: String,
    /// These places (m) and their shares of the probability, which sum to 1; the first is the one on the map.
    pub places: Vec<(Position, f64)>,
}

impl AmbiguousNode {
    pub(super) fn of(node: &str, places: &[Place]) -> Self {
        let place = |&Place { place, share, .. }: &Place| (Position::new(place[0], place[1], place[2]), share);
        Self { node: node.to_owned(), places: places.iter().map(place).collect() }
    }
}

/// Clocks that differ by more are warned of (s).
const LATE_S: f64 = 0.5;

impl RangeFit {
    /// Whether most ranges fit no place: then places and law say nothing.
    pub(super) fn is_mostly_wild(&self) -> bool {
        self.errors.shares().wild > 0.5
    }

    /// Whether places explain the ranges no better than a constant.
    #[must_use]
    pub fn is_no_distance(&self) -> bool {
        self.explained.is_nothing()
    }

    /// Whether ranges are too long near nodes, and less so far from them, as ranges to nodes at another height are.
    pub(super) fn seems_higher(&self) -> bool {
        const CLEAR: f64 = 3.0;
        self.bias_m > CLEAR * self.bias_deviation_m && self.scale < -CLEAR * self.scale_deviation
    }

    /// Whether ranges that are usually so long (m) fit their places so badly that they may be in another unit.
    pub(super) fn is_odd(&self, usual_m: f64) -> bool {
        let shares = self.errors.shares();
        let spread_m = self.errors.noise_m() + shares.late * self.errors.excess_m();
        !self.settled || spread_m > 0.05 * usual_m || shares.wild > 0.2 || self.scale.abs() > 0.1
    }
}

#[cfg(feature = "config")]
/// The law of measured ranges.
#[derive(serde::Serialize)]
struct RangeLawKeys {
    /// Ranges of the nodes that were placed by them.
    ranges: usize,
    /// Groups of these: ranges at one place, or over half a metre of path, count once.
    groups: usize,
    /// Nodes that were placed by ranges.
    nodes: usize,
    /// Whether the search ended by itself.
    settled: bool,
    /// By how much all ranges are too long (m), and the standard deviation.
    bias_m: f64,
    bias_sd_m: f64,
    /// Whether the log does not tell this bias, so that it is what was assumed.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    bias_is_assumed: bool,
    /// The share by which all ranges are too long, and the standard deviation.
    scale: f64,
    scale_sd: f64,
    /// How late the ranges are by the clock of the path (s), and the standard deviation.
    delay_s: f64,
    delay_sd_s: f64,
    /// Standard deviation of the biases of nodes (m).
    node_bias_m: f64,
    /// Standard deviation of the noise (m).
    noise_m: f64,
    /// Share of the ranges by a longer way than the straight one, and their mean excess (m).
    late_share: f64,
    late_excess_m: f64,
    /// Share of wild values.
    wild_share: f64,
    /// How many independent ranges a group is worth, at most 1.
    worth: f64,
    /// Standard deviation of the mean errors over directions from a node (m).
    by_direction_m: f64,
    /// By how much errors by direction usually move a place along an axis beyond that (m).
    moved_by_direction_m: f64,
    /// Whether places explain the ranges no better than a constant.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    no_distance: bool,
    /// Nodes whose ranges a constant explains clearly better than any place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unexplained: Vec<String>,
    /// Nodes of which the ranges do not tell how far they are beside their stops.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beside: Vec<String>,
    /// Whether bias or scale is far beyond what was thought possible.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_beyond_prior: bool,
    /// How far nodes are above or below a level path (m), if that explains the ranges clearly better.
    #[serde(skip_serializing_if = "Option::is_none")]
    higher_m: Option<f64>,
    /// Nodes whose ranges leave several places, that on the map first, and the share of the probability of each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ambiguous: Vec<AmbiguousKeys>,
    /// The unit in which the ranges fit places clearly better than in metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
}

#[cfg(feature = "config")]
/// A node whose ranges leave several places.
#[derive(serde::Serialize)]
struct AmbiguousKeys {
    node: String,
    places: Vec<PlaceKeys>,
}

#[cfg(feature = "config")]
/// One of several places (m), and its share of the probability.
#[derive(serde::Serialize)]
struct PlaceKeys {
    x_m: f64,
    y_m: f64,
    z_m: f64,
    share: f64,
}

#[cfg(feature = "config")]
fn keys_of(of: &AmbiguousNode) -> AmbiguousKeys {
    let keys = |&(Position { x_m, y_m, z_m }, share): &(Position, f64)| PlaceKeys { x_m, y_m, z_m, share };
    AmbiguousKeys { node: of.node.clone(), places: of.places.iter().map(keys).collect() }
}

impl Finding for RangeFit {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let shares = self.errors.shares();
        let keys = RangeLawKeys {
            ranges: self.ranges,
            groups: self.groups,
            nodes: self.nodes,
            settled: self.settled,
            bias_m: self.bias_m,
            bias_sd_m: self.bias_deviation_m,
            bias_is_assumed: self.bias_is_assumed,
            scale: self.scale,
            scale_sd: self.scale_deviation,
            delay_s: self.delay_s,
            delay_sd_s: self.delay_deviation_s,
            node_bias_m: self.node_bias_m,
            noise_m: self.errors.noise_m(),
            late_share: shares.late,
            late_excess_m: self.errors.excess_m(),
            wild_share: shares.wild,
            worth: self.worth,
            by_direction_m: self.by_direction_m,
            moved_by_direction_m: self.moved_by_direction_m,
            no_distance: self.is_no_distance(),
            unexplained: self.unexplained.clone(),
            beside: self.beside.clone(),
            is_beyond_prior: self.is_beyond_prior,
            higher_m: self.higher_m,
            ambiguous: self.ambiguous.iter().map(keys_of).collect(),
            unit: self.unit.map(|unit| unit.name),
        };
        crate::learned::one_key("range_law", &keys)
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let shares = self.errors.shares();
        let mut text = format!(
            "{name}: {} to {} in {}: on this path {:.2} ± {:.2} m{} and {:.1} ± {:.1} % too long, noise {:.2} m, nodes differ by {:.2} m",
            counted(self.ranges, "range"),
            counted(self.nodes, "node"),
            counted(self.groups, "group"),
            self.bias_m,
            2.0 * self.bias_deviation_m,
            if self.bias_is_assumed { " (assumed: the log does not tell it)" } else { "" },
            100.0 * self.scale,
            200.0 * self.scale_deviation,
            self.errors.noise_m(),
            self.node_bias_m,
        );
        if shares.late >= 0.01 {
            let _ = write!(text, ", {:.0} % by a way {:.2} m longer", 100.0 * shares.late, self.errors.excess_m());
        }
        if shares.wild >= 0.01 {
            let _ = write!(text, ", {:.0} % wild", 100.0 * shares.wild);
        }
        if self.delay_s.abs() > 3.0 * self.delay_deviation_s {
            let _ = write!(text, ", {:.2} ± {:.2} s late (corrected)", self.delay_s, 2.0 * self.delay_deviation_s);
        }
        if self.moved_by_direction_m > 0.05 {
            let _ = write!(text, ", errors by direction move places by {:.2} m", self.moved_by_direction_m);
        }
        let mut lines = vec![Line { section: Section::Laws, text }];
        let mut warn = |what: String| {
            lines.push(Line { section: Section::Warnings, text: format!("{name}: warning: {what}") });
        };
        if self.is_no_distance() {
            warn("distances explain nothing here: places explain the ranges no better than one constant range a node, so no place is \
                  reliable; check that each range is that of its node at its time or stop".to_owned());
        } else if !self.unexplained.is_empty() {
            let nodes = listed(&self.unexplained);
            warn(format!("a constant explains the ranges of these nodes better than any place: {nodes}"));
        }
        if !self.beside.is_empty() {
            let nodes = listed(&self.beside);
            warn(format!(
                "the ranges do not tell how far these nodes are beside the stops, so their regions are about as wide as their ranges are long: \
                 {nodes}; ranges from stops beside a straight way would tell"
            ));
        }
        if let Some(higher_m) = self.higher_m {
            warn(format!(
                "nodes {higher_m:.1} m above or below the path would explain bias and scale, and the ranges clearly better: give \
                 heights (`z_range_m`), or places in the plane are wrong by what these hide"
            ));
        }
        if self.is_beyond_prior && self.unit.is_none() {
            warn(format!(
                "ranges that are {:.2} m and {:.1} % too long are far beyond what devices have: check that delays of \
                 antennas are taken off, the units of ranges, places and antennas (`tags.csv`), and that nodes are those of the ranges",
                self.bias_m,
                100.0 * self.scale
            ));
        }
        if self.delay_s.abs() > LATE_S {
            warn(format!(
                "the ranges are {:.1} s {} by the clock of the path, much more than clocks of logs usually differ: take it off for all that \
                 reads this log (`--packet-delay {:.2}`)",
                self.delay_s.abs(),
                if self.delay_s > 0.0 { "late" } else { "early" },
                self.delay_s
            ));
        }
        if let Some(RangeUnit { name: unit, .. }) = self.unit {
            let text = format!(
                "{name}: warning: the ranges fit places clearly better as {unit} than as metres: no place is reliable"
            );
            lines.push(Line { section: Section::Warnings, text });
        } else if self.is_mostly_wild() {
            let text = format!(
                "{name}: warning: {:.0} % of the ranges fit no place of their nodes: are they metres? A metre is 3.28 feet or 100 \
                 centimetres, and light takes 3.34 ns for it, 6.67 ns there and back",
                100.0 * shares.wild
            );
            lines.push(Line { section: Section::Warnings, text });
        }
        for AmbiguousNode { node, places } in &self.ambiguous {
            let of = |(place, share): &(Position, f64)| {
                format!("{:.0} % at ({:.2}, {:.2}, {:.2}) m", 100.0 * share, place.x_m, place.y_m, place.z_m)
            };
            let places = places.iter().map(of).collect::<Vec<_>>().join(", ");
            lines.push(Line {
                section: Section::Laws,
                text: format!("{name}: {node} is in one of several places: {places}"),
            });
        }
        if !self.settled
            && let Some(why) = Unconverged::of(self.settled, map)
        {
            lines.push(why.warning(name, "the law of ranges", 1, None));
        }
        lines
    }
}
