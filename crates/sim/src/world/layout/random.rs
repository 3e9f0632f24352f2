//! Nodes uniform at random.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sextant_channel::{Bounds, ObstacleField, Position, Storeys};
use sextant_kernel::{Seed, SettingError};

use crate::purpose;

use super::{Region, RegionConfig};

/// Largest number of draws for one node before the region counts as full.
const DRAWS: u64 = 10_000;

/// Largest number of nodes.
const MAX_COUNT: usize = 4_000_000;

/// Nodes uniform at random, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomConfig {
    /// Number of nodes.
    pub count: usize,
    /// Minimum distance between any two nodes (m).
    #[serde(default)]
    pub min_distance_m: f64,
    /// Minimum distance of each node from all obstacles (m).
    #[serde(default)]
    pub clearance_m: f64,
    /// Name of the storey above whose floor the heights of the region are; above zero if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storey: Option<String>,
    /// The region of the nodes.
    pub region: RegionConfig,
}

impl RandomConfig {
    /// The same nodes with heights from zero.
    pub(super) fn above_zero(&self, storeys: &Storeys) -> Result<Self, SettingError> {
        let floor_m = storeys.floor_m("storey", self.storey.as_deref())?;
        Ok(Self { storey: None, region: self.region.raised(floor_m), ..self.clone() })
    }

    /// The places. Each node draws at its own addresses until its place fits the places before it, so that a larger
    /// count does not move the first nodes.
    pub(super) fn place(&self, obstacles: &ObstacleField, seed: Seed) -> Result<Vec<Position>, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        SettingError::not_negative("min_distance_m", self.min_distance_m)?;
        SettingError::not_negative("clearance_m", self.clearance_m)?;
        if self.count == 0 || self.count > MAX_COUNT {
            return Err(SettingError::new("count", self.count, format!("1 to {MAX_COUNT}")));
        }
        let Bounds { min, max } = region.bounds();
        let size = max - min;
        let mut placed =
            Placed { min_distance_m: self.min_distance_m, positions: Vec::new(), cells: BTreeMap::new() };
        for node in 0..self.count as u64 {
            let places = (0..DRAWS).map(|draw| {
                let [u, v, w] = [0, 1, 2].map(|axis| seed.uniform(purpose::LAYOUT, [node, draw, axis]));
                min + Position::new(u * size.x_m, v * size.y_m, w * size.z_m)
            });
            let fits = |p: &Position| {
                region.contains(*p)
                    && obstacles.containing(*p).is_none()
                    && obstacles.distance_m(*p) >= self.clearance_m
                    && placed.is_apart(*p)
            };
            let Some(position) = { places }.find(fits) else {
                let allowed = format!(
                    "about {node}, which fit in the region with min_distance_m = {} and clearance_m = {}",
                    self.min_distance_m, self.clearance_m
                );
                return Err(SettingError::new("count", self.count, allowed));
            };
            placed.push(position);
        }
        Ok(placed.positions)
    }
}

/// The nodes placed so far, in cells as wide as their minimum distance.
struct Placed {
    min_distance_m: f64,
    positions: Vec<Position>,
    cells: BTreeMap<[i64; 3], Vec<usize>>,
}

impl Placed {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast from f64 saturates; far cells may then share an index"
    )]
    fn cell(&self, p: Position) -> [i64; 3] {
        <[f64; 3]>::from(p).map(|coordinate_m| (coordinate_m / self.min_distance_m).floor() as i64)
    }

    fn is_apart(&self, p: Position) -> bool {
        if self.min_distance_m <= 0.0 {
            return true;
        }
        let [x, y, z] = self.cell(p);
        let near = |x: i64| x.saturating_sub(1)..=x.saturating_add(1);
        near(x).flat_map(|x| near(y).flat_map(move |y| near(z).map(move |z| [x, y, z]))).all(|cell| {
            let others = self.cells.get(&cell).map_or(&[][..], Vec::as_slice);
            others.iter().all(|&other| self.positions[other].distance_m(p) >= self.min_distance_m)
        })
    }

    fn push(&mut self, p: Position) {
        if self.min_distance_m > 0.0 {
            self.cells.entry(self.cell(p)).or_default().push(self.positions.len());
        }
        self.positions.push(p);
    }
}
