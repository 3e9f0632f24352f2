//! Settings of sector sweeps.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;
use sextant_kernel::text::counted;

use super::edca::AccessCategory;
use super::frame::{MAX_MEASUREMENTS, brp_octets};
use super::sector::SectorLayout;
use super::timing::{MBIFS, SIFS, SLOT, SSW_FEEDBACK_AIRTIME, control_airtime, slot_duration};

/// Longest window for answers (ms).
const MAX_WINDOW_MS: f64 = 1000.0;
/// Most retransmissions of a responder sweep.
const MAX_RETRIES: u8 = 7;
/// Most slots of an A-BFT (IEEE 802.11ad-2012, 8.4a.3).
const MAX_SLOTS: u8 = 8;
/// Most SSW frames in a slot of an A-BFT.
const MAX_FRAMES_PER_SLOT: u8 = 16;

/// Sector sweeps of IEEE 802.11ad between a robot that sweeps and nodes that answer, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SweepConfig {
    /// How the nodes that heard a sweep share the channel for their answers.
    pub contention: ContentionConfig,
    /// Longest time for answers after a sweep (ms): above 0, at most 1000. An A-BFT lasts as long as its slots instead.
    pub window_ms: f64,
    /// Access category of contention: how long a station waits before it transmits.
    pub access_category: AccessCategory,
}

impl Default for SweepConfig {
    fn default() -> Self {
        Self { contention: ContentionConfig::default(), window_ms: 5.0, access_category: AccessCategory::default() }
    }
}

/// How the nodes that heard a sweep share the channel, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ContentionConfig {
    /// CSMA/CA without feedback: each node sends its sectors once.
    #[default]
    Csma,
    /// CSMA/CA with feedback: a node that gets none tries again with a doubled contention window.
    CsmaFeedback(CsmaFeedbackConfig),
    /// Association beamforming training: each node draws one of the slots that follow the sweep.
    Abft(AbftConfig),
}

/// CSMA/CA with feedback, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CsmaFeedbackConfig {
    /// Further sweeps of a node that gets no feedback, within the window: 0 to 7.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 7)))]
    pub max_retries: u8,
    /// Whether the robot asks, with its feedback, for the signal-to-noise ratios of all its sectors that the node heard. The
    /// node reports them in one further frame: at most 127, the strongest.
    pub report_all_sectors: bool,
}

impl Default for CsmaFeedbackConfig {
    fn default() -> Self {
        Self { max_retries: MAX_RETRIES, report_all_sectors: false }
    }
}

/// Association beamforming training (A-BFT), as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct AbftConfig {
    /// Slots after each sweep (A-BFT Length): 1 to 8.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 8)))]
    pub slots: u8,
    /// SSW frames that fit in a slot (FSS): 1 to 16. A node with more sectors goes on in the next slots and, if there are
    /// none left, in the slots after the next sweep.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 16)))]
    pub frames_per_slot: u8,
    /// Whether the robot answers in the slot with the best sector of the node.
    pub feedback: bool,
}

impl Default for AbftConfig {
    fn default() -> Self {
        Self { slots: 8, frames_per_slot: 8, feedback: true }
    }
}

/// How responders share the channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contention {
    /// CSMA/CA without feedback.
    #[default]
    Csma,
    /// CSMA/CA with feedback.
    CsmaFeedback {
        /// Further sweeps without feedback.
        max_retries: u8,
        /// Whether initiators ask for the SNRs of all their sectors.
        report_all_sectors: bool,
    },
    /// Slots of an A-BFT.
    Abft(Abft),
}

/// An association beamforming training, settings checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abft {
    slots: u8,
    frames_per_slot: u8,
    has_feedback: bool,
}

impl Abft {
    /// Number of slots, 1 to 8.
    #[must_use]
    pub const fn slots(&self) -> u8 {
        self.slots
    }

    /// SSW frames per slot, 1 to 16.
    #[must_use]
    pub const fn frames_per_slot(&self) -> u8 {
        self.frames_per_slot
    }

    /// Whether the initiator answers in the slot.
    #[must_use]
    pub(crate) const fn has_feedback(&self) -> bool {
        self.has_feedback
    }

    /// Length of a slot.
    #[must_use]
    pub(crate) fn slot_duration(&self) -> Duration {
        slot_duration(self.frames_per_slot)
    }

    /// Length of all slots.
    #[must_use]
    pub fn duration(&self) -> Duration {
        self.slot_duration() * u32::from(self.slots)
    }
}

/// Sector sweeps, settings checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepSettings {
    contention: Contention,
    window: Duration,
    access_category: AccessCategory,
    longest_answer: Duration,
}

/// How a responder answers sweeps: settings of sector sweeps that its own sectors fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnswerSettings {
    sweep: SweepSettings,
    layout: SectorLayout,
}

impl AnswerSettings {
    /// The settings of sector sweeps; their longest answer is that of the responder.
    #[must_use]
    pub const fn sweep(&self) -> SweepSettings {
        self.sweep
    }

    /// The sectors of the responder.
    #[must_use]
    pub const fn layout(&self) -> SectorLayout {
        self.layout
    }
}

impl SweepSettings {
    /// The same for responders whose sweep lasts `span` at most. An initiator hears only those of its frames that point
    /// at it, so it must expect one after so long a silence.
    #[must_use]
    pub(crate) const fn with_longest_answer(self, span: Duration) -> Self {
        Self { longest_answer: span, ..self }
    }

    /// These settings for responders whose antenna has the sectors of `layout`.
    ///
    /// # Errors
    /// If the antenna cannot answer in a slot, or not even an answer without backoff ends in the window.
    pub fn answers(self, layout: SectorLayout) -> Result<AnswerSettings, SettingError> {
        self.check_responder(&layout)?;
        self.check_window(&layout)?;
        Ok(AnswerSettings { sweep: self.with_longest_answer(layout.sweep_duration()), layout })
    }

    /// The longest sweep of a responder; zero if not known.
    #[must_use]
    pub(crate) const fn longest_answer(&self) -> Duration {
        self.longest_answer
    }

    /// How responders share the channel.
    #[must_use]
    pub const fn contention(&self) -> Contention {
        self.contention
    }

    /// Longest time for answers, from MBIFS after the end of a sweep.
    #[must_use]
    pub fn window(&self) -> Duration {
        match self.contention {
            Contention::Csma | Contention::CsmaFeedback { .. } => self.window,
            Contention::Abft(abft) => abft.duration(),
        }
    }

    /// Access category of contention.
    #[must_use]
    pub const fn access_category(&self) -> AccessCategory {
        self.access_category
    }

    /// Whether initiators ask for the SNRs of all their sectors.
    #[must_use]
    pub(crate) const fn reports_all_sectors(&self) -> bool {
        matches!(self.contention, Contention::CsmaFeedback { report_all_sectors: true, .. })
    }

    /// For how long the medium stays taken after a responder sweep that answers a sweep to all with so many `sectors`.
    pub(super) fn taken_after_answer(&self, sectors: u16) -> Duration {
        match self.contention {
            Contention::CsmaFeedback { .. } => MBIFS + SSW_FEEDBACK_AIRTIME + self.taken_after_feedback(sectors),
            Contention::Csma | Contention::Abft(_) => Duration::ZERO,
        }
    }

    /// For how long the medium stays taken after the feedback: until the end of a report of so many `sectors`, if the
    /// initiator asks for one.
    pub(super) fn taken_after_feedback(&self, sectors: u16) -> Duration {
        let measurements = u8::try_from(sectors).unwrap_or(u8::MAX).min(MAX_MEASUREMENTS);
        if self.reports_all_sectors() { SIFS + control_airtime(brp_octets(measurements)) } else { Duration::ZERO }
    }

    /// Whether an answer that begins as early as it may ends in the window.
    ///
    /// # Errors
    /// If it does not, so that no answer would ever be sent.
    fn check_window(&self, layout: &SectorLayout) -> Result<(), SettingError> {
        let least = self.access_category.aifs() + layout.sweep_duration();
        if matches!(self.contention, Contention::Abft(_)) || self.window >= least {
            return Ok(());
        }
        let ms = |span: Duration| span.as_nanos().div_ceil(1000) as f64 / 1e3;
        let longest = least + SLOT * self.access_category.cw_min();
        let allowed = format!(
            "at least {} for the {} of an answer after AIFS, and {} for the longest first backoff too",
            ms(least),
            counted(usize::from(layout.total()), "frame"),
            ms(longest)
        );
        Err(SettingError::new("window_ms", ms(self.window), allowed))
    }

    /// Whether a responder with these sectors can answer.
    ///
    /// # Errors
    /// If it has several DMG antennas, for which a slot of the A-BFT has no time.
    fn check_responder(&self, layout: &SectorLayout) -> Result<(), SettingError> {
        if !matches!(self.contention, Contention::Abft(_)) || layout.antennas() == 1 {
            return Ok(());
        }
        let found = format!("slots for nodes with {} DMG antennas", layout.antennas());
        let allowed = "slots for nodes with one DMG antenna: a slot has no time to change it";
        Err(SettingError::new("contention.abft", found, allowed))
    }
}

impl Default for SweepSettings {
    fn default() -> Self {
        Self {
            contention: Contention::Csma,
            window: Duration::from_millis(5),
            access_category: AccessCategory::BestEffort,
            longest_answer: Duration::ZERO,
        }
    }
}

impl TryFrom<SweepConfig> for SweepSettings {
    type Error = SettingError;

    fn try_from(config: SweepConfig) -> Result<Self, SettingError> {
        let SweepConfig { contention, window_ms, access_category } = config;
        let contention = Contention::try_from(contention).map_err(|error| error.within("contention"))?;
        if !(window_ms > 0.0 && window_ms <= MAX_WINDOW_MS) {
            return Err(SettingError::new("window_ms", window_ms, format!("above 0, at most {MAX_WINDOW_MS}")));
        }
        let window = Duration::from_secs_f64(1e-3 * window_ms);
        Ok(Self { contention, window, access_category, longest_answer: Duration::ZERO })
    }
}

impl TryFrom<ContentionConfig> for Contention {
    type Error = SettingError;

    fn try_from(config: ContentionConfig) -> Result<Self, SettingError> {
        let within = |key: &str, value: u8, low: u8, high: u8| {
            if (low..=high).contains(&value) {
                Ok(value)
            } else {
                Err(SettingError::new(key, value, format!("{low} to {high}")))
            }
        };
        match config {
            ContentionConfig::Csma => Ok(Self::Csma),
            ContentionConfig::CsmaFeedback(CsmaFeedbackConfig { max_retries, report_all_sectors }) => {
                let max_retries = within("csma_feedback.max_retries", max_retries, 0, MAX_RETRIES)?;
                Ok(Self::CsmaFeedback { max_retries, report_all_sectors })
            }
            ContentionConfig::Abft(AbftConfig { slots, frames_per_slot, feedback }) => Ok(Self::Abft(Abft {
                slots: within("abft.slots", slots, 1, MAX_SLOTS)?,
                frames_per_slot: within("abft.frames_per_slot", frames_per_slot, 1, MAX_FRAMES_PER_SLOT)?,
                has_feedback: feedback,
            })),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(contention: ContentionConfig, window_ms: f64) -> Option<(String, String, String)> {
        let config = SweepConfig { contention, window_ms, ..SweepConfig::default() };
        SweepSettings::try_from(config)
            .err()
            .map(|error| (error.key.clone(), error.found().to_owned(), error.allowed().to_owned()))
    }

    fn abft(slots: u8, frames_per_slot: u8) -> ContentionConfig {
        ContentionConfig::Abft(AbftConfig { slots, frames_per_slot, ..AbftConfig::default() })
    }

    fn message(key: &str, found: &str, allowed: &str) -> Option<(String, String, String)> {
        Some((key.to_owned(), found.to_owned(), allowed.to_owned()))
    }

    #[test]
    fn the_defaults_as_written_are_the_defaults_as_used() {
        assert_eq!(SweepSettings::try_from(SweepConfig::default()), Ok(SweepSettings::default()));
    }

    #[test]
    fn settings_beyond_their_fields_are_rejected() {
        let retries = |max_retries| {
            ContentionConfig::CsmaFeedback(CsmaFeedbackConfig { max_retries, ..CsmaFeedbackConfig::default() })
        };
        let csma = ContentionConfig::Csma;
        assert_eq!(refused(retries(8), 5.0), message("contention.csma_feedback.max_retries", "8", "0 to 7"));
        assert_eq!(refused(abft(9, 8), 5.0), message("contention.abft.slots", "9", "1 to 8"));
        assert_eq!(refused(abft(0, 8), 5.0), message("contention.abft.slots", "0", "1 to 8"));
        assert_eq!(refused(abft(8, 17), 5.0), message("contention.abft.frames_per_slot", "17", "1 to 16"));
        assert_eq!(refused(csma, 0.0), message("window_ms", "0", "above 0, at most 1000"));
        assert_eq!(refused(csma, f64::NAN), message("window_ms", "NaN", "above 0, at most 1000"));
        for good in [csma, retries(0), retries(7), abft(1, 1), abft(8, 16)] {
            assert_eq!(refused(good, 1000.0), None);
        }
    }

    #[test]
    fn a_responder_in_a_slot_has_one_dmg_antenna() {
        let config = SweepConfig { contention: abft(8, 8), ..SweepConfig::default() };
        let settings = SweepSettings::try_from(config).expect("good settings");
        let refused = |sectors: &[u8]| {
            let layout = SectorLayout::new(sectors).expect("a good layout");
            settings.answers(layout).err().map(|error| error.key)
        };
        assert_eq!(refused(&[8]), None);
        assert_eq!(refused(&[64]), None);
        assert_eq!(refused(&[4, 4]).as_deref(), Some("contention.abft"));
        assert_eq!(settings.window(), Duration::from_micros(8 * 163));
    }

    #[test]
    fn a_window_in_which_no_answer_ends_is_refused() {
        let refused = |contention, window_ms, sectors: u8| {
            let config = SweepConfig { contention, window_ms, ..SweepConfig::default() };
            let settings = SweepSettings::try_from(config).expect("good settings");
            let layout = SectorLayout::new(&[sectors]).expect("a good layout");
            settings.answers(layout).err().map(|error| (error.key.clone(), error.to_string()))
        };
        // AIFS of 18 us, and 8 frames of 14.909 us with 7 gaps of 1 us.
        let (key, message) = refused(ContentionConfig::Csma, 0.144, 8).expect("too short");
        assert_eq!(key, "window_ms");
        for part in ["0.144", "at least 0.145 for the 8 frames", "0.22 for the longest first backoff"] {
            assert!(message.contains(part), "{message}");
        }
        assert_eq!(refused(ContentionConfig::Csma, 0.145, 8), None);
        assert_eq!(refused(ContentionConfig::Csma, 0.144, 7), None);
        // Slots have their own time.
        assert_eq!(refused(abft(8, 8), 0.1, 8), None);
    }
}
