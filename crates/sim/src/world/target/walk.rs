//! Random walks: straight pieces of random length with random turns between them, inside a region, for ever.

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError, SimTime};

use super::super::layout::{Region, RegionConfig};
use super::gait::{Gait, Ground, StraightConfig, Stroll, TurnConfig};
use super::leg::Leg;
use super::{inside, speed};

/// A random walk, as written in a scenario. The target goes straight, turns, goes straight, and so on. At the border of
/// its region it is reflected like light by a mirror; in front of an obstacle it takes any direction that leads away.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomWalkConfig {
    /// Where it starts (m).
    pub start_m: Position,
    /// Speed (m/s).
    pub speed_m_per_s: f64,
    /// How far it goes between two turns.
    pub straight: StraightConfig,
    /// How much it turns; any direction is as likely as any other if absent.
    #[serde(default)]
    pub turn: TurnConfig,
    /// The region that it does not leave. In a flat region it stays at one height.
    pub region: RegionConfig,
}

/// A random walk.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RandomWalk {
    start: Position,
    speed_m_per_s: f64,
    gait: Gait,
    region: Region,
}

impl RandomWalkConfig {
    /// The walk among `obstacles`.
    pub(super) fn build(&self, obstacles: &ObstacleField) -> Result<RandomWalk, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        let start = inside("start_m", self.start_m, &region, obstacles)?;
        let speed_m_per_s = speed("speed_m_per_s", self.speed_m_per_s)?;
        Ok(RandomWalk { start, speed_m_per_s, gait: Gait::new(self.straight, self.turn, speed_m_per_s)?, region })
    }
}

impl RandomWalk {
    pub(super) fn start(&self) -> Position {
        self.start
    }

    /// The walk of target number `number`, from its start.
    pub(super) fn begin(self, number: u64, seed: Seed) -> Walker {
        Walker { stroll: Stroll::new(self.gait, &self.region, number, seed), walk: self }
    }
}

/// A target on its random walk.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walker {
    walk: RandomWalk,
    stroll: Stroll,
}

impl Walker {
    /// The leg that begins at `from` at the time `start`; `None` if there is no way out of that place.
    pub(super) fn leg(&mut self, from: Position, start: SimTime, obstacles: &ObstacleField) -> Option<Leg> {
        let (to, _) = self.stroll.step(from, |_| f64::INFINITY, Ground { region: &self.walk.region, obstacles })?;
        Some(Leg::new(from, to, start, self.walk.speed_m_per_s))
    }
}
