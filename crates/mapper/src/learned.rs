//! What an estimator learned from a log in addition to the map, and how it reads in a summary, a table and a figure.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use sextant_kernel::NodeId;
use sextant_kernel::text::counted;

use crate::absorption::AbsorptionMap;
use crate::comparable::Comparable;
use crate::survey_frame::SurveyFrame;
use crate::topology_map::TopologyMap;

/// Something that an estimator learned from a log in addition to the map.
pub trait Finding: Any + Comparable + fmt::Debug + Send + Sync {
    /// Its keys in the summary of `map`, in their order.
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value>;

    /// Its lines under a table of results that calls `map` by `name`.
    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line>;

    /// The shares of packets that arrive over distances, to be drawn.
    fn curves(&self) -> Vec<CurveFinding<'_>> {
        Vec::new()
    }

    /// What absorbs, to be drawn.
    fn obstacles(&self) -> Option<&AbsorptionMap> {
        None
    }

    /// The path-loss exponent.
    fn path_loss_exponent(&self) -> Option<f64> {
        None
    }

    /// The static shadowing about its law of strengths.
    fn shadowing(&self) -> Option<StaticShadowing> {
        None
    }

    /// Nodes that may be farther away than they were searched for.
    fn at_bound(&self) -> &[NodeId] {
        &[]
    }

    /// The same in the frame of the log, if it was learned in `frame`; `None` if it names no node, stop or place, so that it is
    /// the same.
    fn in_log(&self, frame: &SurveyFrame) -> Option<EstimatorFindings> {
        let _ = frame;
        None
    }
}

/// Shadowing of links that does not change from packet to packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticShadowing {
    /// Standard deviation (dB).
    pub deviation_db: f64,
    /// Share of its variance that neighbouring stops share, 0 to 1.
    pub shared: f64,
    /// Distance over which that is correlated (m).
    pub range_m: f64,
}

/// What an estimator learned from a log in addition to the map.
#[derive(Clone, Debug)]
pub struct EstimatorFindings {
    of: Arc<dyn Finding>,
    /// What was learned besides: of the ranges by which some nodes were placed, of the path.
    others: Vec<Arc<dyn Finding>>,
}

impl EstimatorFindings {
    /// `finding` was learned.
    #[must_use]
    pub fn new(finding: impl Finding) -> Self {
        Self { of: Arc::new(finding), others: Vec::new() }
    }

    /// The same, and what `others` are.
    #[must_use]
    pub(crate) fn and(mut self, others: Self) -> Self {
        self.others.push(others.of);
        self.others.extend(others.others);
        self
    }

    /// The finding, if one of this type was learned: a [`Fit`](crate::Fit), a [`Calibration`](crate::Calibration) or another.
    #[must_use]
    pub fn get<T: Finding>(&self) -> Option<&T> {
        let mut all = std::iter::once(&self.of).chain(&self.others);
        all.find_map(|finding| {
            let finding: &dyn Any = &**finding;
            finding.downcast_ref()
        })
    }

    /// Its keys in the summary of `map`, in their order.
    #[cfg(feature = "config")]
    #[must_use]
    pub fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let mut keys = self.of.keys(map);
        keys.extend(self.others.iter().flat_map(|other| other.keys(map)));
        keys
    }

    /// Its lines under a table of results that calls `map` by `name`.
    #[must_use]
    pub fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let mut lines = self.of.lines(name, map);
        lines.extend(self.others.iter().flat_map(|other| other.lines(name, map)));
        lines
    }
}

impl PartialEq for EstimatorFindings {
    fn eq(&self, other: &Self) -> bool {
        let is_same = |(one, other): (&Arc<dyn Finding>, &Arc<dyn Finding>)| (**one).is_same(&**other);
        is_same((&self.of, &other.of))
            && self.others.len() == other.others.len()
            && self.others.iter().zip(&other.others).all(is_same)
    }
}

impl std::ops::Deref for EstimatorFindings {
    type Target = dyn Finding;

    fn deref(&self) -> &Self::Target {
        &*self.of
    }
}

/// A line under a table of results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The section that it is in: sections of several maps are put together.
    pub section: Section,
    /// The line, without its end.
    pub text: String,
}

/// The sections of lines under a table of results, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// Reception profiles.
    Profiles,
    /// Channels of signal strengths.
    Channels,
    /// Reception curves, stops and obstacles.
    Calibrations,
    /// Laws of links, choices, and what else there is.
    Laws,
    /// Warnings, with those of places that are not reliable.
    Warnings,
}

impl Section {
    /// All of them, in their order.
    pub const ALL: [Self; 5] = [Self::Profiles, Self::Channels, Self::Calibrations, Self::Laws, Self::Warnings];
}

/// The share of packets that arrive over a distance.
pub struct CurveFinding<'a> {
    /// The network that it holds for, of several; `None` for that of the map.
    pub network: Option<&'a str>,
    /// What it is.
    pub name: &'static str,
    /// Probability that a packet arrives over a distance (m).
    pub probability: Box<dyn Fn(f64) -> f64 + 'a>,
    /// Factor for each stop, if stops differ.
    pub of_stops: Vec<f64>,
    /// Distance at which it ends, if it ends (m).
    pub range_m: Option<f64>,
}

/// Why a fit did not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unconverged {
    /// Its rounds were used up.
    Rounds,
    /// A parameter is at the end of the range in which it is sought.
    AtBound,
    /// It converged, but this many nodes have no reliable place.
    Concerns(usize),
}

impl Unconverged {
    /// Why a fit of `map` that `ended` by itself did not converge; `None` if it did.
    pub(crate) fn of(ended: bool, map: &TopologyMap) -> Option<Self> {
        match map.concerns().count() {
            _ if !ended => Some(Self::Rounds),
            0 => None,
            concerns => Some(Self::Concerns(concerns)),
        }
    }

    /// The warning of it: why `what` of the map `name` did not converge after `rounds`, and what to try. `setting` gives more
    /// rounds, if there is one.
    pub(crate) fn warning(self, name: &str, what: &str, rounds: u32, setting: Option<&str>) -> Line {
        let why = match (self, setting) {
            (Self::Rounds, Some(setting)) => {
                format!("its rounds ({rounds}) were used up; try a larger `{setting}`")
            }
            (Self::Rounds, None) => {
                format!(
                    "its rounds ({rounds}) were used up; more stops, at other distances from the nodes, tell it better"
                )
            }
            (Self::AtBound, _) => {
                "a parameter is at the end of its range, so the log hardly tells it; try stops that are \
                                   nearer to some nodes and farther from others"
                    .to_owned()
            }
            (Self::Concerns(nodes), _) => {
                let has = if nodes == 1 { "has" } else { "have" };
                format!("{} {has} no reliable place; try stops around them", counted(nodes, "node"))
            }
        };
        Line { section: Section::Warnings, text: format!("{name}: warning: {what} did not converge: {why}") }
    }
}

/// The keys of one finding that is written as one value.
#[cfg(feature = "config")]
pub(crate) fn one_key(key: &str, value: &impl serde::Serialize) -> serde_json::Map<String, serde_json::Value> {
    let value = serde_json::to_value(value).expect("plain numbers and names");
    std::iter::once((key.to_owned(), value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_that_did_not_converge_says_why_and_what_to_try() {
        let text = |why: Unconverged, setting| why.warning("a", "the fitted profile", 20, setting).text;
        assert_eq!(
            text(Unconverged::Rounds, Some("max_rounds")),
            "a: warning: the fitted profile did not converge: its rounds (20) were used up; try a larger `max_rounds`"
        );
        for (why, part) in [
            (Unconverged::Rounds, "more stops"),
            (Unconverged::AtBound, "at the end of its range"),
            (Unconverged::Concerns(2), "2 nodes have no reliable place; try stops around them"),
        ] {
            assert!(text(why, None).contains(part), "{why:?}: {}", text(why, None));
        }
    }
}
