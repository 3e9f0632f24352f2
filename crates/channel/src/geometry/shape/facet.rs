//! Flat faces and vertical edges of shapes: what waves are reflected off and bend round.

use std::collections::BTreeMap;

use super::clip::GRAZE_M;
use super::levels::LEVEL_M;
use super::polytope::Plane;
use super::surface::Surface;
use super::triangle::{self, Triangle};
use crate::geometry::position::Position;

/// A flat face of a solid.
#[derive(Clone, Debug)]
pub(crate) struct Facet {
    pub(crate) plane: Plane,
    pub(crate) face: Face,
    /// Depth of the solid behind it (m).
    pub(crate) thickness_m: f64,
}

/// Which part of a plane a face is.
#[derive(Clone, Debug)]
pub(crate) enum Face {
    /// All of it.
    Whole,
    /// What is behind these planes.
    Behind(Vec<Plane>),
    /// These triangles.
    Triangles(Vec<Triangle>),
}

/// A vertical edge at which two faces of a solid meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) bottom: Position,
    pub(crate) top: Position,
}

/// Planes are the same if their normals differ by less than this and their offsets by as many metres.
const SAME: f64 = 1e-9;

impl Edge {
    /// The place on the edge at a height, if the edge is so high: it has its lower end, and not its upper one.
    pub(crate) fn at(&self, z_m: f64) -> Option<Position> {
        let above_m = z_m + LEVEL_M;
        let is_on = above_m >= self.bottom.z_m && above_m <= self.top.z_m;
        is_on.then_some(Position { z_m, ..self.bottom })
    }
}

impl Face {
    /// Whether a place in the plane is on the face: as of a solid, its lower edge belongs to it, and its upper edge does not.
    pub(crate) fn holds(&self, place: Position, normal: Position) -> bool {
        let upwards = Position::new(0.0, 0.0, 1.0) - normal * normal.z_m;
        let place = place + upwards * LEVEL_M;
        match self {
            Self::Whole => true,
            Self::Behind(sides) => sides.iter().all(|side| side.height_m(place) <= 0.0),
            Self::Triangles(triangles) => triangles.iter().any(|&[a, b, c]| {
                // A nanometre outside still counts, so that no place is lost between two triangles.
                let turns = |from: Position, to: Position| {
                    let side = to - from;
                    normal.dot(side.cross(place - from)) >= -GRAZE_M * side.length_m()
                };
                turns(a, b) && turns(b, c) && turns(c, a)
            }),
        }
    }
}

/// The faces of a convex solid behind `planes`, whose corners are those of `surface`.
pub(super) fn of_planes(planes: &[Plane], surface: &Surface) -> Vec<Facet> {
    let facet = |(i, &plane): (usize, &Plane)| {
        let others = planes.iter().enumerate().filter(|&(j, _)| j != i).map(|(_, &plane)| plane);
        let depths_m = surface.vertices.iter().map(|&corner| -plane.height_m(corner));
        Facet { plane, face: Face::Behind(others.collect()), thickness_m: depths_m.fold(0.0, f64::max) }
    };
    planes.iter().enumerate().map(facet).collect()
}

/// The faces of a surface: triangles in one plane are one face. `depth_m` is the depth of the solid below a place on it, along a
/// unit vector.
pub(super) fn of_surface(surface: &Surface, depth_m: impl Fn(Position, Position) -> f64) -> Vec<Facet> {
    let mut facets: Vec<Facet> = Vec::new();
    for corners in surface.corners() {
        let normal = triangle::normal(corners);
        let area = normal.length_m();
        if area <= 0.0 {
            continue;
        }
        let normal = normal * (1.0 / area);
        let offset_m = normal.dot(corners[0]);
        let is_same = |facet: &&mut Facet| {
            facet.plane.normal.distance_m(normal) < SAME && (facet.plane.offset_m - offset_m).abs() < SAME
        };
        match facets.iter_mut().find(is_same) {
            Some(Facet { face: Face::Triangles(triangles), .. }) => triangles.push(corners),
            Some(_) | None => {
                let middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0);
                let thickness_m = depth_m(middle, normal * -1.0);
                let plane = Plane { normal, offset_m };
                facets.push(Facet { plane, face: Face::Triangles(vec![corners]), thickness_m });
            }
        }
    }
    facets
}

/// The vertical edges of a surface at which it bends outwards, from bottom to top.
pub(super) fn vertical_edges(surface: &Surface) -> Vec<Edge> {
    let mut sides: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (index, &[a, b, c]) in surface.triangles.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            sides.entry([from.min(to), from.max(to)]).or_default().push(index);
        }
    }
    let mut edges = Vec::new();
    for ([from, to], triangles) in sides {
        let &[one, other] = &triangles[..] else { continue };
        let (a, b) = (surface.vertices[from as usize], surface.vertices[to as usize]);
        let way = b - a;
        let is_vertical = libm::hypot(way.x_m, way.y_m) <= SAME * way.length_m();
        let normal = triangle::normal(surface.triangle(one));
        let far = surface.triangle(other).into_iter().map(|corner| normal.dot(corner - a)).fold(0.0, f64::min);
        // Behind the plane of the first triangle by more than rounding.
        let bends_outwards = far < -1e-6 * normal.length_m() * way.length_m();
        if is_vertical && bends_outwards {
            let (bottom, top) = if a.z_m < b.z_m { (a, b) } else { (b, a) };
            edges.push(Edge { bottom, top });
        }
    }
    edges
}
