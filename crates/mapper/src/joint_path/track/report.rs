//! The track of a tag, and what was learned with it.

use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::SimTime;

use crate::range_ml::RangeUnit;

/// Where a tag was at a time: with odometry the robot that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPose {
    /// When.
    pub time: SimTime,
    /// Where (m).
    pub position: Position,
    /// Covariance of x and y (m²). It holds errors of ranges that stay the same for a while, and a clock that is wrong by 0.15 s.
    pub covariance: [[f64; 2]; 2],
    /// Variance of its height (m²), if that is estimated.
    pub height_variance_m2: Option<f64>,
    /// Velocity along x and y (m/s).
    pub velocity_m_per_s: [f64; 2],
}

impl TrackPose {
    /// The standard deviation in the direction in which the place is known worst (m).
    #[must_use]
    pub fn spread_m(&self) -> f64 {
        let [[xx, xy], [_, yy]] = self.covariance;
        (0.5 * (xx + yy) + libm::hypot(0.5 * (xx - yy), xy)).sqrt()
    }
}

/// The track of a tag.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its poses, in the order of time.
    pub poses: Vec<TrackPose>,
    /// What was learned with it.
    pub fit: TrackFit,
    /// Receivers whose ranges fit the track clearly worse than those of the others.
    pub doubted: Vec<DoubtedReceiver>,
    /// Why the ranges do not fit: then the track is wrong.
    pub fault: Option<RangeFault>,
}

/// Why the ranges of a track do not fit.
#[derive(Clone, Debug, PartialEq)]
pub enum RangeFault {
    /// They fit clearly better in this unit than as metres.
    Unit(RangeUnit),
    /// They fit clearly better if the known places are in this unit.
    Places(PlaceUnit),
    /// They fit clearly better if all are too long by far more than devices are without a calibration.
    Offset {
        /// By how much (m).
        offset_m: f64,
    },
    /// They fit clearly better with two receivers in each other's place, by number: their names or their known places are exchanged. The
    /// pair that fits best, and others that fit about as well.
    Exchanged(Vec<[usize; 2]>),
    /// They are usually so far off that no device is, and none of these is why.
    Unexplained {
        /// By how much (m).
        usually_m: f64,
        /// The receivers without which the others agree much better, most first.
        receivers: Vec<usize>,
    },
}

/// A unit in which known places may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceUnit {
    /// Its name.
    pub name: &'static str,
    /// How many of it are a metre.
    pub of_metre: f64,
}

impl PlaceUnit {
    /// Those other than metres.
    pub(super) const OTHERS: [Self; 4] = [
        Self { name: "millimetres", of_metre: 1000.0 },
        Self { name: "centimetres", of_metre: 100.0 },
        Self { name: "feet", of_metre: 3.281 },
        Self { name: "kilometres", of_metre: 0.001 },
    ];
}

/// A receiver whose ranges fit a track clearly worse than those of the others: it is elsewhere, or they are not its ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubtedReceiver {
    /// Its number.
    pub receiver: usize,
    /// By how much its ranges are usually off (m).
    pub off_m: f64,
    /// By how much those of the usual receiver are (m).
    pub others_m: f64,
}

/// What was learned of ranges, strengths and motion with a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackFit {
    /// Number of ranges that were used: of those of one receiver in a quarter of a second, the median.
    pub ranges: usize,
    /// Number of strengths that were used, alike.
    pub strengths: usize,
    /// Ranges of which these are the medians.
    pub measured_ranges: usize,
    /// Strengths, alike.
    pub measured_strengths: usize,
    /// Whether most of the track is among the receivers, so that biases and scale are told.
    pub is_among_receivers: bool,
    /// Whether the receivers are on a line, and nothing says on which side of it the tag is: then the mirror image of the track is as
    /// good.
    pub may_be_mirrored: bool,
    /// The mean height of the tag (m).
    pub height_m: f64,
    /// How that is known.
    pub height: TrackHeight,
    /// Whether an estimated height is so far from those of the receivers that it rather stands for another error.
    pub is_height_doubtful: bool,
    /// The law of ranges, if there are any.
    pub of_ranges: Option<TrackRangeLaw>,
    /// The law of strengths, if there are any.
    pub of_strengths: Option<TrackStrengthLaw>,
    /// How it moved.
    pub motion: TrackMotion,
    /// Whether the search ended by itself, and tells most places better than that they are about the receivers.
    pub settled: bool,
}

/// How the height of a tag is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackHeight {
    /// It was given.
    Given,
    /// It is taken for that of the receivers, which are all on one level.
    OfReceivers,
    /// One for all times, which is estimated.
    Constant {
        /// Its standard deviation (m).
        deviation_m: f64,
    },
    /// It is estimated over time.
    Wandering,
}

/// What was learned of ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackRangeLaw {
    /// By how much all ranges are too long (m).
    pub bias_m: f64,
    /// The share by which all ranges are too long.
    pub scale: f64,
    /// The law of their errors.
    pub errors: RangeErrorLaw,
    /// How many independent ranges one is worth.
    pub worth: f64,
    /// Mean logarithm of the density of the errors (per m).
    pub log_density: f64,
}

impl TrackRangeLaw {
    /// Whether bias or scale is far beyond what devices have.
    #[must_use]
    pub fn is_beyond_prior(&self) -> bool {
        const FAR_M: f64 = 9.0;
        const FAR: f64 = 0.1;
        self.bias_m.abs() > FAR_M || self.scale.abs() > FAR
    }
}

/// What was learned of strengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackStrengthLaw {
    /// The strength at a metre (dBm).
    pub at_1_m_dbm: f64,
    /// The exponent of the path loss.
    pub exponent: f64,
    /// The width of the law of errors (dB).
    pub width_db: f64,
    /// How many independent strengths one is worth.
    pub worth: f64,
}

/// How a tag moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackMotion {
    /// Freely.
    Free {
        /// Power spectral density of its acceleration (m²/s³).
        acceleration: f64,
    },
    /// As odometry says, but for its errors.
    Driven {
        /// The share by which the way is longer than odometry has it.
        scale: f64,
        /// How much odometry's frame turns (rad/m).
        drift_rad_per_m: f64,
    },
}
