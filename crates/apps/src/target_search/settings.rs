//! The settings of a target search, checked.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{SettingError, SimTime};
use sextant_sim::Radio;

use super::config::{
    Aim, BeforeDetection, Belief, DetarskConfig, FilterConfig, GradientSources, Informants, OwnPlaceRule, PGConfig,
    PathRule, PredictionConfig, RobustKalmanConfig, SearchMotion, WithoutNews, span,
};
use super::doubt::Doubt;
use super::particle_filter::ParticleFilterSettings;
use super::robust_kalman::RobustKalmanSettings;

/// Allowed times of a step (s).
const STEP_S: [f64; 2] = [0.05, 60.0];

/// Numbers of rounds.
const ROUNDS: u64 = 1 << 16;

/// The settings of a target search, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSearch {
    /// A robot that touches a target at this distance between their centres has captured it (m).
    pub(super) capture_m: f64,
    pub(super) start_delay: Duration,
    pub(super) step: Duration,
    pub(super) own_place: OwnPlaceRule,
    pub(super) path: PathRule,
    pub(super) motion: SearchMotion,
    pub(super) before: BeforeDetection,
    pub(super) method: Method,
}

/// How robots search.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Method {
    Detarsk(Detarsk),
    PseudoGradient(PseudoGradient),
}

/// How robots predict where a target is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Detarsk {
    pub(super) sample: Duration,
    pub(super) neighbourhood_m: Option<f64>,
    pub(super) informants: Informants,
    pub(super) filter: Filter,
    pub(super) prediction: PredictionConfig,
    pub(super) aim: Aim,
    pub(super) without_news: WithoutNews,
    pub(super) max_speed_m_per_s: f64,
    pub(super) belief: Option<Belief>,
    /// How much detections are doubted, if they are.
    pub(super) doubt: Option<Doubt>,
}

/// How robots smooth the detected places of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Filter {
    RobustKalman(RobustKalmanSettings),
    Particles(ParticleFilterSettings),
}

/// How nodes work out the pseudo-gradient.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PseudoGradient {
    /// Time between two rounds.
    pub(super) update: Duration,
    /// How long a node hears its neighbours at most before it tells its own.
    pub(super) jitter: Duration,
    /// The powers of neighbours that are as far and as near as can be.
    pub(super) weakest: Dbm,
    pub(super) strongest: Dbm,
    /// Whether a robot stands after each step until it has heard a round that began since then.
    pub(super) waits: bool,
    pub(super) sources: GradientSources,
}

impl PseudoGradient {
    /// The number of the round at `now`: it begins again after 65535.
    pub(super) fn round_at(&self, now: SimTime) -> u16 {
        let [low, high, ..] = self.rounds_until(now).to_le_bytes();
        u16::from_le_bytes([low, high])
    }

    /// When the latest round with this number began, until `now`.
    pub(super) fn began(&self, round: u16, now: SimTime) -> SimTime {
        let latest = self.rounds_until(now);
        let since = (latest % ROUNDS + ROUNDS - u64::from(round)) % ROUNDS;
        SimTime::from_nanos(latest.saturating_sub(since) * self.update_nanos())
    }

    /// Rounds that have begun before the one at `now`.
    fn rounds_until(&self, now: SimTime) -> u64 {
        now.as_nanos() / self.update_nanos()
    }

    fn update_nanos(&self) -> u64 {
        u64::try_from(self.update.as_nanos()).unwrap_or(u64::MAX)
    }
}

impl TargetSearch {
    /// The settings of DeTarSK.
    ///
    /// # Errors
    /// If a setting is out of its range.
    pub fn detarsk(config: &DetarskConfig) -> Result<Self, SettingError> {
        let max_speed_m_per_s =
            SettingError::in_range("max_target_speed_m_per_s", config.max_target_speed_m_per_s, 1e-3, 1e3)?;
        let filter = match config.filter {
            FilterConfig::RobustKalman(RobustKalmanConfig { zeta, acceleration_sigma_m_per_s2 }) => {
                let settings = RobustKalmanSettings {
                    zeta,
                    acceleration_sigma_m_per_s2,
                    max_speed_m_per_s,
                    ..RobustKalmanSettings::default()
                };
                let checked = settings.validated().map_err(|error| error.within("filter.robust_kalman"))?;
                Filter::RobustKalman(checked)
            }
            FilterConfig::Particles(written) => {
                let settings = ParticleFilterSettings {
                    particles: written.particles,
                    sensing_radius_m: written.sensing_radius_m,
                    contradiction: written.contradiction,
                    max_speed_m_per_s,
                    turns_per_s: written.turns_per_s,
                    acceleration_sigma_m_per_s2: written.acceleration_sigma_m_per_s2,
                };
                Filter::Particles(settings.validated().map_err(|error| error.within("filter.particles"))?)
            }
        };
        let (preset, neighbourhood_m) = (config.preset, config.neighbourhood_m);
        let step = span("step_s", config.step_s, STEP_S)?;
        let sample = config.sample_s.map(|sample_s| span("sample_s", sample_s, STEP_S)).transpose()?;
        Ok(Self {
            capture_m: SettingError::in_range("capture_m", config.capture_m, 1e-3, 1e3)?,
            start_delay: span("start_delay_s", config.start_delay_s, [0.0, 1e6])?,
            step,
            own_place: preset.or(config.own_place, OwnPlaceRule::Fused, OwnPlaceRule::ReceivedPower),
            path: preset.or(config.path, PathRule::AStar, PathRule::Greedy),
            motion: preset.or(config.motion, SearchMotion::Continuous, SearchMotion::Discrete),
            before: config.before_detection,
            method: Method::Detarsk(Detarsk {
                sample: preset.or(sample, Duration::from_millis(250), step),
                neighbourhood_m: neighbourhood_m
                    .map(|radius_m| SettingError::positive("neighbourhood_m", radius_m))
                    .transpose()?,
                informants: preset.or(config.informants, Informants::AllThatHear, Informants::Neighbourhood),
                filter,
                prediction: preset.or(config.prediction, PredictionConfig::Waves, PredictionConfig::Integral),
                aim: preset.or(config.aim, Aim::Interception, Aim::Pursuit),
                without_news: preset.or(config.without_news, WithoutNews::On, WithoutNews::Back),
                max_speed_m_per_s,
                belief: config.detections,
                doubt: None,
            }),
        })
    }

    /// The same among sensors of which `doubt` is known: that they raise false alarms.
    ///
    /// # Errors
    /// `detections` if detections are to be doubted that are never false.
    pub fn among(mut self, doubt: Option<Doubt>) -> Result<Self, SettingError> {
        if let Method::Detarsk(method) = &mut self.method {
            method.doubt = match (method.belief, doubt) {
                (Some(Belief::Doubted), None) => {
                    let allowed = "`trusted`, or sensors with `false_alarms_per_h` above 0";
                    return Err(SettingError::new("detections", "`doubted`, without false alarms", allowed));
                }
                (Some(Belief::Trusted), _) => None,
                (_, doubt) => doubt,
            };
        }
        Ok(self)
    }

    /// The settings of P-G among radios like `radio`.
    ///
    /// # Errors
    /// If a setting is out of its range.
    pub fn pseudo_gradient(config: &PGConfig, radio: &Radio) -> Result<Self, SettingError> {
        let preset = config.preset;
        let update = config.update_s.map(|update_s| span("update_s", update_s, STEP_S)).transpose()?;
        let update = preset.or(update, Duration::from_secs(2), Duration::from_millis(1750));
        Ok(Self {
            capture_m: SettingError::in_range("capture_m", config.capture_m, 1e-3, 1e3)?,
            start_delay: span("start_delay_s", config.start_delay_s, [0.0, 1e6])?,
            step: span("step_s", config.step_s, STEP_S)?,
            own_place: config.own_place,
            path: preset.or(config.path, PathRule::AStar, PathRule::Greedy),
            motion: preset.or(config.motion, SearchMotion::Continuous, SearchMotion::Discrete),
            before: config.before_detection,
            method: Method::PseudoGradient(PseudoGradient {
                update,
                waits: preset.or(config.wait_for_round, false, true),
                sources: preset.or(config.sources, GradientSources::Detecting, GradientSources::Detected),
                jitter: update / 8,
                weakest: radio.sensitivity(),
                // At the reference distance of one metre, a frame is as strong as it was sent.
                strongest: radio.tx_power(),
            }),
        })
    }

    /// How much detections are doubted, if they are.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        match &self.method {
            Method::Detarsk(method) => method.doubt,
            Method::PseudoGradient(_) => None,
        }
    }

    /// Whether all nodes that hear a robot tell it what they detected, and not only its neighbourhood.
    pub(super) fn tells_all(&self) -> bool {
        matches!(&self.method, Method::Detarsk(method) if method.informants == Informants::AllThatHear)
    }
}
