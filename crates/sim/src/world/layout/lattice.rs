//! Nodes on a jittered lattice.

use serde::{Deserialize, Serialize};
use sextant_channel::{Bounds, ObstacleField, Position, Storeys};
use sextant_kernel::{Seed, SettingError};

use crate::purpose;

use super::{Region, RegionConfig};

/// Largest number of sites of a lattice; more sites are rejected before they are visited.
const MAX_SITES: f64 = 4e6;

/// Nodes on a jittered lattice, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LatticeConfig {
    /// Distance between neighbouring sites along x, y and, in a solid region, z (m).
    pub spacing_m: f64,
    /// Each node is moved from its site by up to this much along each axis, uniform at random (m).
    #[serde(default)]
    pub jitter_m: f64,
    /// Number of nodes. If more sites fit, that many are chosen at random; all sites if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// A site of the lattice (m); half a spacing from the smallest corner of the region's bounds if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin_m: Option<Position>,
    /// Minimum distance of each node from all obstacles (m).
    #[serde(default)]
    pub clearance_m: f64,
    /// Name of the storey above whose floor the heights of the region and of `origin_m` are; above zero if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storey: Option<String>,
    /// The region of the nodes.
    pub region: RegionConfig,
}

/// A site that has room for a node.
struct Site {
    /// Position of the site in the random order of choice.
    lot: u64,
    position: Position,
}

impl LatticeConfig {
    /// The same nodes with heights from zero.
    pub(super) fn above_zero(&self, storeys: &Storeys) -> Result<Self, SettingError> {
        let floor_m = storeys.floor_m("storey", self.storey.as_deref())?;
        let origin_m = self.origin_m.map(|origin| origin + Position::new(0.0, 0.0, floor_m));
        Ok(Self { storey: None, origin_m, region: self.region.raised(floor_m), ..self.clone() })
    }

    /// The places: row by row or, if there is a `count`, in the order of choice, so that a larger count keeps the
    /// places of a smaller one.
    pub(super) fn place(&self, obstacles: &ObstacleField, seed: Seed) -> Result<Vec<Position>, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        SettingError::positive("spacing_m", self.spacing_m)?;
        SettingError::in_range("jitter_m", self.jitter_m, 0.0, self.spacing_m)?;
        SettingError::not_negative("clearance_m", self.clearance_m)?;
        if let Some(origin) = self.origin_m.filter(|origin| !origin.is_finite()) {
            let [x, y, z] = origin.into();
            return Err(SettingError::new("origin_m", format!("[{x}, {y}, {z}]"), "finite coordinates in metres"));
        }
        if self.count == Some(0) {
            return Err(SettingError::new("count", 0, "at least 1"));
        }
        let sites = site_count(&region, self.spacing_m);
        if sites > MAX_SITES {
            let found = format!("{}, which gives {sites:.0} sites", self.spacing_m);
            return Err(SettingError::new(
                "spacing_m",
                found,
                format!("a spacing that gives at most {MAX_SITES:.0} sites"),
            ));
        }
        let mut sites = self.sites(self.spacing_m, &region, obstacles, seed);
        let fit = sites.len();
        match self.count {
            Some(count) if count > fit => return Err(self.too_many(count, fit, &region, obstacles, seed)),
            Some(count) => {
                sites.sort_by_key(|site| site.lot);
                sites.truncate(count);
            }
            None if fit == 0 => {
                let found = format!("{}, with which no site fits", self.spacing_m);
                return Err(SettingError::new(
                    "spacing_m",
                    found,
                    "a spacing with a site in the region, clear of obstacles",
                ));
            }
            None => {}
        }
        Ok(sites.into_iter().map(|site| site.position).collect())
    }

    /// The sites that have room for a node, row by row.
    fn sites(&self, spacing_m: f64, region: &Region, obstacles: &ObstacleField, seed: Seed) -> Vec<Site> {
        let Bounds { min, max } = region.bounds();
        let half = if region.is_planar() { 0.0 } else { 0.5 * spacing_m };
        let corner = min + Position::new(0.5 * spacing_m, 0.5 * spacing_m, half);
        let origin = self.origin_m.unwrap_or(corner);
        let indices = |origin: f64, min: f64, max: f64| {
            let first = ((min - self.jitter_m - origin) / spacing_m).ceil();
            let last = ((max + self.jitter_m - origin) / spacing_m).floor();
            whole(first)..=whole(last)
        };
        let heights = if region.is_planar() { 0..=0 } else { indices(origin.z_m, min.z_m, max.z_m) };
        let mut sites = Vec::new();
        for k in heights {
            for j in indices(origin.y_m, min.y_m, max.y_m) {
                for i in indices(origin.x_m, min.x_m, max.x_m) {
                    // The address is the index of the site in the lattice, independent of the region and of other
                    // sites.
                    let address = [i.cast_unsigned(), j.cast_unsigned(), k.cast_unsigned() << 2];
                    let shift = |axis: u64| {
                        let uniform = seed.uniform(purpose::LAYOUT, [address[0], address[1], address[2] | axis]);
                        self.jitter_m * (2.0 * uniform - 1.0)
                    };
                    let site = |origin: f64, index: i64| spacing_m.mul_add(index_as_f64(index), origin);
                    let z_m = if region.is_planar() { min.z_m } else { site(origin.z_m, k) + shift(2) };
                    let position = Position::new(site(origin.x_m, i) + shift(0), site(origin.y_m, j) + shift(1), z_m);
                    let clear = obstacles.is_empty()
                        || (obstacles.containing(position).is_none()
                            && obstacles.distance_m(position) >= self.clearance_m);
                    if region.contains(position) && clear {
                        let lot = seed.bits(purpose::LAYOUT, [address[0], address[1], address[2] | 3]);
                        sites.push(Site { lot, position });
                    }
                }
            }
        }
        sites
    }

    /// The error that `count` nodes are more than `fit`, with a spacing at which they would fit.
    fn too_many(
        &self,
        count: usize,
        fit: usize,
        region: &Region,
        obstacles: &ObstacleField,
        seed: Seed,
    ) -> SettingError {
        let per_side = if region.is_planar() { 1.0 / 2.0 } else { 1.0 / 3.0 };
        let mut allowed = format!("at most {fit} with spacing_m = {}", self.spacing_m);
        // Three digits are enough for a suggestion; the share of sites that fit hardly depends on the spacing.
        let mut spacing_m = self.spacing_m * libm::pow(as_f64(fit.max(1)) / as_f64(count), per_side);
        for _ in 0..50 {
            let digits = libm::pow(10.0, 2.0 - libm::log10(spacing_m).floor());
            spacing_m = (spacing_m * digits).floor() / digits;
            if site_count(region, spacing_m) > MAX_SITES || self.jitter_m > spacing_m {
                break;
            }
            if self.sites(spacing_m, region, obstacles, seed).len() >= count {
                allowed = format!("{allowed}; {count} fit with spacing_m = {spacing_m}");
                break;
            }
            spacing_m *= 0.995;
        }
        SettingError::new("count", count, allowed)
    }
}

/// Approximate number of sites in the bounds of the region.
fn site_count(region: &Region, spacing_m: f64) -> f64 {
    let Bounds { min, max } = region.bounds();
    let size = max - min;
    <[f64; 3]>::from(size).into_iter().map(|side_m| side_m / spacing_m + 1.0).product()
}

#[expect(clippy::cast_possible_truncation, reason = "a cast from f64 saturates, and the number of sites was checked")]
fn whole(index: f64) -> i64 {
    index as i64
}

fn index_as_f64(index: i64) -> f64 {
    index as f64
}

fn as_f64(count: usize) -> f64 {
    count as f64
}
