//! Flat faces that reflect: images in them, and what they do to fields.

use crate::geometry::position::Position;
use crate::geometry::shape::{Face, Facet, Plane};
use crate::obstacles::field::ObstacleField;
use crate::obstacles::obstacle::Obstacle;
use crate::power::Db;
use crate::propagation::complex::Complex;
use crate::propagation::fresnel::Slab;
use crate::propagation::reflection::ReflectionLaw;

/// Carrier of materials in channels without one (GHz).
pub(crate) const DEFAULT_CARRIER_GHZ: f64 = 2.45;

impl ReflectionLaw {
    /// The faces that reflect among `obstacles` at a carrier.
    pub(crate) fn mirrors(&self, obstacles: &ObstacleField, carrier_ghz: f64) -> Vec<Mirror> {
        let mut mirrors = Vec::new();
        if let Some(z_m) = self.ground_z_m {
            let plane = Plane { normal: Position::new(0.0, 0.0, 1.0), offset_m: z_m };
            let slab = || {
                let permittivity = self.ground_material?.0.permittivity(carrier_ghz)?;
                Some(MirrorSurface::Slab(Slab { permittivity, thickness_m: f64::INFINITY }))
            };
            let surface = self.loss.map(MirrorSurface::Fixed).or_else(slab);
            mirrors.extend(surface.map(|surface| Mirror { plane, face: Face::Whole, surface }));
        }
        for obstacle in obstacles.obstacles().iter().filter(|obstacle| obstacle.is_solid()) {
            for facet in obstacle.shape().facets() {
                let Facet { plane, face, thickness_m } = facet;
                let surface = self.surface(obstacle, carrier_ghz, thickness_m);
                mirrors.extend(surface.map(|surface| Mirror { plane, face, surface }));
            }
        }
        mirrors
    }

    /// How a face of an obstacle reflects, if it does.
    fn surface(&self, obstacle: &Obstacle, carrier_ghz: f64, thickness_m: f64) -> Option<MirrorSurface> {
        let fixed = obstacle.reflection_loss().or(self.loss);
        let slab = || {
            let permittivity = obstacle.material()?.permittivity(carrier_ghz)?;
            Some(MirrorSurface::Slab(Slab { permittivity, thickness_m }))
        };
        fixed.map(MirrorSurface::Fixed).or_else(slab)
    }
}

/// A flat face that reflects on its outside.
#[derive(Clone, Debug)]
pub(crate) struct Mirror {
    plane: Plane,
    face: Face,
    pub(crate) surface: MirrorSurface,
}

/// How a face reflects.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MirrorSurface {
    /// With the same loss at all angles.
    Fixed(Db),
    /// As a slab.
    Slab(Slab),
}

impl Mirror {
    /// Unit vector out of the face.
    pub(crate) fn normal(&self) -> Position {
        self.plane.normal
    }

    /// The mirror image of a place in front of the face.
    pub(crate) fn image(&self, place: Position) -> Option<Position> {
        let height_m = self.plane.height_m(place);
        (height_m > 0.0).then(|| place - self.plane.normal * (2.0 * height_m))
    }

    /// Where the way from `a` to `b` meets the face, if there is one: on the straight line from the mirror image of `a`
    /// to `b`.
    pub(crate) fn bounce(&self, a: Position, b: Position) -> Option<Position> {
        let (above_a, above_b) = (self.plane.height_m(a), self.plane.height_m(b));
        if above_a <= 0.0 || above_b <= 0.0 {
            return None;
        }
        let (foot_a, foot_b) = (a - self.plane.normal * above_a, b - self.plane.normal * above_b);
        let share = above_a / (above_a + above_b);
        let place = foot_a + (foot_b - foot_a) * share;
        self.face.holds(place, self.plane.normal).then_some(place)
    }
}

/// An electric field: a complex vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field(pub(crate) [Complex; 3]);

impl Field {
    /// A field with this real direction.
    pub(crate) fn along(direction: Position) -> Self {
        Self(<[f64; 3]>::from(direction).map(Complex::real))
    }

    /// Its component along a unit vector.
    pub(crate) fn dot(&self, direction: Position) -> Complex {
        let direction: [f64; 3] = direction.into();
        let terms = self.0.iter().zip(direction).map(|(&part, unit)| part * Complex::real(unit));
        terms.fold(Complex::real(0.0), |sum, term| sum + term)
    }

    /// The sum of two components with their unit vectors.
    fn of(one: (Complex, Position), other: (Complex, Position)) -> Self {
        let (a, b): ([f64; 3], [f64; 3]) = (one.1.into(), other.1.into());
        Self([0, 1, 2].map(|axis| one.0 * Complex::real(a[axis]) + other.0 * Complex::real(b[axis])))
    }

    /// The field after a reflection that changes its direction like a conductor, with the same sign.
    pub(crate) fn mirrored(&self, normal: Position) -> Self {
        let along = self.dot(normal);
        let normal: [f64; 3] = normal.into();
        Self([0, 1, 2].map(|axis| self.0[axis] - along * Complex::real(2.0 * normal[axis])))
    }

    /// The field of a wave that travels along `incoming` after its reflection off a slab with this normal.
    pub(crate) fn reflected(&self, incoming: Position, normal: Position, slab: &Slab, carrier_ghz: f64) -> Self {
        let along = incoming.dot(normal);
        let outgoing = incoming - normal * (2.0 * along);
        let across = direction(Position::ORIGIN, normal.cross(incoming));
        // At normal incidence any plane is the plane of incidence.
        let across = if across.length_m() > 0.0 { across } else { perpendicular(normal) };
        let coefficients = slab.reflection(carrier_ghz, along.abs().min(1.0));
        let te = (coefficients.te * self.dot(across), across);
        let tm = (coefficients.tm * self.dot(across.cross(incoming)), across.cross(outgoing));
        Self::of(te, tm)
    }
}

/// A unit vector across another one.
fn perpendicular(unit: Position) -> Position {
    let axis = if unit.x_m.abs() < 0.8 { Position::new(1.0, 0.0, 0.0) } else { Position::new(0.0, 1.0, 0.0) };
    direction(Position::ORIGIN, unit.cross(axis))
}

/// The unit vector from `from` to `to`; zero if they are the same place.
pub(crate) fn direction(from: Position, to: Position) -> Position {
    let way = to - from;
    let length_m = way.length_m();
    if length_m > 0.0 { way * (1.0 / length_m) } else { way }
}
