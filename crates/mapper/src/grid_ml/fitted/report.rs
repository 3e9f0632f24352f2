//! How a fitted profile reads.

use std::fmt::Write;

use sextant_kernel::text::counted;

use super::Fit;
use crate::learned::{CurveFinding, EstimatorFindings, Finding, Line, Section, Unconverged};
use crate::survey_frame::SurveyFrame;
use crate::topology_map::TopologyMap;

#[cfg(feature = "config")]
/// A reception profile that was estimated from the log.
#[derive(serde::Serialize)]
struct FitKeys {
    /// Rounds of the estimation.
    rounds: u32,
    /// Whether it converged, and no node has a concern.
    converged: bool,
    /// How far ten rounds moved the nodes at the end, over how uncertain they are. Absent if it converged.
    #[serde(skip_serializing_if = "Option::is_none")]
    moved: Option<f64>,
    /// Distance beyond which receptions are outliers (m).
    range_m: f64,
    /// Probability of a reception at 0, 1/8, 2/8, .. of the range.
    probability: Vec<f64>,
    /// Stops that were ignored because the receiver did not work.
    dead_stops: Vec<u32>,
    /// Receptions that were ignored because they came from far beyond the range.
    outliers: usize,
}

#[cfg(feature = "config")]
/// The reception profile of one network of a joint map.
#[derive(serde::Serialize)]
struct NetworkKeys {
    /// Name of the network.
    network: String,
    /// The profile.
    #[serde(flatten)]
    profile: FitKeys,
}

/// The profiles of networks that were fitted to their logs, by name.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkFits(pub Vec<(String, Fit)>);

impl Fit {
    #[cfg(feature = "config")]
    fn keys_if(&self, converged: bool) -> FitKeys {
        let range_m = self.curve.range_m();
        FitKeys {
            rounds: self.rounds,
            converged,
            moved: self.moved.filter(|_| !self.converged),
            range_m,
            probability: (0..8).map(|i| self.curve.probability(range_m * f64::from(i) / 8.0)).collect(),
            dead_stops: self.dead_stops.clone(),
            outliers: self.outliers.len(),
        }
    }

    fn line(&self, name: &str, converged: bool) -> Line {
        let rounds = counted(self.rounds as usize, "round");
        let end = match self.moved {
            _ if converged => format!("converged in {rounds}"),
            Some(moved) if self.is_settled() && !self.converged => format!(
                "still fluctuates after {rounds}, but places have settled: ten rounds move them by {moved:.2} of their \
                 uncertainty"
            ),
            _ => format!("did not converge in {rounds}"),
        };
        let range_m = self.curve.range_m();
        let mut text = format!("{name}: fitted profile of range {range_m:.2} m {end}");
        for (count, what, why) in [
            (self.dead_stops.len(), "stop", "receiver did not work"),
            (self.outliers.len(), "reception", "far beyond the range"),
        ] {
            if count > 0 {
                let _ = write!(text, ", {} ignored ({why})", counted(count, what));
            }
        }
        Line { section: Section::Profiles, text }
    }

    fn learned_curve<'a>(&'a self, network: Option<&'a str>) -> CurveFinding<'a> {
        CurveFinding {
            network,
            name: "fitted curve",
            probability: Box::new(|distance_m| self.curve.probability(distance_m)),
            of_stops: Vec::new(),
            range_m: Some(self.curve.range_m()),
        }
    }

    fn warning(&self, name: &str, why: Option<Unconverged>) -> Option<Line> {
        Some(why?.warning(name, "the fitted profile", self.rounds, Some("profile.fitted.max_rounds")))
    }

    /// A node whose place is not reliable has not converged.
    fn converged_in(&self, map: &TopologyMap) -> bool {
        self.converged && map.concerns().next().is_none()
    }
}

impl Finding for Fit {
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        crate::learned::one_key("fitted_profile", &self.keys_if(self.converged_in(map)))
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let why = Unconverged::of(self.is_settled(), map);
        std::iter::once(self.line(name, self.converged_in(map))).chain(self.warning(name, why)).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        vec![self.learned_curve(None)]
    }

    fn in_log(&self, frame: &SurveyFrame) -> Option<EstimatorFindings> {
        Some(EstimatorFindings::new(self.of_log(frame)))
    }
}

impl Finding for NetworkFits {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let keys = |(network, fit): &(String, Fit)| NetworkKeys {
            network: network.clone(),
            profile: fit.keys_if(fit.converged),
        };
        crate::learned::one_key("fitted_profiles", &self.0.iter().map(keys).collect::<Vec<_>>())
    }

    fn lines(&self, name: &str, _: &TopologyMap) -> Vec<Line> {
        let lines = |(network, fit): &(String, Fit)| {
            let name = format!("{name}, {network}");
            let why = (!fit.is_settled()).then_some(Unconverged::Rounds);
            std::iter::once(fit.line(&name, fit.converged)).chain(fit.warning(&name, why)).collect::<Vec<_>>()
        };
        self.0.iter().flat_map(lines).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        self.0.iter().map(|(network, fit)| fit.learned_curve(Some(network))).collect()
    }
}
