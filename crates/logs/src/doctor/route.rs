//! The path of a robot, with the direction in which it drives.

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::path::robot_path::Path;
use crate::place::distance::plane_m;
use crate::time::instant;

/// The direction at a pose is that from the last pose which is at least this far away (m): a robot that rests keeps it, and
/// places that scatter do not turn it.
const BACK_M: f64 = 0.3;

/// The path of a robot.
#[derive(Clone, Debug)]
pub(super) struct Route<'a> {
    pub(super) path: &'a Path,
    /// The direction in which the robot came to each pose, of length 1; 0 where it has not moved yet.
    headings: Vec<[f64; 2]>,
}

impl<'a> Route<'a> {
    pub(super) fn new(path: &'a Path) -> Self {
        let poses = path.poses();
        let mut back = 0;
        let mut last = [0.0; 2];
        let heading = |at: usize| {
            while back + 1 < at && plane_m(poses[back + 1].position, poses[at].position) >= BACK_M {
                back += 1;
            }
            let apart_m = plane_m(poses[back].position, poses[at].position);
            if apart_m >= BACK_M {
                let way = poses[at].position - poses[back].position;
                last = [way.x_m / apart_m, way.y_m / apart_m];
            }
            last
        };
        Self { path, headings: (0..poses.len()).map(heading).collect() }
    }

    /// Where the robot was `delay_s` before a time, and in which direction it drove; `None` outside of the path.
    pub(super) fn before(&self, time: SimTime, delay_s: f64) -> Option<(Position, [f64; 2])> {
        self.at(instant::shifted(time, -delay_s)?)
    }

    /// Where the robot was at a time, and in which direction it drove; `None` outside of the path.
    pub(super) fn at(&self, time: SimTime) -> Option<(Position, [f64; 2])> {
        let place = self.path.at(time)?;
        let after = self.path.poses().partition_point(|pose| pose.time < time);
        Some((place, self.headings[after.min(self.headings.len() - 1)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::robot_path::Pose;

    #[test]
    fn a_robot_that_rests_keeps_its_direction() {
        // East for two seconds, a rest that scatters by centimetres, then north.
        let places = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.02, 0.03], [1.98, 0.01], [2.0, 1.0], [2.0, 2.0]];
        let pose = |(second, [x, y]): (u64, [f64; 2])| Pose {
            time: SimTime::from_nanos(second * 1_000_000_000),
            position: Position::new(x, y, 0.0),
        };
        let path = Path::new((0..).zip(places).map(pose).collect()).unwrap();
        let route = Route::new(&path);
        let heading = |tenths: u64| route.at(SimTime::from_nanos(tenths * 100_000_000)).unwrap().1;
        assert_eq!([heading(0), heading(5), heading(20)], [[0.0; 2], [1.0, 0.0], [1.0, 0.0]]);
        let near = |[x, y]: [f64; 2], [to_x, to_y]: [f64; 2]| x * to_x + y * to_y > 0.99;
        assert!(near(heading(35), [1.0, 0.0]) && near(heading(60), [0.0, 1.0]), "{:?}", heading(35));
        assert_eq!(route.at(SimTime::from_nanos(61_000_000_000)), None);
    }
}
