//! Convex solids with flat faces.

use super::clip::{Clip, GRAZE_M};
use super::surface::Surface;
use crate::geometry::position::Position;

/// A plane: the places p with `normal · p = offset_m`; outside is where the unit normal points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) normal: Position,
    pub(crate) offset_m: f64,
}

impl Plane {
    /// Signed distance of `p` (m), positive outside.
    pub(crate) fn height_m(&self, p: Position) -> f64 {
        self.normal.dot(p) - self.offset_m
    }
}

/// A convex solid: all places behind all of its planes.
#[derive(Clone, Debug)]
pub(crate) struct Polytope {
    planes: Vec<Plane>,
    surface: Surface,
}

impl Polytope {
    /// The solid behind `planes`, whose surface is `surface`.
    pub(crate) fn new(planes: Vec<Plane>, surface: Surface) -> Self {
        Self { planes, surface }
    }

    /// The part of the line within `margin_m` of the solid: a clip by each plane.
    pub(crate) fn clip(&self, from: Position, to: Position, margin_m: f64) -> Clip {
        let mut clip = Clip::WHOLE;
        for plane in &self.planes {
            clip = clip.behind(plane.height_m(from) - margin_m, plane.height_m(to) - margin_m);
            if clip.share() <= 0.0 {
                return Clip::NONE;
            }
        }
        clip
    }

    pub(crate) fn contains(&self, p: Position) -> bool {
        self.planes.iter().all(|plane| plane.height_m(p) < -GRAZE_M)
    }

    pub(crate) fn distance_m(&self, p: Position) -> f64 {
        if self.planes.iter().all(|plane| plane.height_m(p) <= 0.0) { 0.0 } else { self.surface.distance_m(p) }
    }

    pub(crate) fn planes(&self) -> &[Plane] {
        &self.planes
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }
}
