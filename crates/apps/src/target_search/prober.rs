//! How a robot moves that has to learn how its map lies.

use std::f64::consts::FRAC_PI_2;

use sextant_channel::Position;
use sextant_sim::Port;

/// Side of the square that it drives (m).
const SIDE_M: f64 = 6.0;
/// Share of the answers of one poll that the next one has at least, unless the robot leaves the network.
const FADING: f64 = 0.7;

/// Drives a robot round a square, so that its places on the map and by odometry tell how the two lie. Where too few nodes
/// answer, it goes back and takes the next side.
#[derive(Clone, Debug, Default)]
pub(super) struct Prober {
    /// Number of the side of the square, and the length driven on it (m).
    side: (u32, f64),
    /// The last place from which it drove on along the square, by odometry (m), and the number of answers there.
    good: Option<(Position, usize)>,
}

impl Prober {
    /// Where to drive next, by odometry (m), for a step of `length_m`. `answers` nodes answered here, at least `fewest` in
    /// a network.
    pub(super) fn next(&mut self, answers: usize, fewest: usize, length_m: f64, port: &Port<'_>) -> Position {
        let here = port.pose().position;
        if let Some((place, before)) = self.good
            && (answers < fewest || (answers as f64) < FADING * before as f64)
        {
            self.good = Some((place, answers));
            self.side = (self.side.0 + 1, 0.0);
            return place;
        }
        self.good = Some((here, answers));
        let (side, driven_m) = self.side;
        let heading_rad = FRAC_PI_2 * f64::from(side % 4);
        let driven_m = driven_m + length_m;
        self.side = if driven_m >= SIDE_M { (side + 1, 0.0) } else { (side, driven_m) };
        let direction = Position::new(libm::cos(heading_rad), libm::sin(heading_rad), 0.0);
        here + direction * port.clearance_m(direction, length_m)
    }
}
