//! The law of a link without obstacles: checked once, and shared by all users of the channel.

use sextant_kernel::SettingError;

use crate::fading::bursts::{BurstsConfig, BurstsLaw};
use crate::fading::config::FadingConfig;
use crate::fading::law::FadingLaw;
use crate::power::{Db, Dbm};
use crate::propagation::environment::Environment;
use crate::propagation::path_loss::{CloseInConfig, LogDistance, LogDistanceConfig, PathLossConfig};
use crate::propagation::reflection::{ReflectionLaw, ReflectionsConfig};
use crate::propagation::shadowing::{ShadowingConfig, ShadowingLaw};

/// The radio channel as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelConfig {
    /// A known environment. The keys of `path_loss` and `shadowing` override it.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub environment: Option<Environment>,
    /// Loss with distance; from the environment if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub path_loss: Option<PathLossConfig>,
    /// Shadowing. If absent: that of the environment, per packet; no shadowing without an environment.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub shadowing: Option<ShadowingConfig>,
    /// Hard communication radius (m): the longest possible link, this length included; unlimited if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub max_range_m: Option<f64>,
    /// Reflections, which add power to links; none if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reflections: Option<ReflectionsConfig>,
    /// Fading of links from place to place and in time; none if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub fading: Option<FadingConfig>,
    /// Links that are good or bad for a while; always good if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub bursts: Option<BurstsConfig>,
    /// Whether obstacles absorb power.
    #[cfg_attr(feature = "config", serde(default = "obstacles_attenuate"))]
    pub obstacles_attenuate: bool,
}

#[cfg(feature = "config")]
#[inline]
fn obstacles_attenuate() -> bool {
    true
}

impl Default for ChannelConfig {
    /// The suburban environment of the thesis, without a hard radius.
    fn default() -> Self {
        Self {
            environment: Some(Environment::Suburban),
            path_loss: None,
            shadowing: None,
            max_range_m: None,
            reflections: None,
            fading: None,
            bursts: None,
            obstacles_attenuate: true,
        }
    }
}

impl ChannelConfig {
    /// The same channel; if it has a log-distance law without a loss at the reference distance, with that of free space at
    /// the carrier of the radios, `carrier_ghz`.
    #[must_use]
    pub fn with_free_space(self, carrier_ghz: f64) -> Self {
        let path_loss = match (self.path_loss, self.environment) {
            (Some(PathLossConfig::LogDistance(law)), _) => law,
            (None, Some(environment)) if environment.carrier_ghz().is_none() => LogDistanceConfig::default(),
            (Some(PathLossConfig::CloseIn(_)), _) | (None, _) => return self,
        };
        Self { path_loss: Some(PathLossConfig::LogDistance(path_loss.with_free_space(carrier_ghz))), ..self }
    }
}

/// The law of a link without obstacles: loss with distance, shadowing, a hard radius. Checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelLaw {
    path_loss: LogDistance,
    carrier_ghz: Option<f64>,
    radios_ghz: Option<f64>,
    shadowing: ShadowingLaw,
    max_range_m: f64,
    reflections: Option<ReflectionLaw>,
    fading: Option<FadingLaw>,
    bursts: Option<BurstsLaw>,
    obstacles_attenuate: bool,
}

/// The band for which the absorption of materials is listed (GHz).
const LISTED_GHZ: [f64; 2] = [2.4, 2.5];

impl TryFrom<ChannelConfig> for ChannelLaw {
    type Error = SettingError;

    fn try_from(config: ChannelConfig) -> Result<Self, SettingError> {
        let environment = config.environment;
        let path_loss = match (config.path_loss, environment) {
            (Some(path_loss), _) => path_loss,
            (None, Some(environment)) if environment.carrier_ghz().is_some() => {
                PathLossConfig::CloseIn(CloseInConfig::default())
            }
            (None, Some(_)) => PathLossConfig::LogDistance(LogDistanceConfig::default()),
            (None, None) => {
                let needed = format!(
                    "one of {}, or a table `path_loss.log_distance` or `path_loss.close_in`",
                    Environment::names()
                );
                return Err(SettingError::missing("environment", needed));
            }
        };
        let exponent = environment.map(Environment::exponent);
        let (path_loss, carrier_ghz) = match path_loss {
            PathLossConfig::LogDistance(law) => {
                let law = LogDistanceConfig { exponent: law.exponent.or(exponent), ..law };
                let law = LogDistance::try_from(law).map_err(|error| error.within("path_loss.log_distance"))?;
                (law, None)
            }
            PathLossConfig::CloseIn(law) => {
                let carrier_ghz = law.carrier_ghz.or(environment.and_then(Environment::carrier_ghz));
                let law = CloseInConfig { carrier_ghz, exponent: law.exponent.or(exponent), ..law };
                let law = LogDistance::try_from(law).map_err(|error| error.within("path_loss.close_in"))?;
                (law, carrier_ghz)
            }
        };
        let mut shadowing = config.shadowing.unwrap_or_default();
        let inherited = match config.shadowing {
            None => Some(environment.map_or(0.0, Environment::sigma_db)),
            Some(_) => environment.map(Environment::sigma_db),
        };
        shadowing.sigma_db = shadowing.sigma_db.or(inherited);
        Ok(Self {
            path_loss,
            carrier_ghz,
            radios_ghz: None,
            shadowing: ShadowingLaw::try_from(shadowing).map_err(|error| error.within("shadowing"))?,
            max_range_m: match config.max_range_m {
                Some(range_m) => SettingError::positive("max_range_m", range_m)?,
                None => f64::INFINITY,
            },
            reflections: match config.reflections {
                Some(reflections) => {
                    Some(ReflectionLaw::try_from(reflections).map_err(|error| error.within("reflections"))?)
                }
                None => None,
            },
            fading: config.fading.map(FadingLaw::try_from).transpose().map_err(|error| error.within("fading"))?,
            bursts: config.bursts.map(BurstsLaw::try_from).transpose().map_err(|error| error.within("bursts"))?,
            obstacles_attenuate: config.obstacles_attenuate,
        })
    }
}

impl ChannelLaw {
    /// The same law with a hard radius of at most `range_m` (m).
    #[must_use]
    pub fn within_m(self, range_m: f64) -> Self {
        Self { max_range_m: self.max_range_m.min(range_m), ..self }
    }

    /// Loss with distance.
    #[must_use]
    #[inline]
    pub fn path_loss(&self) -> &LogDistance {
        &self.path_loss
    }

    /// Carrier (GHz), if the channel has one: that of close-in path loss.
    #[must_use]
    #[inline]
    pub fn carrier_ghz(&self) -> Option<f64> {
        self.carrier_ghz
    }

    /// The same law for radios at a carrier (GHz): that of the signals if the channel has none. In the 2.4 GHz band materials absorb
    /// as listed, so that it needs no carrier.
    #[must_use]
    pub fn for_radios_at(self, carrier_ghz: f64) -> Self {
        let is_listed = (LISTED_GHZ[0]..=LISTED_GHZ[1]).contains(&carrier_ghz);
        Self { radios_ghz: (!is_listed).then_some(carrier_ghz), ..self }
    }

    /// Carrier of the signals (GHz), at which materials absorb and reflect: that of the channel, or else that of the radios; `None` in
    /// the 2.4 GHz band, for which materials are listed.
    #[must_use]
    #[inline]
    pub fn signal_ghz(&self) -> Option<f64> {
        self.carrier_ghz.or(self.radios_ghz)
    }

    /// How links are reflected, if they are.
    #[inline]
    #[cfg(feature = "obstacles")]
    pub(crate) fn reflections(&self) -> Option<&ReflectionLaw> {
        self.reflections.as_ref()
    }

    /// Height of the ground that reflects (m), if there is one.
    #[must_use]
    pub fn ground_z_m(&self) -> Option<f64> {
        self.reflections.and_then(|law| law.ground_z_m)
    }

    /// How shadowing spreads.
    #[must_use]
    #[inline]
    pub fn shadowing(&self) -> &ShadowingLaw {
        &self.shadowing
    }

    /// How links fade, if they do.
    #[must_use]
    pub fn fading(&self) -> Option<&FadingLaw> {
        self.fading.as_ref()
    }

    /// How links are good or bad for a while, if they are.
    #[must_use]
    pub fn bursts(&self) -> Option<&BurstsLaw> {
        self.bursts.as_ref()
    }

    /// Hard communication radius (m); infinite if unlimited.
    #[must_use]
    #[inline]
    pub fn max_range_m(&self) -> f64 {
        self.max_range_m
    }

    /// Whether obstacles absorb power.
    #[must_use]
    #[inline]
    pub fn obstacles_attenuate(&self) -> bool {
        self.obstacles_attenuate
    }

    /// Distance beyond which even a power four standard deviations above the mean, with fading as rare as that, is below `floor`
    /// (m), at most the hard radius: the range that a spatial index must search.
    #[must_use]
    pub fn reach_m(&self, tx: Dbm, floor: Dbm) -> f64 {
        let by_reflections = self.reflections.map_or(Db(0.0), |law| law.greatest_gain());
        let by_fading = self.fading.map_or(Db(0.0), |law| law.greatest_gain());
        let budget = tx - floor + Db(4.0 * self.shadowing.sigma_db()) + by_reflections + by_fading;
        self.path_loss.distance_m(budget).min(self.max_range_m)
    }

    /// Probability that a packet sent with `tx` arrives with at least `sensitivity` over `distance_m`, behind
    /// obstacles that cost `obstacle_loss`: `Φ((P_mean - sensitivity) / σ)`, 0 beyond the hard radius. With fading and bursts,
    /// over all of their draws.
    #[must_use]
    #[inline]
    pub fn reception_probability(&self, tx: Dbm, sensitivity: Dbm, distance_m: f64, obstacle_loss: Db) -> f64 {
        if distance_m > self.max_range_m {
            return 0.0;
        }
        self.share_received(tx - self.path_loss.loss(distance_m) - obstacle_loss - sensitivity)
    }

    /// Probability that the power of a link is above a threshold that is `margin` below its mean, over all draws of shadowing,
    /// fading and bursts: `Φ(margin / σ)` with shadowing alone.
    #[must_use]
    #[inline]
    pub fn share_above(&self, margin: Db) -> f64 {
        match self.bursts {
            None => self.share_of_power(margin),
            Some(bursts) => bursts.mean_over(|loss| self.share_of_power(margin - loss)),
        }
    }

    /// The same law with those draws alone that change between two stations that stand: shadowing of each packet, fading that
    /// changes in time, and bursts.
    #[must_use]
    pub fn of_changes(&self) -> Self {
        let shadowing = if self.shadowing.is_per_packet() { self.shadowing } else { ShadowingLaw::NONE };
        Self { shadowing, fading: self.fading.filter(FadingLaw::changes_in_time), ..*self }
    }

    /// Probability that a frame arrives over such a link: it is above the threshold, and no burst loses it.
    #[must_use]
    #[inline]
    pub fn share_received(&self, margin: Db) -> f64 {
        match self.bursts {
            None => self.share_of_power(margin),
            Some(bursts) => bursts.share(|loss| self.share_of_power(margin - loss)),
        }
    }

    /// Mean of `of` over the gains of all draws of shadowing, fading and bursts; frames that bursts lose count as 0.
    #[must_use]
    pub fn mean_over(&self, of: impl Fn(Db) -> f64) -> f64 {
        let of_fading = |gain: Db| match &self.fading {
            None => of(gain),
            Some(fading) => fading.mean_over(|fade| of(gain + fade)),
        };
        let of_power = |loss: Db| over_normal(self.shadowing.sigma_db(), |gain| of_fading(gain - loss));
        self.bursts.map_or_else(|| of_power(Db(0.0)), |bursts| bursts.share(of_power))
    }

    /// [`share_above`](Self::share_above) without bursts.
    #[inline]
    fn share_of_power(&self, margin: Db) -> f64 {
        let sigma_db = self.shadowing.sigma_db();
        if let Some(fading) = &self.fading {
            return over_normal(sigma_db, |gain| 1.0 - fading.share_below(Db(0.0) - margin - gain));
        }
        if sigma_db > 0.0 {
            0.5 * libm::erfc(-margin.0 / (sigma_db * std::f64::consts::SQRT_2))
        } else {
            f64::from(u8::from(margin.0 >= 0.0))
        }
    }
}

/// Steps of the sum over the draws of shadowing in a standard deviation (the sum of a smooth law needs few), ...
const STEPS: i32 = 4;
/// ... and the most standard deviations.
const MOST_SIGMAS: i32 = 6;

/// Mean of `of` over a normal gain of mean 0, by the sum of the trapezoidal rule.
fn over_normal(sigma_db: f64, of: impl Fn(Db) -> f64) -> f64 {
    if sigma_db <= 0.0 {
        return of(Db(0.0));
    }
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in -STEPS * MOST_SIGMAS..=STEPS * MOST_SIGMAS {
        let z = f64::from(step) / f64::from(STEPS);
        let weight = libm::exp(-0.5 * z * z);
        weights += weight;
        sum += weight * of(Db(sigma_db * z));
    }
    sum / weights
}
