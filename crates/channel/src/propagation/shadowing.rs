//! Slow fading around the mean: log-normal, reciprocal, a pure function of seed and address.

use std::f64::consts::{SQRT_2, TAU};

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use sextant_kernel::{Seed, SettingError, StationId};

use crate::geometry::position::Position;
use crate::power::Db;
use crate::purpose;

/// Shadowing as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShadowingConfig {
    /// Standard deviation (dB); 0 for no shadowing. May be absent if the channel names an environment.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sigma_db: Option<f64>,
    /// Which packets and links share one draw.
    #[cfg_attr(feature = "config", serde(default))]
    pub correlation: CorrelationConfig,
}

/// Which packets and links share one draw of shadowing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum CorrelationConfig {
    /// A separate draw for each packet and pair of stations (thesis, chapter 3).
    #[default]
    PerPacket,
    /// One draw for all packets between two stations while both stay in place.
    PerLink,
    /// A field over places: neighbouring places have similar values.
    Spatial(SpatialConfig),
}

/// Spatial correlation as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpatialConfig {
    /// Distance over which the correlation falls to 1/e (m).
    pub distance_m: f64,
}

/// The spread of shadowing and its correlation, checked; a [`Shadowing`] makes the draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowingLaw {
    sigma_db: f64,
    correlation: CorrelationLaw,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum CorrelationLaw {
    PerPacket,
    PerLink,
    Spatial { distance_m: f64 },
}

impl ShadowingLaw {
    /// No shadowing.
    pub(crate) const NONE: Self = Self { sigma_db: 0.0, correlation: CorrelationLaw::PerLink };
}

impl TryFrom<ShadowingConfig> for ShadowingLaw {
    type Error = SettingError;

    fn try_from(config: ShadowingConfig) -> Result<Self, SettingError> {
        let sigma_db = config.sigma_db.ok_or_else(|| {
            SettingError::missing("sigma_db", "a finite number, 0 or above, or an environment that has one")
        })?;
        Ok(Self {
            sigma_db: SettingError::not_negative("sigma_db", sigma_db)?,
            correlation: match config.correlation {
                CorrelationConfig::PerPacket => CorrelationLaw::PerPacket,
                CorrelationConfig::PerLink => CorrelationLaw::PerLink,
                CorrelationConfig::Spatial(spatial) => CorrelationLaw::Spatial {
                    distance_m: SettingError::positive("distance_m", spatial.distance_m)
                        .map_err(|error| error.within("correlation.spatial"))?,
                },
            },
        })
    }
}

impl ShadowingLaw {
    /// Standard deviation (dB).
    #[must_use]
    pub fn sigma_db(&self) -> f64 {
        self.sigma_db
    }

    /// Whether each packet has another value.
    #[must_use]
    pub fn is_per_packet(&self) -> bool {
        self.sigma_db > 0.0 && matches!(self.correlation, CorrelationLaw::PerPacket)
    }

    /// Whether two links that share an end or are near each other have similar values.
    #[must_use]
    pub fn is_spatial(&self) -> bool {
        matches!(self.correlation, CorrelationLaw::Spatial { .. })
    }
}

/// Log-normal shadowing of zero mean (dB). Both directions of a link have the same value, bit for bit.
///
/// - Per packet: independent for each (pair of stations, packet number).
/// - Per link: independent for each (pair of stations, both places to 1 mm). A robot that moves
///   has a new link; if it comes back, it has the old value again.
/// - Spatial: a Gaussian field over pairs of places, see [`CorrelationConfig::Spatial`]. The correlation
///   of the links (a, b) and (a', b'), for ends much further apart than the decorrelation distance D,
///   is `exp(-|a-a'|/D) exp(-|b-b'|/D)`: with one end fixed, the law of Gudmundson (1991,
///   "Correlation model for shadow fading in mobile radio systems").
#[derive(Clone, Debug)]
pub struct Shadowing {
    sigma_db: f64,
    seed: Seed,
    correlation: Correlation,
}

#[derive(Clone, Debug)]
enum Correlation {
    PerPacket,
    PerLink,
    Spatial(Box<PairField>),
}

impl Shadowing {
    /// Shadowing by `law`, with draws from `seed`.
    #[must_use]
    pub fn new(law: ShadowingLaw, seed: Seed) -> Self {
        let correlation = match law.correlation {
            CorrelationLaw::PerPacket => Correlation::PerPacket,
            CorrelationLaw::PerLink => Correlation::PerLink,
            CorrelationLaw::Spatial { distance_m } => {
                Correlation::Spatial(Box::new(PairField::new(seed, distance_m)))
            }
        };
        Self { sigma_db: law.sigma_db, seed, correlation }
    }

    /// Gain by shadowing between station `a` at `pa` and station `b` at `pb` for packet number `packet`.
    #[must_use]
    #[inline]
    pub fn gain(&self, a: StationId, pa: Position, b: StationId, pb: Position, packet: u64) -> Db {
        if self.sigma_db <= 0.0 {
            return Db(0.0);
        }
        let unit = match &self.correlation {
            Correlation::PerPacket => {
                let pair = (u64::from(a.0.min(b.0)) << 32) | u64::from(a.0.max(b.0));
                self.seed.normal(purpose::SHADOWING, [PER_PACKET, pair, packet])
            }
            Correlation::PerLink => {
                let (first, second) = (self.station(a, pa), self.station(b, pb));
                self.seed.normal(purpose::SHADOWING, [PER_LINK, first.min(second), first.max(second)])
            }
            Correlation::Spatial(field) => field.value(pa, pb),
        };
        Db(self.sigma_db * unit)
    }

    /// Address of a station at a place, to 1 mm.
    fn station(&self, station: StationId, place: Position) -> u64 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an address, saturating far away"
        )]
        let cell = |x_m: f64| (x_m * 1000.0).round() as i64 as u64;
        let planar = self.seed.bits(purpose::SHADOWING, [STATION, cell(place.x_m), cell(place.y_m)]);
        self.seed.bits(purpose::SHADOWING, [planar, cell(place.z_m), u64::from(station.0)])
    }
}

/// First words of addresses, so that modes never share a draw.
const PER_PACKET: u64 = 1;
const PER_LINK: u64 = 2;
const STATION: u64 = 3;
/// Index of the stream that the waves of a field come from.
const WAVES: u64 = 0;

/// A Gaussian field X(a, b) over pairs of places with X(a, b) = X(b, a), mean 0 and variance 1.
///
/// A sum of plane waves with random vectors (spectral method; Shinozuka and Jan 1972; Rahimi and Recht 2007):
/// `F(a, b) = sqrt(2/M) sum_m cos(k_m·a + q_m·b + φ_m)`, k and q independent, each three-variate Cauchy of
/// scale 1/D: its characteristic function is `exp(-|h|/D)`, so over seeds the correlation of F is exactly
/// `exp(-|a-a'|/D) exp(-|b-b'|/D)`. Then `X = (F(a, b) + F(b, a)) / sqrt(2 + 2 exp(-2|a-b|/D))`, because F(a, b) and
/// F(b, a) have correlation `exp(-2|a-b|/D)`. Evaluated as a product of cosines, which is symmetric bit for bit.
/// With M waves the excess kurtosis of F is -1.5/M and one seed's autocorrelation scatters by `M^-0.5` about the law.
#[derive(Clone, Debug)]
struct PairField {
    distance_m: f64,
    waves: Vec<Wave>,
}

#[derive(Clone, Copy, Debug)]
struct Wave {
    /// (k + q) / 2 (rad/m).
    sum: Position,
    /// (k - q) / 2 (rad/m).
    difference: Position,
    phase: f64,
}

/// Number of waves M.
const WAVE_COUNT: usize = 64;

impl PairField {
    fn new(seed: Seed, distance_m: f64) -> Self {
        let mut stream = seed.stream(purpose::SHADOWING, WAVES);
        let mut cauchy = || {
            let mut normal = || -> f64 { StandardNormal.sample(&mut stream) };
            let scale = 1.0 / (normal().abs().max(1e-9) * distance_m);
            Position::new(normal(), normal(), normal()) * scale
        };
        let vectors: Vec<_> = (0..WAVE_COUNT).map(|_| (cauchy(), cauchy())).collect();
        let waves = vectors
            .into_iter()
            .map(|(k, q)| {
                let turn: f64 = StandardUniform.sample(&mut stream);
                Wave { sum: (k + q) * 0.5, difference: (k - q) * 0.5, phase: TAU * turn }
            })
            .collect();
        Self { distance_m, waves }
    }

    fn value(&self, a: Position, b: Position) -> f64 {
        let (sum, difference) = (a + b, a - b);
        let mut total = 0.0;
        for wave in &self.waves {
            total += libm::cos(wave.sum.dot(sum) + wave.phase) * libm::cos(wave.difference.dot(difference));
        }
        // sqrt(2/M) * 2 * total / sqrt(2 + 2 c)
        let count = self.waves.len() as f64;
        let c = libm::exp(-2.0 * difference.length_m() / self.distance_m);
        2.0 * SQRT_2 * total / (count * (2.0 + 2.0 * c)).sqrt()
    }
}
