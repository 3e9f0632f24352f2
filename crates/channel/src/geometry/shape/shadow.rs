//! Where something that moves along a straight way may come into sight from a place, or go out of it.

use super::cylinder::Cylinder;
use super::surface::Surface;
use super::triangle::Triangle;
use crate::geometry::position::Position;

/// A corner this near to the plane of a gaze lies in it (m).
const IN_PLANE_M: f64 = 1e-9;

/// A straight way from one place to another, seen from an eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gaze {
    pub(crate) eye: Position,
    pub(crate) from: Position,
    pub(crate) to: Position,
}

impl Gaze {
    /// The place where a share of the way is done.
    pub(crate) fn at(&self, share: f64) -> Position {
        self.from + (self.to - self.from) * share
    }

    /// Adds all shares of the way at which the sight may change because of `surface`, and maybe some more. The sight is
    /// cut by an edge of a triangle there, or the way enters or leaves the solid.
    pub(crate) fn changes_by_surface(&self, surface: &Surface, shares: &mut Vec<f64>) {
        let normal = self.normal();
        for corners in surface.corners() {
            self.crossing(corners, shares);
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                self.edge([corners[a], corners[b]], normal, shares);
            }
        }
        self.passing(shares);
    }

    /// The same for an upright cylinder: the sight may touch its side or one of its two rims.
    pub(crate) fn changes_by_cylinder(&self, cylinder: &Cylinder, shares: &mut Vec<f64>) {
        self.tangents(cylinder, shares);
        for height_m in [0.0, cylinder.height_m] {
            self.rim(cylinder, cylinder.base.z_m + height_m, shares);
        }
        self.entries(cylinder, shares);
        self.passing(shares);
    }

    /// Normal of the plane through the eye and the way; zero if they are on one line.
    fn normal(&self) -> Position {
        (self.from - self.eye).cross(self.to - self.eye)
    }

    /// The share at which the sight points along `towards`, which is in the plane of the gaze.
    fn share_towards(&self, towards: Position, normal: Position) -> f64 {
        let (start, step) = (self.from - self.eye, self.to - self.from);
        -start.cross(towards).dot(normal) / step.cross(towards).dot(normal)
    }

    /// Where the way passes the eye, if they are on one line.
    fn passing(&self, shares: &mut Vec<f64>) {
        let (start, step) = (self.from - self.eye, self.to - self.from);
        shares.push(-start.dot(step) / step.dot(step));
    }

    /// Where the sight is cut by an edge.
    fn edge(&self, [a, b]: [Position; 2], normal: Position, shares: &mut Vec<f64>) {
        let off = |p: Position| normal.dot(p - self.eye);
        let (off_a, off_b) = (off(a), off(b));
        let slack = IN_PLANE_M * normal.length_m();
        for (corner, off) in [(a, off_a), (b, off_b)] {
            if off.abs() <= slack {
                shares.push(self.share_towards(corner - self.eye, normal));
            }
        }
        if off_a * off_b < 0.0 {
            let cut = a + (b - a) * (off_a / (off_a - off_b));
            shares.push(self.share_towards(cut - self.eye, normal));
        }
    }

    /// Where the way crosses the plane of a triangle.
    fn crossing(&self, [a, b, c]: Triangle, shares: &mut Vec<f64>) {
        let normal = (b - a).cross(c - a);
        shares.push(normal.dot(a - self.from) / normal.dot(self.to - self.from));
    }

    /// Where the sight, seen from above, touches the circle of a cylinder.
    fn tangents(&self, cylinder: &Cylinder, shares: &mut Vec<f64>) {
        let (to_axis, start, step) = (cylinder.base - self.eye, self.from - self.eye, self.to - self.from);
        let square = to_axis.x_m * to_axis.x_m + to_axis.y_m * to_axis.y_m;
        let beside = square - cylinder.radius_m * cylinder.radius_m;
        if beside <= 0.0 {
            return;
        }
        for side in [-1.0, 1.0] {
            let (along, across) = (beside.sqrt(), side * cylinder.radius_m);
            let x_m = along * to_axis.x_m - across * to_axis.y_m;
            let y_m = along * to_axis.y_m + across * to_axis.x_m;
            let turn = |p: Position| p.x_m * y_m - p.y_m * x_m;
            shares.push(-turn(start) / turn(step));
        }
    }

    /// Where the sight is cut by the rim of a cylinder at a height.
    fn rim(&self, cylinder: &Cylinder, z_m: f64, shares: &mut Vec<f64>) {
        let normal = self.normal();
        let flat = libm::hypot(normal.x_m, normal.y_m);
        let center = Position { z_m, ..cylinder.base };
        // In the plane z = z_m, the plane of the gaze is a line.
        let off_m = normal.dot(center - self.eye) / flat;
        let half_m = (cylinder.radius_m * cylinder.radius_m - off_m * off_m).sqrt();
        if half_m.is_finite() {
            let across = Position::new(normal.x_m / flat, normal.y_m / flat, 0.0);
            let along = Position::new(-across.y_m, across.x_m, 0.0);
            for half_m in [-half_m, half_m] {
                let cut = center - across * off_m + along * half_m;
                shares.push(self.share_towards(cut - self.eye, normal));
            }
        }
    }

    /// Where the way goes through the side or the height of a face of a cylinder.
    fn entries(&self, cylinder: &Cylinder, shares: &mut Vec<f64>) {
        let (start, step) = (self.from - cylinder.base, self.to - self.from);
        let square = step.x_m * step.x_m + step.y_m * step.y_m;
        let along = start.x_m * step.x_m + start.y_m * step.y_m;
        let beyond = start.x_m * start.x_m + start.y_m * start.y_m - cylinder.radius_m * cylinder.radius_m;
        let root = (along * along - square * beyond).sqrt();
        shares.extend([(-along - root) / square, (-along + root) / square]);
        shares.extend([0.0, cylinder.height_m].map(|height_m| (height_m - start.z_m) / step.z_m));
    }
}
