//! A Hilbert curve.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{Controller, RobotCommand, Situation, StopsLeftOut};

use crate::itinerary::{Itinerary, Then};
use crate::surroundings::Surroundings;

/// Highest order; it has 262144 stops.
const MAX_ORDER: u32 = 9;
/// Lengths are equal if their relative difference is below this.
const ROUNDING: f64 = 1e-9;

/// A Hilbert curve over a region, as written in a scenario (thesis, section 3.4).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HilbertConfig {
    /// The curve covers the bounding box of this region. The curve is square, so it covers more if the box is not
    /// square.
    pub region: RegionConfig,
    /// Order of the curve, 1 to 9. The curve visits 4^order cells, which fill the square round the region. Give
    /// either this or `spacing_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 9)))]
    pub order: Option<u32>,
    /// Side of the cells, which is the distance between stops (m). The order is the lowest with which the curve
    /// covers the region; the curve exceeds the region equally on all sides. Give either this or `order`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing_m: Option<f64>,
    /// Height of the path (m). If absent, the height of the robot's start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
}

/// Drives along a Hilbert curve (Hilbert 1891) and stops in the middle of each cell. The curve is mirrored so that it
/// begins in the corner nearest to the robot's start. Stops inside an obstacle are left out, and the way round the
/// obstacle is planned.
#[derive(Clone, Debug)]
pub struct Hilbert {
    itinerary: Itinerary,
}

impl Hilbert {
    /// The curve that `config` describes.
    ///
    /// # Errors
    /// If a value is invalid, neither or both of `order` and `spacing_m` are given, or no stop can be reached.
    pub fn plan(config: &HilbertConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        let region = Region::try_from(&config.region).map_err(|error| error.within("region"))?;
        let z_m = SettingError::finite("height_m", config.height_m.unwrap_or(surroundings.start.z_m))?;
        let bounds = region.bounds();
        let size = bounds.max - bounds.min;
        let curve = Curve::new(config, size.x_m.max(size.y_m))?;
        let stops = curve.places(Position { z_m, ..bounds.center() }, surroundings.start);
        let itinerary = Itinerary::through(stops.map(|place| (place, Then::Listen)), surroundings)?;
        Ok(Self { itinerary })
    }
}

impl Controller for Hilbert {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.itinerary.decide(situation)
    }

    fn left_out(&self) -> StopsLeftOut {
        self.itinerary.left_out()
    }
}

/// A Hilbert curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Curve {
    order: u32,
    cell_m: f64,
}

impl Curve {
    /// The curve over a square of `side_m`.
    fn new(config: &HilbertConfig, side_m: f64) -> Result<Self, SettingError> {
        match (config.order, config.spacing_m) {
            (Some(order), None) if (1..=MAX_ORDER).contains(&order) => {
                Ok(Self { order, cell_m: side_m / f64::from(1_u32 << order) })
            }
            (Some(order), None) => Err(SettingError::new("order", order, format!("1 to {MAX_ORDER}"))),
            (None, Some(spacing_m)) => {
                let cell_m = SettingError::positive("spacing_m", spacing_m)?;
                let covers = |order: &u32| f64::from(1_u32 << *order) * cell_m >= side_m * (1.0 - ROUNDING);
                let order = (1..=MAX_ORDER).find(covers).ok_or_else(|| {
                    let least_m = side_m / f64::from(1_u32 << MAX_ORDER);
                    SettingError::new("spacing_m", spacing_m, format!("at least {least_m} for this region"))
                })?;
                Ok(Self { order, cell_m })
            }
            (Some(_), Some(_)) => Err(SettingError::conflict("spacing_m", "`order`", "set one of them")),
            (None, None) => Err(SettingError::missing("order", "`order` or `spacing_m`")),
        }
    }

    /// The middles of the cells of the curve round `center`, from the corner nearest to `start`.
    fn places(self, center: Position, start: Position) -> impl Iterator<Item = Position> {
        // Before mirroring, the curve begins in the corner of lowest x and y.
        let [east, north] =
            [start.x_m - center.x_m, start.y_m - center.y_m].map(|ahead_m| if ahead_m > 0.0 { -1.0 } else { 1.0 });
        let half = 0.5 * (f64::from(1_u32 << self.order) - 1.0);
        (0..1_u32 << (2 * self.order)).map(move |index| {
            let [x, y] = cell(self.order, index).map(|cell| (f64::from(cell) - half) * self.cell_m);
            center + Position::new(east * x, north * y, 0.0)
        })
    }
}

/// The cell that a curve of the given order visits at `index`. The curve begins in cell (0, 0) and ends in the cell
/// of highest x and lowest y. It consists of four curves of the next lower order: the first is transposed, the last
/// is transposed and rotated by 180°.
fn cell(order: u32, index: u32) -> [u32; 2] {
    let [mut x, mut y] = [0, 0];
    for level in 0..order {
        let side = 1 << level;
        let quarter = (index >> (2 * level)) & 3;
        [x, y] = match quarter {
            0 => [y, x],
            1 => [x, y + side],
            2 => [x + side, y + side],
            _ => [2 * side - 1 - y, side - 1 - x],
        };
    }
    [x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The curve by rewriting rules: A becomes +BF-AFA-FB+, B becomes -AF+BFB+FA- (F a step, + a turn to the left).
    fn rewritten(order: u32) -> Vec<[i32; 2]> {
        let mut text = String::from("A");
        for _ in 0..order {
            let rule = |letter: char| match letter {
                'A' => "+BF-AFA-FB+".to_owned(),
                'B' => "-AF+BFB+FA-".to_owned(),
                other => other.to_string(),
            };
            text = text.chars().map(rule).collect();
        }
        let (mut place, mut heading) = ([0, 0], [1, 0]);
        let mut places = vec![place];
        for letter in text.chars() {
            match letter {
                'F' => {
                    place = [place[0] + heading[0], place[1] + heading[1]];
                    places.push(place);
                }
                '+' => heading = [-heading[1], heading[0]],
                '-' => heading = [heading[1], -heading[0]],
                _ => {}
            }
        }
        places
    }

    #[test]
    fn the_curve_is_that_of_its_rewriting_rules() {
        for order in 1..=6 {
            let cells: Vec<_> = (0..1 << (2 * order)).map(|index| cell(order, index).map(u32::cast_signed)).collect();
            assert_eq!(cells, rewritten(order), "order {order}");
        }
    }

    #[test]
    fn the_least_order_that_covers_is_taken() {
        let region = RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(1.0, 1.0, 0.0) };
        for (side_m, spacing_m, order) in [(10.0, 1.0, 4), (8.0, 1.0, 3), (8.1, 1.0, 4), (0.3, 0.1, 2), (1.0, 5.0, 1)]
        {
            let config =
                HilbertConfig { region: region.clone(), order: None, spacing_m: Some(spacing_m), height_m: None };
            assert_eq!(Curve::new(&config, side_m), Ok(Curve { order, cell_m: spacing_m }));
        }
    }
}
