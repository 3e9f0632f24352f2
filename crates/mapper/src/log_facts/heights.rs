//! The heights at which nodes are searched for.

use sextant_channel::Stop;
use sextant_kernel::SettingError;

/// If the heights of the stops differ by at most this share of the radio range, they do not determine the heights of
/// nodes: a node above the stops and its mirror image below them are about equally far from each stop. Such small
/// differences come from an uneven floor.
const UNEVEN: f64 = 0.05;

/// The same where the radio range is estimated from the log: the stops are level if their heights differ by at most
/// this share of their spread in the plane. Of the stops, those that hear one node count, which are within twice the
/// reach of each other.
const NEARLY_LEVEL: f64 = 0.1;

/// The heights at which the nodes of a map were searched for, and the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoughtHeights {
    /// The lowest height (m).
    pub low_m: f64,
    /// The highest height (m). Equal to the lowest for a map in a plane.
    pub high_m: f64,
    /// The reason for these heights.
    pub reason: HeightReason,
}

/// The reason why nodes were searched for at these heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeightReason {
    /// The settings say so.
    Settings,
    /// All stops have this height.
    LevelStops,
    /// The heights of the stops differ so little that they do not determine the heights of nodes. The map is in the
    /// plane of the median of the stops; the link model places a node that was heard on another floor there. Holds the
    /// difference between the lowest and the highest stop (m).
    UnevenStops(f64),
    /// From one radio range below the lowest stop to one radio range above the highest; for a log whose radio range is
    /// not known, one reach as seen in the log.
    Reach,
}

impl SoughtHeights {
    /// The heights of `z_range_m`, if given. Otherwise the height of the stops if they are level; if not, from
    /// `reach_m` below the lowest stop to `reach_m` above the highest. `None` without stops.
    pub(crate) fn of(stops: &[Stop], z_range_m: Option<[f64; 2]>, reach_m: f64) -> Option<Self> {
        Self::with(stops, z_range_m, reach_m, UNEVEN * reach_m)
    }

    /// The same for a log whose radio range is not known. Nodes are heard over about `reach_m`, and `step_m` is the step
    /// of the grid. The stops are level if their heights differ by at most a grid step, or by at most a tenth of their
    /// spread in the plane.
    pub(crate) fn of_log(stops: &[Stop], z_range_m: Option<[f64; 2]>, reach_m: f64, step_m: f64) -> Option<Self> {
        Self::with(stops, z_range_m, reach_m, unevenness_m(stops, reach_m, step_m))
    }

    /// Stops whose heights differ by at most `level_m` are level.
    fn with(stops: &[Stop], z_range_m: Option<[f64; 2]>, reach_m: f64, level_m: f64) -> Option<Self> {
        let [lowest, highest] = extremes(stops, 2)?;
        if let Some([low_m, high_m]) = z_range_m {
            return Some(Self { low_m, high_m, reason: HeightReason::Settings });
        }
        // A few stops on another floor do not lift the plane of all others.
        let middle = median_m(stops);
        let span_m = highest - lowest;
        Some(if span_m <= 0.0 {
            Self { low_m: lowest, high_m: lowest, reason: HeightReason::LevelStops }
        } else if span_m <= level_m {
            Self { low_m: middle, high_m: middle, reason: HeightReason::UnevenStops(span_m) }
        } else {
            Self { low_m: lowest - reach_m, high_m: highest + reach_m, reason: HeightReason::Reach }
        })
    }

    /// These heights in the form that searches use.
    pub(crate) fn heights(self) -> Heights {
        if self.high_m > self.low_m { Heights::Between(self.low_m, self.high_m) } else { Heights::Level(self.low_m) }
    }
}

/// Where nodes may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Heights {
    /// All at one height (m).
    Level(f64),
    /// Anywhere between two heights (m), which may be infinite.
    Between(f64, f64),
}

impl Heights {
    #[cfg(feature = "obstacles")]
    /// The allowed height nearest to `z_m` (m).
    pub(crate) fn clamp(self, z_m: f64) -> f64 {
        match self {
            Self::Level(level_m) => level_m,
            Self::Between(low, high) => z_m.clamp(low, high),
        }
    }
}

/// Checks the setting `z_range_m`, if there is one.
///
/// # Errors
/// If it is not two finite heights, the lower one first.
pub(crate) fn check_z_range(z_range_m: Option<[f64; 2]>) -> Result<(), SettingError> {
    match z_range_m {
        Some([low, high]) if !(low.is_finite() && high.is_finite() && low <= high) => {
            let allowed = "two finite heights, the lower one first";
            Err(SettingError::new("z_range_m", format!("[{low}, {high}]"), allowed))
        }
        _ => Ok(()),
    }
}

/// The median height of the stops (m). There must be at least one.
fn median_m(stops: &[Stop]) -> f64 {
    let mut heights: Vec<f64> = stops.iter().map(|stop| stop.position.z_m).collect();
    crate::numerics::median(&mut heights)
}

/// Whether the heights of the stops of a log differ too little to determine the heights of nodes that are heard over
/// about `reach_m`, on a grid of `step_m`.
pub(crate) fn are_level(stops: &[Stop], reach_m: f64, step_m: f64) -> bool {
    extremes(stops, 2).is_none_or(|[lowest, highest]| highest - lowest <= unevenness_m(stops, reach_m, step_m))
}

/// Differences of height up to this do not determine the heights of nodes (m).
fn unevenness_m(stops: &[Stop], reach_m: f64, step_m: f64) -> f64 {
    let extent_m = |axis| extremes(stops, axis).map_or(0.0, |[low, high]| high - low);
    let spread_m = libm::hypot(extent_m(0), extent_m(1)).min(2.0 * reach_m);
    step_m.max(UNEVEN * reach_m).max(NEARLY_LEVEL * spread_m)
}

/// The lowest and the highest coordinate of the stops along an axis (m); `None` if there are no stops.
fn extremes(stops: &[Stop], axis: usize) -> Option<[f64; 2]> {
    let along = stops.iter().map(|stop| <[f64; 3]>::from(stop.position)[axis]);
    let extremes = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
    (!stops.is_empty()).then_some(extremes)
}
