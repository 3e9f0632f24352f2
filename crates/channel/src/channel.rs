//! The link budget: all that happens to power between two antennas.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::{NodeId, Seed, SettingError};

use crate::{
    Db, Dbm, Environment, LogDistance, LogDistanceConfig, ObstacleField, PathLossConfig, Position, Shadowing,
    ShadowingConfig,
};

/// The radio channel as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelConfig {
    /// A known environment. What `path_loss` and `shadowing` give goes before it, key by key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// Loss with distance; that of the environment if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path_loss: Option<PathLossConfig>,
    /// Shadowing; that of the environment, per packet, if absent; none without an environment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadowing: Option<ShadowingConfig>,
    /// Hard communication radius: no link further than this, one at exactly this [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// Whether obstacles absorb power.
    #[serde(default = "obstacles_attenuate")]
    pub obstacles_attenuate: bool,
}

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
            obstacles_attenuate: true,
        }
    }
}

/// A radio channel in a world of obstacles: `P_rx = P_tx - L(d) - L_obstacles + X` (thesis eq. 3.15).
/// Reciprocal: every answer is the same, bit for bit, with the two ends exchanged.
#[derive(Clone, Debug)]
pub struct Channel {
    path_loss: LogDistance,
    shadowing: Shadowing,
    max_range_m: f64,
    obstacles: ObstacleField,
    obstacles_attenuate: bool,
}

impl Channel {
    /// The channel that `config` describes among `obstacles`, its shadowing drawn from `seed`.
    ///
    /// # Errors
    /// If a value is outside its domain, or neither environment nor path loss is given.
    pub fn new(config: ChannelConfig, obstacles: ObstacleField, seed: Seed) -> Result<Self, SettingError> {
        let environment = config.environment;
        let mut law = match config.path_loss {
            Some(PathLossConfig::LogDistance(law)) => law,
            None if environment.is_some() => LogDistanceConfig::default(),
            None => {
                let names = "\"suburban\", \"heavy-tree\" or \"light-tree\", or a table `path_loss.log_distance`";
                return Err(SettingError::new("environment", "absent", names));
            }
        };
        law.exponent = law.exponent.or(environment.map(Environment::exponent));
        let mut shadowing = config.shadowing.unwrap_or_default();
        let inherited = match config.shadowing {
            None => Some(environment.map_or(0.0, Environment::sigma_db)),
            Some(_) => environment.map(Environment::sigma_db),
        };
        shadowing.sigma_db = shadowing.sigma_db.or(inherited);
        Ok(Self {
            path_loss: LogDistance::try_from(law).map_err(|error| error.within("path_loss.log_distance"))?,
            shadowing: Shadowing::new(shadowing, seed).map_err(|error| error.within("shadowing"))?,
            max_range_m: match config.max_range_m {
                Some(range_m) => SettingError::positive("max_range_m", range_m)?,
                None => f64::INFINITY,
            },
            obstacles,
            obstacles_attenuate: config.obstacles_attenuate,
        })
    }

    /// Loss with distance.
    #[must_use]
    pub fn path_loss(&self) -> &LogDistance {
        &self.path_loss
    }

    /// Standard deviation of shadowing [dB].
    #[must_use]
    pub fn sigma_db(&self) -> f64 {
        self.shadowing.sigma_db()
    }

    /// The obstacles, whether they absorb or not.
    #[must_use]
    pub fn obstacles(&self) -> &ObstacleField {
        &self.obstacles
    }

    /// Hard communication radius [m], infinite if there is none.
    #[must_use]
    pub fn max_range_m(&self) -> f64 {
        self.max_range_m
    }

    /// Power received on average (in decibels) when `tx` is sent; `None` beyond the hard radius.
    #[must_use]
    pub fn mean_power(&self, tx: Dbm, from: Position, to: Position) -> Option<Dbm> {
        let distance_m = from.distance_m(to);
        if distance_m > self.max_range_m {
            return None;
        }
        let mean = tx - self.path_loss.loss(distance_m);
        Some(if self.obstacles_attenuate { mean - self.obstacles.loss(from, to) } else { mean })
    }

    /// Gain by shadowing between station `a` at `pa` and station `b` at `pb` for packet number `packet`.
    #[must_use]
    pub fn shadowing(&self, a: NodeId, pa: Position, b: NodeId, pb: Position, packet: u64) -> Db {
        self.shadowing.gain(a, pa, b, pb, packet)
    }

    /// Power that station `b` receives of packet number `packet` when `a` sends with `tx`;
    /// `None` beyond the hard radius.
    #[must_use]
    pub fn received_power(
        &self,
        tx: Dbm,
        a: NodeId,
        pa: Position,
        b: NodeId,
        pb: Position,
        packet: u64,
    ) -> Option<Dbm> {
        self.mean_power(tx, pa, pb).map(|mean| mean + self.shadowing(a, pa, b, pb, packet))
    }

    /// Distance beyond which a power of `floor` is out of reach even four standard deviations above the mean
    /// [m], at most the hard radius: what a spatial index must look through.
    #[must_use]
    pub fn reach_m(&self, tx: Dbm, floor: Dbm) -> f64 {
        let budget = tx - floor + Db(4.0 * self.sigma_db());
        self.path_loss.distance_m(budget).min(self.max_range_m)
    }

    /// Probability that `tx` arrives with at least `sensitivity` over `distance_m` behind obstacles that take
    /// `obstacle_loss`: `Φ((P_mean - sensitivity) / σ)`, 0 beyond the hard radius.
    #[must_use]
    pub fn reception_probability(&self, tx: Dbm, sensitivity: Dbm, distance_m: f64, obstacle_loss: Db) -> f64 {
        if distance_m > self.max_range_m {
            return 0.0;
        }
        let margin = tx - self.path_loss.loss(distance_m) - obstacle_loss - sensitivity;
        if self.sigma_db() > 0.0 {
            0.5 * libm::erfc(-margin.0 / (self.sigma_db() * std::f64::consts::SQRT_2))
        } else {
            f64::from(u8::from(margin.0 >= 0.0))
        }
    }
}
