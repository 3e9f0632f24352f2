//! The part of the world that a robot stays in.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::layout::{Region, RegionConfig};

use crate::surroundings::Surroundings;

/// The part of the world that a robot stays in: all heights over a region of the plane, or a region of space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Area {
    region: Region,
}

impl Area {
    /// The area that `config` describes. `key` is its key in the settings. The robot must start in the area.
    ///
    /// # Errors
    /// If a value is invalid, or the robot starts outside the area.
    pub(crate) fn round_start(
        key: &str,
        config: &RegionConfig,
        surroundings: &Surroundings<'_>,
    ) -> Result<Self, SettingError> {
        let area = Self { region: Region::try_from(config).map_err(|error| error.within(key))? };
        if !area.contains(surroundings.start) {
            let [x, y, z] = surroundings.start.into();
            let found = format!("a region without the robot's start [{x}, {y}, {z}]");
            return Err(SettingError::new(key, found, "a region with the robot's start"));
        }
        Ok(area)
    }

    /// Whether `place` is in the area.
    pub(crate) fn contains(&self, place: Position) -> bool {
        if self.is_planar() {
            let z_m = self.region.bounds().min.z_m;
            return self.region.contains(Position { z_m, ..place });
        }
        self.region.contains(place)
    }

    /// Whether the area is a region of the plane, without floor and ceiling.
    pub(crate) fn is_planar(&self) -> bool {
        self.region.is_planar()
    }
}
