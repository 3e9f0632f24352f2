//! How far a ball travels before it touches a solid.

use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::{ShapeCastOptions, cast_shapes};
use parry3d_f64::shape::{Ball, ConvexPolyhedron, SharedShape};

use super::clip::GRAZE_M;
use super::cuboid::Cuboid;
use super::cylinder::Cylinder;
use super::surface::Surface;
use crate::geometry::glam::vector;
use crate::geometry::position::Position;

/// A convex solid in the form that the geometry library casts against.
#[derive(Clone)]
pub(crate) struct ConvexSolid {
    shape: SharedShape,
    pose: Pose,
}

impl std::fmt::Debug for ConvexSolid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ConvexSolid({:?})", self.shape.shape_type())
    }
}

impl ConvexSolid {
    pub(crate) fn cuboid(cuboid: &Cuboid) -> Self {
        let turn = Rotation::from_rotation_z(cuboid.yaw_rad);
        let half = cuboid.half;
        let pose = Pose::from_parts(vector(cuboid.center), turn);
        Self { shape: SharedShape::cuboid(half.x_m, half.y_m, half.z_m), pose }
    }

    pub(crate) fn cylinder(cylinder: &Cylinder) -> Self {
        // The library's cylinders stand along y.
        let upright = Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2);
        let half_m = cylinder.height_m * 0.5;
        let middle = cylinder.base + Position::new(0.0, 0.0, half_m);
        let pose = Pose::from_parts(vector(middle), upright);
        Self { shape: SharedShape::cylinder(half_m, cylinder.radius_m), pose }
    }

    /// `None` if the library finds the hull too flat.
    pub(crate) fn convex(surface: &Surface) -> Option<Self> {
        let points = surface.vertices.iter().map(|&p| vector(p)).collect();
        let polyhedron = ConvexPolyhedron::from_convex_mesh(points, &surface.triangles)?;
        Some(Self { shape: SharedShape::new(polyhedron), pose: Pose::IDENTITY })
    }

    /// Where a ball first touches the solid, according to the library.
    pub(crate) fn cast(&self, sweep: &Sweep) -> Option<f64> {
        let ball = Ball::new(sweep.radius_m);
        let start = Pose::from_translation(vector(sweep.from));
        let options = ShapeCastOptions::with_max_time_of_impact(sweep.range_m);
        let velocity = vector(sweep.direction);
        let hit = cast_shapes(&start, velocity, &ball, &self.pose, Vector::ZERO, &*self.shape, options);
        hit.ok().flatten().map(|hit| hit.time_of_impact)
    }
}

/// A ball that moves along a straight line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep {
    pub(crate) from: Position,
    /// Unit vector.
    pub(crate) direction: Position,
    pub(crate) range_m: f64,
    /// Above 0.
    pub(crate) radius_m: f64,
}

impl Sweep {
    /// Centre of the ball after `travel_m`.
    pub(crate) fn at(&self, travel_m: f64) -> Position {
        self.from + self.direction * travel_m
    }

    /// How far the ball travels before it touches a convex solid (m); `None` if it does not within range.
    ///
    /// `distance_m` is the exact distance of the solid from a place, 0 inside; `cast` is the result of an iterative
    /// cast. The gap between ball and solid is a convex function of the travel, because the solid is convex. So a
    /// cast that ends where the gap is zero and falling is the first touch, and is accepted. Any other result, a miss
    /// included, is replaced: the smallest gap is found by golden section (Kiefer 1953), the first touch by
    /// bisection. A ball that touches at the start may slide along the solid or leave it, but not go deeper; a ball
    /// with its centre inside does not move.
    pub(crate) fn touch_m(&self, cast: Option<f64>, distance_m: impl Fn(Position) -> f64) -> Option<f64> {
        let gap_m = |travel_m: f64| distance_m(self.at(travel_m)) - self.radius_m;
        let start_m = gap_m(0.0);
        if start_m <= -self.radius_m {
            return Some(0.0);
        }
        if start_m > self.range_m {
            return None;
        }
        let falling = |travel_m: f64| gap_m(travel_m + GRAZE_M * 1e3) < gap_m(travel_m) - GRAZE_M;
        if let Some(travel_m) = cast
            && start_m > 0.0
            && gap_m(travel_m).abs() <= GRAZE_M
            && falling(travel_m)
        {
            return Some(travel_m);
        }
        let nearest_m = least(gap_m, self.range_m);
        if gap_m(nearest_m) >= start_m.min(0.0) - GRAZE_M {
            return None;
        }
        if start_m <= 0.0 {
            return Some(0.0);
        }
        let (mut free_m, mut touching_m) = (0.0, nearest_m);
        while touching_m - free_m > 1e-12 * (1.0 + touching_m) {
            let middle_m = 0.5 * (free_m + touching_m);
            *(if gap_m(middle_m) > 0.0 { &mut free_m } else { &mut touching_m }) = middle_m;
        }
        Some(free_m)
    }
}

/// Where a convex function has its minimum on [0, end].
fn least(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (0.0, end);
    let (mut a, mut b) = (high - GOLDEN * high, GOLDEN * high);
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-10 * (1.0 + end) {
        if fa <= fb {
            (high, b, fb) = (b, a, fa);
            a = high - GOLDEN * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + GOLDEN * (high - low);
            fb = f(b);
        }
    }
    // The minimum may be at an end of the range.
    [0.0, 0.5 * (low + high), end].into_iter().min_by(|&x, &y| f(x).total_cmp(&f(y))).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shape::cuboid::BoxConfig;

    fn sweep(y_m: f64) -> Sweep {
        let direction = Position::new(1.0, 0.0, 0.0);
        Sweep { from: Position::new(0.0, y_m, 0.0), direction, range_m: 10.0, radius_m: 0.2 }
    }

    #[test]
    fn a_missing_or_wrong_cast_does_not_change_the_result() {
        let size_m = [2.0, 4.0, 3.0];
        let center_m = Position::new(5.0, 0.0, 0.0);
        let wall = Cuboid::try_from(BoxConfig { center_m, size_m, yaw_deg: 0.0 }).unwrap();
        for (y_m, expected_m) in [(0.0, Some(3.8)), (2.1, Some(4.0 - 0.03_f64.sqrt())), (2.3, None)] {
            let touch = |cast| sweep(y_m).touch_m(cast, |p| wall.distance_m(p));
            let library = ConvexSolid::cuboid(&wall).cast(&sweep(y_m));
            for cast in [library, None, Some(0.0), Some(3.0), Some(5.0), Some(6.2), Some(9.9), Some(f64::NAN)] {
                match (touch(cast), expected_m) {
                    (Some(found_m), Some(expected_m)) => {
                        let error_m: f64 = found_m - expected_m;
                        assert!(error_m.abs() < 1e-8, "{cast:?}: {found_m}, not {expected_m}");
                    }
                    (found_m, expected_m) => assert_eq!(found_m, expected_m, "{cast:?}"),
                }
            }
        }
    }

    #[test]
    fn the_minimum_of_a_convex_function_is_found_at_ends_and_kinks() {
        for at in [-3.0, 0.0, 1e-7, 2.75, 10.0, 12.0] {
            let kink: f64 = least(|x: f64| (x - at).abs(), 10.0);
            assert!((kink - at.clamp(0.0, 10.0)).abs() < 1e-8, "{kink}, not {at}");
        }
    }
}
