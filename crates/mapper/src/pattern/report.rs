//! How the law of an antenna reads.

use sextant_kernel::text::counted;

use super::PatternFit;
use crate::learned::{CurveFinding, Finding, Line, Section, Unconverged};
use crate::topology_map::TopologyMap;

/// Sectors whose strengths have such errors contradict the pattern (dB).
const CONTRADICTED_DB: f64 = 5.0;

/// The law of an antenna that was estimated from a log.
#[cfg(feature = "config")]
#[derive(serde::Serialize)]
struct PatternKeys {
    /// Rounds of the estimation.
    rounds: u32,
    /// Whether it converged, and no node has a concern.
    converged: bool,
    /// Margin of the link budget at 1 m without antenna gain (dB).
    margin_db: f64,
    /// Exponent of the path loss.
    exponent: f64,
    /// Standard deviation of the power of a link (dB).
    sigma_db: f64,
    /// Share of packets that arrive over a good link.
    delivery: f64,
    /// Standard deviation of the error of the strength of a sector (dB).
    noise_db: f64,
    /// Strength of a link at the node over 1 m without antenna gain (dB), of logs with strengths of sectors.
    level_db: f64,
    /// Share of the sectors in reports to which the power of other ways than the straight one is added.
    added_share: f64,
    /// Share of the reports whose straight way is blocked.
    blocked_share: f64,
    /// Standard deviation of what known reflections are stronger or weaker than computed (dB), if obstacles are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    known_sigma_db: Option<f64>,
    /// How far the antenna is turned from what the log says, counterclockwise (degrees).
    yaw_deg: f64,
    /// Standard deviation of the differences of the sectors from the pattern (dB).
    ripple_sigma_db: f64,
    /// The difference of each sector from the pattern (dB), by the order of identities.
    ripple_db: Vec<f64>,
}

impl PatternFit {
    fn converged_in(&self, map: &TopologyMap) -> bool {
        self.converged && map.concerns().next().is_none()
    }
}

impl Finding for PatternFit {
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let law = &self.law;
        let keys = PatternKeys {
            rounds: self.rounds,
            converged: self.converged_in(map),
            margin_db: law.margin_db,
            exponent: law.exponent,
            sigma_db: law.sigma_db,
            delivery: law.delivery,
            noise_db: law.noise_db,
            level_db: law.level_db,
            added_share: law.reports.added_share,
            blocked_share: law.reports.blocked_share,
            known_sigma_db: self.knows_ways.then_some(law.reports.known_sigma_db),
            yaw_deg: law.yaw_rad.to_degrees(),
            ripple_sigma_db: self.ripple_sigma_db,
            ripple_db: law.ripple_db.clone(),
        };
        crate::learned::one_key("antenna_pattern", &keys)
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let law = &self.law;
        let end = if self.converged_in(map) { "converged" } else { "did not converge" };
        let yaw_deg = law.yaw_rad.to_degrees();
        let text = format!(
            "{name}: antenna pattern {end} in {}: margin {:.1} dB at 1 m, exponent {:.2}, sigma {:.1} dB, \
             {:.0} % of packets arrive over good links; sectors: noise {:.1} dB, ripple {:.1} dB, \
             turned by {yaw_deg:.1} degrees",
            counted(self.rounds as usize, "round"),
            law.margin_db,
            law.exponent,
            law.sigma_db,
            100.0 * law.delivery,
            law.noise_db,
            self.ripple_sigma_db,
        );
        let text = if self.knows_ways {
            format!("{text}; reflections of known obstacles differ by {:.1} dB", law.reports.known_sigma_db)
        } else {
            text
        };
        let contradicted = (law.noise_db > CONTRADICTED_DB).then(|| Line {
            section: Section::Warnings,
            text: format!(
                "{name}: warning: what nodes say of sectors contradicts the pattern (noise {:.1} dB), so directions tell \
                 little; check that the gains are those of this antenna, and that sectors have the same identities",
                law.noise_db
            ),
        });
        let why = Unconverged::of(self.converged, map);
        let warning = why.map(|why| why.warning(name, "the law of the antenna", self.rounds, None));
        std::iter::once(Line { section: Section::Laws, text }).chain(contradicted).chain(warning).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        vec![CurveFinding {
            network: None,
            name: "curve in the median direction",
            probability: Box::new(|distance_m| self.usual_probability(distance_m)),
            of_stops: Vec::new(),
            range_m: None,
        }]
    }

    fn path_loss_exponent(&self) -> Option<f64> {
        Some(self.law.exponent)
    }
}
