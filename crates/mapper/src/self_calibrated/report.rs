//! How a calibration reads.

use std::fmt::Write;

use sextant_kernel::NodeId;
use sextant_kernel::text::counted;

use super::{CalibratedCurve, Calibration, ObstacleKnowledge};
use crate::absorption::AbsorptionMap;
use crate::learned::{CurveFinding, EstimatorFindings, Finding, Line, Section, Unconverged};
use crate::survey_frame::SurveyFrame;
use crate::topology_map::TopologyMap;

#[cfg(feature = "config")]
/// What was estimated with a self-calibrated map, and from which knowledge.
#[derive(serde::Serialize)]
struct CalibrationKeys {
    /// Rounds of the estimation.
    rounds: u32,
    /// Whether it converged. It did not if a node has a concern, or the curve is at its bound.
    converged: bool,
    /// Distance beyond which less than one packet in a hundred is received (m). Absent if the log has too few receptions
    /// for a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    range_m: Option<f64>,
    /// Whether packets are received even at the longest distance of the curve, so that its range is unreliable. Absent
    /// if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    curve_at_bound: bool,
    /// Probability of a reception at 0, 1/8, 2/8, .. of the range, over a clear link at a stop of average efficiency.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    probability: Vec<f64>,
    /// Minimum, lower quartile, median, upper quartile and maximum of the efficiency of the stops.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    efficiency: Vec<f64>,
    /// Knowledge used to estimate obstacles: `none`, `from_receptions`, or `from_log` (receptions, the paths of the
    /// robots, and their contacts with obstacles).
    obstacle_knowledge: &'static str,
    /// Area of the obstacles that the log is sure of (m²): cells whose absorption is clearly above zero, that are crossed in
    /// several directions, and that explain the receptions of nodes which did not show them. Absent if obstacles were not
    /// estimated, or nothing absorbs.
    #[serde(skip_serializing_if = "Option::is_none")]
    absorbing_m2: Option<f64>,
    /// Area of the obstacles for which the evidence is weak (m²). Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    unsure_m2: Option<f64>,
    /// Correlation of two packets of a link about what curve, stops and obstacles say. Absent if it was not looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    packet_correlation: Option<f64>,
    /// These obstacles, to be drawn. Absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    obstacles: Vec<ObstacleKeys>,
}

#[cfg(feature = "config")]
/// An obstacle that was found.
#[derive(serde::Serialize)]
struct ObstacleKeys {
    /// Whether the log is sure of it.
    sure: bool,
    /// Rectangles that make it up: least x, least y, largest x, largest y (m).
    rectangles_m: Vec<[f64; 4]>,
}

#[cfg(feature = "config")]
impl From<(bool, Vec<[f64; 4]>)> for ObstacleKeys {
    fn from((sure, rectangles_m): (bool, Vec<[f64; 4]>)) -> Self {
        Self { sure, rectangles_m }
    }
}

impl Calibration {
    /// The same with the stops and nodes of the log, if it was estimated in `frame`. A stop that is not in the survey is like the
    /// others.
    pub(crate) fn of_log(&self, frame: &SurveyFrame) -> Self {
        let usual = self.efficiency.iter().sum::<f64>() / self.efficiency.len().max(1) as f64;
        let mut efficiency = vec![usual; frame.stops_in_log()];
        for (stop, &own) in (0..).zip(&self.efficiency) {
            efficiency[frame.stop(stop) as usize] = own;
        }
        let mut at_bound: Vec<NodeId> = self.at_bound.iter().map(|&node| frame.node(node)).collect();
        at_bound.sort_unstable();
        let obstacles = self.obstacles.as_ref().map(|obstacles| obstacles.of_log(frame));
        Self { efficiency, at_bound, obstacles, ..self.clone() }
    }

    /// Area of the obstacles for which the evidence is weak (m²), if there are any.
    fn unsure_m2(&self) -> Option<f64> {
        self.obstacles.as_ref().map(AbsorptionMap::unsure_m2).filter(|&area_m2| area_m2 > 0.0)
    }

    fn line(&self, name: &str) -> String {
        let mut text = match &self.curve {
            Some(curve) => format!("{name}: curve of range {:.2} m", curve.range_m()),
            None => format!("{name}: too few receptions for a curve"),
        };
        let end = if self.converged { "converged" } else { "did not converge" };
        let _ = write!(text, ", {end} in {}", counted(self.rounds as usize, "round"));
        let knowledge = match self.knowledge {
            ObstacleKnowledge::FromLog => "receptions, drives and contacts",
            ObstacleKnowledge::FromReceptions => "receptions",
            ObstacleKnowledge::None => return text + "; obstacles not estimated",
        };
        let _ = match self.obstacles.as_ref().map(AbsorptionMap::sure_m2) {
            Some(area_m2) if area_m2 > 0.0 => write!(text, "; {area_m2:.1} m² of obstacles found from {knowledge}"),
            Some(_) | None => write!(text, "; no obstacles found from {knowledge}"),
        };
        if let Some(area_m2) = self.unsure_m2() {
            let _ = write!(text, ", {area_m2:.1} m² unsure: the evidence is weak");
        }
        text
    }
}

impl Finding for Calibration {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let along = |curve: &CalibratedCurve| {
            (0..8).map(|i| curve.probability(curve.range_m() * f64::from(i) / 8.0)).collect::<Vec<_>>()
        };
        let mut efficiency = self.efficiency.clone();
        efficiency.sort_by(f64::total_cmp);
        let quarter = |i: usize| efficiency[i * (efficiency.len() - 1) / 4];
        let keys = CalibrationKeys {
            rounds: self.rounds,
            converged: self.converged,
            range_m: self.curve.as_ref().map(CalibratedCurve::range_m),
            curve_at_bound: self.curve_at_bound,
            probability: self.curve.as_ref().map(along).unwrap_or_default(),
            efficiency: if efficiency.is_empty() { Vec::new() } else { (0..=4).map(quarter).collect() },
            obstacle_knowledge: match self.knowledge {
                ObstacleKnowledge::None => "none",
                ObstacleKnowledge::FromReceptions => "from_receptions",
                ObstacleKnowledge::FromLog => "from_log",
            },
            absorbing_m2: self.obstacles.as_ref().map(AbsorptionMap::sure_m2),
            unsure_m2: self.unsure_m2(),
            packet_correlation: self.dependence.map(|dependence| dependence.correlation),
            obstacles: self.obstacles.iter().flat_map(AbsorptionMap::claims_m).map(ObstacleKeys::from).collect(),
        };
        crate::learned::one_key("calibration", &keys)
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let mut lines = vec![Line { section: Section::Calibrations, text: self.line(name) }];
        if self.curve_at_bound {
            let range_m = self.curve.as_ref().map_or(0.0, CalibratedCurve::range_m);
            let text = format!(
                "{name}: warning: packets are received at all distances in the log, so the range of the curve \
                 ({range_m:.2} m) is unreliable; try stops that are farther from the nodes"
            );
            lines.push(Line { section: Section::Warnings, text });
        } else if !self.converged {
            // It did not settle if no node has a concern.
            let why = Unconverged::of(map.concerns().next().is_some(), map);
            lines.extend(why.map(|why| why.warning(name, "the calibration", self.rounds, Some("max_rounds"))));
        }
        lines.extend(self.dependence.and_then(|dependence| dependence.warning(name)));
        lines
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        let Some(curve) = &self.curve else { return Vec::new() };
        #[expect(clippy::cast_precision_loss, reason = "a number of stops")]
        let stops = self.efficiency.len().max(1) as f64;
        let mean = self.efficiency.iter().sum::<f64>() / stops;
        vec![CurveFinding {
            network: None,
            name: "calibrated curve over clear links",
            probability: Box::new(|distance_m| curve.probability(distance_m)),
            of_stops: self.efficiency.iter().map(|efficiency| efficiency / mean.max(1e-9)).collect(),
            range_m: Some(curve.range_m()),
        }]
    }

    fn obstacles(&self) -> Option<&AbsorptionMap> {
        self.obstacles.as_ref()
    }

    fn at_bound(&self) -> &[NodeId] {
        &self.at_bound
    }

    fn in_log(&self, frame: &SurveyFrame) -> Option<EstimatorFindings> {
        Some(EstimatorFindings::new(self.of_log(frame)))
    }
}
