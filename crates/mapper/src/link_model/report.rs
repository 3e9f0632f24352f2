//! How a law of links reads.

use std::fmt::Write;

use sextant_kernel::text::counted;

use super::{LinkEvidence, LinkFit};
use crate::learned::{CurveFinding, Finding, Line, Section, StaticShadowing, Unconverged};
use crate::topology_map::TopologyMap;

/// Least share of lapses or outages that is told.
const LEAST_SHARE: f64 = 0.01;

#[cfg(feature = "config")]
/// What the link model estimated from the log. Margins are in standard deviations of the fading over packets.
#[derive(serde::Serialize)]
struct LawKeys {
    /// Which measurements were used: `packets`, `rssi` or `packets-and-rssi`.
    evidence: LinkEvidence,
    /// Rounds of the search for the law.
    rounds: u32,
    /// Whether the search ended by itself, within the bounds of the law.
    settled: bool,
    /// Distance at which the mean margin is given: the usual one of a link (m).
    distance_m: f64,
    /// Mean margin at this distance.
    margin: f64,
    /// How much the margin falls when the distance grows by a factor of e.
    slope: f64,
    /// Standard deviation of the slopes of nodes, as a share of `slope`.
    slope_spread: f64,
    /// Standard deviation of the static shadowing of links.
    shadowing: f64,
    /// Share of its variance that neighbouring stops share, 0 to 1.
    shared: f64,
    /// Distance over which it is correlated (m).
    correlation_m: f64,
    /// Standard deviation of the offsets of nodes.
    offset: f64,
    /// Standard deviation of the amplitudes of the dependence on direction.
    direction: f64,
    /// Share of the packets of a usual link that are lost whatever their strength, 0 to 1.
    lapse: f64,
    /// Standard deviation over the links of the logit of this share.
    lapse_scatter: f64,
    /// Share of the links that are dead whatever their power, 0 to 1: nothing is heard, and that says nothing of the place.
    outage: f64,
    /// Whether nodes were looked for far beyond all stops. Absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    far_nodes: bool,
    /// Strength at which half of the packets are received (dBm). Absent without signal strengths, as the next three.
    #[serde(skip_serializing_if = "Option::is_none")]
    threshold_dbm: Option<f64>,
    /// Standard deviation of the strength over the packets of a link (dB).
    #[serde(skip_serializing_if = "Option::is_none")]
    fading_db: Option<f64>,
    /// Path-loss exponent.
    #[serde(skip_serializing_if = "Option::is_none")]
    path_loss_exponent: Option<f64>,
    /// Standard deviation of the static shadowing (dB).
    #[serde(skip_serializing_if = "Option::is_none")]
    shadowing_db: Option<f64>,
}

impl LinkFit {
    /// Standard deviation of the static shadowing (dB), if the log has strengths.
    fn shadowing_db(&self) -> Option<f64> {
        self.receiver.map(|receiver| receiver.fading_db * self.law.shadowing)
    }
}

impl Finding for LinkFit {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let LinkFit { law, receiver, losses, outage, evidence, has_far_nodes, rounds, settled } = *self;
        let keys = LawKeys {
            evidence,
            rounds,
            settled,
            distance_m: law.distance_m,
            margin: law.margin,
            slope: law.slope,
            slope_spread: law.slope_spread,
            shadowing: law.shadowing,
            shared: law.shared,
            correlation_m: law.correlation_m,
            offset: law.offset,
            direction: law.direction,
            lapse: losses.lapse,
            lapse_scatter: losses.scatter,
            outage,
            far_nodes: has_far_nodes,
            threshold_dbm: receiver.map(|receiver| receiver.threshold_dbm),
            fading_db: receiver.map(|receiver| receiver.fading_db),
            path_loss_exponent: self.path_loss_exponent(),
            shadowing_db: self.shadowing_db(),
        };
        crate::learned::one_key("link_law", &keys)
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let law = &self.law;
        let evidence = match self.evidence {
            LinkEvidence::Packets => "packets",
            LinkEvidence::Rssi => "signal strengths",
            LinkEvidence::PacketsAndRssi => "packets and signal strengths",
        };
        let mut text = format!("{name}: law of links from {evidence}: ");
        let _ = match (self.path_loss_exponent(), self.shadowing_db(), self.receiver) {
            (Some(exponent), Some(shadowing_db), Some(receiver)) => write!(
                text,
                "path-loss exponent {exponent:.1}, shadowing {shadowing_db:.1} dB, fading {:.1} dB",
                receiver.fading_db
            ),
            _ => write!(text, "slope {:.1} and shadowing {:.1} in units of the fading", law.slope, law.shadowing),
        };
        for (share, what) in [(self.losses.lapse, "lapses"), (self.outage, "outages")] {
            if share >= LEAST_SHARE {
                let _ = write!(text, ", {what} {:.0} %", 100.0 * share);
            }
        }
        if self.has_far_nodes {
            text += ", nodes may be far beyond all stops";
        }
        let end = if self.settled { "settled" } else { "did not settle" };
        let _ = match law.has_independent_links() {
            true => write!(text, ", each link by itself"),
            false => {
                write!(text, ", {:.0} % of the shadowing shared over {:.1} m", 100.0 * law.shared, law.correlation_m)
            }
        };
        let _ = write!(text, ", {end} in {}", counted(self.rounds as usize, "round"));
        let why = match (self.settled, law.is_at_bound()) {
            (true, _) => None,
            (false, true) => Some(Unconverged::AtBound),
            (false, false) => Unconverged::of(false, map),
        };
        let warning = why.map(|why| why.warning(name, "the law of links", self.rounds, None));
        std::iter::once(Line { section: Section::Laws, text }).chain(warning).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        vec![CurveFinding {
            network: None,
            name: "law of links",
            probability: Box::new(|distance_m| self.probability(distance_m)),
            of_stops: Vec::new(),
            range_m: None,
        }]
    }

    fn path_loss_exponent(&self) -> Option<f64> {
        self.path_loss_exponent()
    }

    fn shadowing(&self) -> Option<StaticShadowing> {
        let (shared, range_m) = (self.law.shared, self.law.correlation_m);
        self.shadowing_db().map(|deviation_db| StaticShadowing { deviation_db, shared, range_m })
    }
}
