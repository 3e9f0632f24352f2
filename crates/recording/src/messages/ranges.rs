//! Ranges that robots measured.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;
use sextant_channel::{Mounting, Position, RangeSample};
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::descriptor::{self, Declaration};

/// A range that a robot measured.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct RangeMessage {
    /// Index of the stop at which it was measured, or of the last one before.
    #[prost(uint32, tag = "1")]
    pub(crate) stop: u32,
    /// When (ns of simulated time).
    #[prost(uint64, tag = "2")]
    pub(crate) time_ns: u64,
    /// Index of the node.
    #[prost(uint32, tag = "3")]
    pub(crate) node: u32,
    /// The distance that was measured (m).
    #[prost(double, tag = "4")]
    pub(crate) range_m: f64,
    /// Where the robot was by its own odometry, x (m).
    #[prost(double, tag = "5")]
    pub(crate) x_m: f64,
    /// Where it was, y (m).
    #[prost(double, tag = "6")]
    pub(crate) y_m: f64,
    /// Where it was, z (m).
    #[prost(double, tag = "7")]
    pub(crate) z_m: f64,
    /// How fast it drove, by axis (m/s).
    #[prost(double, tag = "8")]
    pub(crate) vx_m_per_s: f64,
    /// How fast, y (m/s).
    #[prost(double, tag = "9")]
    pub(crate) vy_m_per_s: f64,
    /// How fast, z (m/s).
    #[prost(double, tag = "10")]
    pub(crate) vz_m_per_s: f64,
}

impl RangeMessage {
    /// The range `sample`, which belongs to the stop with this number.
    pub(crate) fn new(stop: u32, sample: &RangeSample) -> Self {
        let &RangeSample { node, time, position, velocity, range_m, robot: _, mounting: _ } = sample;
        Self {
            stop,
            time_ns: time.as_nanos(),
            node: node.0,
            range_m,
            x_m: position.x_m,
            y_m: position.y_m,
            z_m: position.z_m,
            vx_m_per_s: velocity.x_m,
            vy_m_per_s: velocity.y_m,
            vz_m_per_s: velocity.z_m,
        }
    }

    /// The range, which was measured by `robot`.
    pub(crate) fn sample(&self, robot: RobotId) -> RangeSample {
        RangeSample {
            mounting: Mounting::default(),
            node: NodeId(self.node),
            robot,
            time: SimTime::from_nanos(self.time_ns),
            position: Position::new(self.x_m, self.y_m, self.z_m),
            velocity: Position::new(self.vx_m_per_s, self.vy_m_per_s, self.vz_m_per_s),
            range_m: self.range_m,
        }
    }
}

recorded! {
    "sextant_ranges.proto";
    RangeMessage = "Range": [
        "stop" = 1 Uint32, "time_ns" = 2 Uint64, "node" = 3 Uint32, "range_m" = 4 Double,
        "x_m" = 5 Double, "y_m" = 6 Double, "z_m" = 7 Double,
        "vx_m_per_s" = 8 Double, "vy_m_per_s" = 9 Double, "vz_m_per_s" = 10 Double,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_read_back_equal() {
        let sample = RangeSample {
            mounting: Mounting::default(),
            node: NodeId(7),
            robot: RobotId(2),
            time: SimTime::from_nanos(12_345),
            position: Position::new(1.5, -2.25, 0.1),
            velocity: Position::new(0.3, 0.0, -0.7),
            range_m: -0.02,
        };
        let message = RangeMessage::new(3, &sample);
        assert_eq!((message.stop, message.sample(RobotId(2))), (3, sample));
    }
}
