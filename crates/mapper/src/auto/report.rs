//! How a choice among estimators reads.

use std::fmt::Write;

use sextant_kernel::NodeId;

use super::{Choice, EstimatorFit, Opinion, Opinions};
use crate::absorption::AbsorptionMap;
use crate::learned::{CurveFinding, EstimatorFindings, Finding, Line, Section, StaticShadowing};
use crate::survey_frame::SurveyFrame;
use crate::topology_map::TopologyMap;

#[cfg(feature = "config")]
/// The keys of a choice.
#[derive(serde::Serialize)]
struct ChoiceKeys {
    /// The estimator that the log chose.
    chosen: &'static str,
    /// Why it was chosen, in words.
    chosen_because: &'static str,
    /// Factor by which the variances of the chosen map were enlarged, if its maps from parts of the stops differ by more than
    /// its own regions tell, or the log cannot tell it from the link model, whose regions are wider.
    #[serde(skip_serializing_if = "Option::is_none")]
    region_enlargement: Option<f64>,
    /// The other opinions on each place, if they are in the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    opinions: Option<OpinionKeys>,
    /// How well each estimator that could be chosen predicted the stops that were left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scores: Vec<ScoreKeys>,
}

#[cfg(feature = "config")]
/// What counts how much for the places of a map.
#[derive(serde::Serialize)]
struct OpinionKeys {
    /// What the law gains over fields of strengths without distance, for each strength at stops that were left out (nats).
    #[serde(skip_serializing_if = "Option::is_none")]
    gain_of_law: Option<f64>,
    /// How much of the law by which the link model places nodes is that of the log, if not all; the rest is that of usual links.
    #[serde(skip_serializing_if = "Option::is_none")]
    own_share_of_law: Option<f64>,
    /// Power of the posterior of the link model.
    link_model_power: f64,
    /// Scale of the distribution round the places of each other estimator (m).
    scale_m: std::collections::BTreeMap<&'static str, f64>,
}

#[cfg(feature = "config")]
/// The score of an estimator on stops that were left out.
#[derive(serde::Serialize)]
struct ScoreKeys {
    /// Name of the estimator.
    estimator: &'static str,
    /// Mean natural logarithm of the probability that it gave to what was heard of a node at a stop that was left out.
    log_probability: f64,
    /// Standard error of its difference to the highest score; 0 for the highest.
    standard_error: f64,
    /// Number of pairs of node and stop.
    pairs: usize,
}

impl EstimatorFit {
    fn finding(&self) -> &dyn Finding {
        match self {
            Self::Links(fit) => fit,
            Self::Profile(fit) => fit,
            Self::Calibration(calibration) => calibration,
            Self::Pattern(fit) => fit,
        }
    }
}

impl Choice {
    fn finding(&self) -> Option<&dyn Finding> {
        self.fit.as_ref().map(EstimatorFit::finding)
    }

    /// Factor by which variances were enlarged, if they were.
    fn enlargement(&self) -> Option<f64> {
        Some(self.enlargement).filter(|factor| *factor > 1.0)
    }

    fn line(&self, name: &str) -> String {
        let mut text = format!("{name}: the log chose {} ({})", self.chosen, self.reason.because());
        let most = self.scores.iter().map(|score| score.pairs).max();
        for (number, score) in self.scores.iter().enumerate() {
            let lead = if number == 0 { "; log-probability a pair of stops left out: " } else { ", " };
            let _ = write!(text, "{lead}{} {:.3}", score.estimator, score.log_probability);
            if Some(score.pairs) < most {
                text += " (on a part of them, far behind)";
            }
        }
        if let Some(opinions) = &self.opinions {
            text += &told(opinions);
        }
        if let Some(factor) = self.enlargement() {
            let times = factor.sqrt();
            let because = if matches!(self.fit, Some(EstimatorFit::Links(_))) {
                "strengths fall so much more slowly with distance than in real surroundings"
            } else {
                "its maps from parts of the stops differ by so much, or as those of the link model are"
            };
            let _ = write!(text, "; its regions are {times:.1} times as wide as it says, as {because}");
        }
        text
    }
}

impl Finding for Choice {
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let score = |score: &super::Score| ScoreKeys {
            estimator: score.estimator,
            log_probability: score.log_probability,
            standard_error: score.error,
            pairs: score.pairs,
        };
        let own = ChoiceKeys {
            chosen: self.chosen,
            chosen_because: self.reason.because(),
            region_enlargement: self.enlargement(),
            opinions: self.opinions.as_ref().map(|opinions| OpinionKeys {
                gain_of_law: opinions.gain,
                own_share_of_law: Some(opinions.own_share).filter(|share| *share < 1.0),
                link_model_power: opinions.link_model_power,
                scale_m: opinions.others.iter().map(|opinion| (opinion.estimator, opinion.scale_m)).collect(),
            }),
            scores: self.scores.iter().map(score).collect(),
        };
        let mut keys = self.finding().map(|finding| finding.keys(map)).unwrap_or_default();
        if let Ok(serde_json::Value::Object(own)) = serde_json::to_value(own) {
            keys.extend(own);
        }
        keys
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let own = Line { section: Section::Laws, text: self.line(name) };
        let chosen = self.finding().map(|finding| finding.lines(name, map)).unwrap_or_default();
        std::iter::once(own).chain(chosen).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        self.finding().map(Finding::curves).unwrap_or_default()
    }

    fn obstacles(&self) -> Option<&AbsorptionMap> {
        self.finding()?.obstacles()
    }

    fn path_loss_exponent(&self) -> Option<f64> {
        self.finding()?.path_loss_exponent()
    }

    fn shadowing(&self) -> Option<StaticShadowing> {
        self.finding()?.shadowing()
    }

    fn at_bound(&self) -> &[NodeId] {
        self.finding().map(Finding::at_bound).unwrap_or_default()
    }

    fn in_log(&self, frame: &SurveyFrame) -> Option<EstimatorFindings> {
        let fit = self.fit.as_ref().map(|fit| match fit {
            EstimatorFit::Profile(fit) => EstimatorFit::Profile(fit.of_log(frame)),
            EstimatorFit::Calibration(calibration) => EstimatorFit::Calibration(calibration.of_log(frame)),
            EstimatorFit::Links(_) | EstimatorFit::Pattern(_) => fit.clone(),
        });
        Some(EstimatorFindings::new(Self { fit, ..self.clone() }))
    }
}

/// What counts beside the link model, in words.
fn told(opinions: &Opinions) -> String {
    let each =
        opinions.others.iter().map(|Opinion { estimator, scale_m }| format!("{estimator} (scale {scale_m:.1} m)"));
    let mut text = format!(
        "; beside it count {}: the scale says how fast an opinion fades with distance, and is no accuracy",
        each.collect::<Vec<_>>().join(" and ")
    );
    if let Some(gain) = opinions.gain {
        let than = if gain < 0.0 { "worse" } else { "better" };
        let _ = write!(
            text,
            "; its law explains strengths left out {than} than fields without distance, by {:.2} nats each",
            gain.abs()
        );
    }
    if opinions.link_model_power < 1.0 {
        let _ = write!(text, ", so that it counts to the power {:.1}", opinions.link_model_power);
    }
    if opinions.own_share < 1.0 {
        let _ = write!(
            text,
            "; it places nodes by a law that is {:.0} % that of the log, for the rest that of usual links",
            100.0 * opinions.own_share
        );
    }
    text
}
