//! What changes a link in time, for people and for programs: fading, bursts of loss, and what was measured.

use std::fmt::{self, Formatter};

use serde::Serialize;
use sextant_channel::{ChannelLaw, Db, Traced};
use sextant_sim::LinkBudget;

/// How fading changes the power of a link.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FadingReport {
    /// Its law, in words: `Rayleigh`, or `Rician, K 6 dB`.
    pub law: String,
    /// Whether it changes in time while both ends stand.
    pub changes_in_time: bool,
    /// The gain of this link (dB), if it is the same at all times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub draw_db: Option<f64>,
    /// The gain that one of ten draws is below (dB).
    pub tenth_below_db: f64,
    /// The gain that one of a hundred draws is below (dB).
    pub hundredth_below_db: f64,
}

/// How bursts of loss change a link.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BurstsReport {
    /// Share of time for which the link is bad.
    pub bad_share: f64,
    /// Loss of power while it is bad (dB).
    pub bad_loss_db: f64,
    /// Share of the frames that arrive over all time, of those that would be received at the power without bursts.
    pub success: f64,
}

/// What was measured on a link at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredReport {
    /// Share of the frames that arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prr: Option<f64>,
    /// Strength (dBm).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rssi_dbm: Option<f64>,
}

impl FadingReport {
    pub(super) fn of(law: &ChannelLaw, budget: Option<&LinkBudget>) -> Option<Self> {
        let fading = law.fading()?;
        Some(Self {
            law: fading.name(),
            changes_in_time: fading.changes_in_time(),
            draw_db: budget.and_then(|budget| budget.fading).map(|gain| gain.0),
            tenth_below_db: fading.quantile(0.1).0,
            hundredth_below_db: fading.quantile(0.01).0,
        })
    }

    /// What the numbers do not say.
    pub(super) fn write_notes(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { law, tenth_below_db, hundredth_below_db, .. } = self;
        let spread = format!(
            "one draw of ten is below {tenth_below_db:.1} dB, one of a hundred below {hundredth_below_db:.1} dB"
        );
        match self.changes_in_time {
            true => writeln!(f, "Fading ({law}) changes in time: {spread}; the power is the one without it."),
            false => writeln!(
                f,
                "The fading of this link ({law}) is that of the two places; a few centimetres beside there is another one: {spread}."
            ),
        }
    }
}

impl BurstsReport {
    pub(super) fn of(law: &ChannelLaw) -> Option<Self> {
        let bursts = law.bursts()?;
        let (bad_loss_db, bad_share) = (bursts.bad_loss().0, bursts.bad_share());
        Some(Self { bad_share, bad_loss_db, success: bursts.share(|_: Db| 1.0) })
    }

    /// What the numbers do not say.
    pub(super) fn write_notes(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { bad_share, bad_loss_db, success } = self;
        write!(f, "The link is bad for {:.1} % of the time", 100.0 * bad_share)?;
        if *bad_loss_db > 0.0 {
            write!(f, ", when it has {bad_loss_db} dB less power")?;
        }
        if *success < 1.0 {
            write!(f, "; {:.1} % of the frames that are received otherwise arrive", 100.0 * success)?;
        }
        writeln!(f, ".")
    }
}

impl MeasuredReport {
    pub(super) fn of(budget: &LinkBudget) -> Option<Self> {
        match budget.traced {
            Traced::Measured(link) => {
                Some(Self { prr: link.share, rssi_dbm: link.strength.map(|strength| strength.0) })
            }
            Traced::Silent => Some(Self { prr: Some(0.0), rssi_dbm: None }),
            Traced::Law => None,
        }
    }

    /// In words.
    pub(super) fn text(&self) -> String {
        let prr = self.prr.map(|prr| format!("{:.1} %", 100.0 * prr));
        let strength = self.rssi_dbm.map(|dbm| format!("{dbm:.1} dBm"));
        prr.into_iter().chain(strength).collect::<Vec<_>>().join(", ")
    }
}
