//! Shapes of obstacles: containment, distance, and length of a line inside, all exact.

mod clip;
mod cuboid;
mod cylinder;
mod facet;
mod hull;
mod levels;
mod mesh;
mod obj;
mod polytope;
mod prism;
mod shadow;
mod surface;
mod sweep;
mod triangle;

use std::path::Path;

use sextant_kernel::{Files, SettingError};

pub use cuboid::BoxConfig;
pub use cylinder::CylinderConfig;
pub use hull::ConvexConfig;
pub use mesh::MeshConfig;
pub use prism::PrismConfig;

use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;
use crate::geometry::span::Span;
use clip::Clip;
use cuboid::Cuboid;
use cylinder::Cylinder;
pub(crate) use facet::{Edge, Face, Facet};
use levels::Levels;
pub(crate) use levels::{LEVEL_M, join_near};
use mesh::Mesh;
pub(crate) use polytope::Plane;
use polytope::Polytope;
pub(crate) use shadow::Gaze;
use sweep::ConvexSolid;
pub(crate) use sweep::Sweep;

/// The shape of an obstacle as written in a scenario. What is level with its floor is in it, and what is level with its
/// roof, or on one of its sides, is not: a wall that stands on the ground (from z = 0 up) blocks stations on the ground.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ShapeConfig {
    /// An upright box.
    Box(BoxConfig),
    /// An upright cylinder.
    Cylinder(CylinderConfig),
    /// An upright prism over a convex footprint.
    Prism(PrismConfig),
    /// The convex hull of points.
    Convex(ConvexConfig),
    /// A closed triangle mesh.
    Mesh(MeshConfig),
}

/// The shape of an obstacle: a solid with its floors, and without its other faces.
///
/// What lies in the boundary belongs to the solid exactly if what is just above is inside. So level faces that look down
/// belong to it, and side faces, slopes and roofs do not: a box that stands on the ground is crossed by a line on the
/// ground, and a line along a wall or on a roof is free. A place, or a line with both ends, within a millimetre of a level
/// face lies in it; at other faces a nanometre counts.
#[derive(Clone, Debug)]
pub struct Shape {
    form: Form,
    bounds: Bounds,
    levels: Levels,
    body: Option<ConvexSolid>,
}

#[derive(Clone, Debug)]
enum Form {
    Box(Cuboid),
    Cylinder(Cylinder),
    Polytope(Polytope),
    Mesh(Mesh),
}

impl Form {
    /// The part of a line within `margin_m`; nothing of a mesh, which is not convex.
    #[inline]
    fn clip(&self, from: Position, to: Position, margin_m: f64) -> Clip {
        match self {
            Self::Box(cuboid) => cuboid.clip(from, to, margin_m),
            Self::Cylinder(cylinder) => cylinder.clip(from, to, margin_m),
            Self::Polytope(polytope) => polytope.clip(from, to, margin_m),
            Self::Mesh(_) => Clip::NONE,
        }
    }
}

impl Shape {
    /// A place or a line this near to a level face lies in it (m).
    pub const LEVEL_M: f64 = LEVEL_M;

    /// The shape that `config` describes; its file paths are among `files`.
    ///
    /// # Errors
    /// If it has no volume, or a file cannot be read.
    pub fn read(config: ShapeConfig, files: &Files) -> Result<Self, SettingError> {
        let form = match config {
            ShapeConfig::Box(config) => config.try_into().map(Form::Box).map_err(|error| error.within("box")),
            ShapeConfig::Cylinder(config) => {
                config.try_into().map(Form::Cylinder).map_err(|error| error.within("cylinder"))
            }
            ShapeConfig::Prism(config) => {
                config.try_into().map(Form::Polytope).map_err(|error| error.within("prism"))
            }
            ShapeConfig::Convex(config) => {
                config.try_into().map(Form::Polytope).map_err(|error| error.within("convex"))
            }
            ShapeConfig::Mesh(config) => {
                Mesh::read(config, files).map(Form::Mesh).map_err(|error| error.within("mesh"))
            }
        }?;
        Ok(Self::of(form))
    }

    /// The shapes in a mesh file, one for each material, with its name in the file; keys are below the shape.
    pub(crate) fn read_parts(file: &Path, files: &Files) -> Result<Vec<(Option<String>, Self)>, SettingError> {
        let parts = Mesh::read_parts(file, files).map_err(|error| error.within("mesh"))?;
        Ok(parts.into_iter().map(|(material, mesh)| (material, Self::of(Form::Mesh(mesh)))).collect())
    }

    fn of(form: Form) -> Self {
        let bounds = match &form {
            Form::Cylinder(cylinder) => {
                let side = Position::new(cylinder.radius_m, cylinder.radius_m, 0.0);
                let top = Position::new(0.0, 0.0, cylinder.height_m);
                Some(Bounds { min: cylinder.base - side, max: cylinder.base + side + top })
            }
            Form::Box(cuboid) => cuboid.surface().bounds(),
            Form::Polytope(polytope) => polytope.surface().bounds(),
            Form::Mesh(mesh) => mesh.surface().bounds(),
        };
        let body = match &form {
            Form::Box(cuboid) => Some(ConvexSolid::cuboid(cuboid)),
            Form::Cylinder(cylinder) => Some(ConvexSolid::cylinder(cylinder)),
            Form::Polytope(polytope) => ConvexSolid::convex(polytope.surface()),
            Form::Mesh(_) => None,
        };
        let levels = match &form {
            Form::Box(cuboid) => Levels::of(&cuboid.surface()),
            Form::Cylinder(cylinder) => Levels::of(&cylinder.surface()),
            Form::Polytope(polytope) => Levels::of(polytope.surface()),
            Form::Mesh(mesh) => Levels::of(mesh.surface()),
        };
        Self { form, bounds: bounds.expect("a solid has corners"), levels, body }
    }

    /// The smallest box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Whether `p` is inside or on a floor.
    #[must_use]
    pub fn contains(&self, p: Position) -> bool {
        let [p] = self.levels.judged([p]);
        match &self.form {
            Form::Box(cuboid) => cuboid.contains(p),
            Form::Cylinder(cylinder) => cylinder.contains(p),
            Form::Polytope(polytope) => polytope.contains(p),
            Form::Mesh(mesh) => mesh.contains(p),
        }
    }

    /// Distance from `p` (m), 0 inside and on all faces.
    #[must_use]
    pub fn distance_m(&self, p: Position) -> f64 {
        match &self.form {
            Form::Box(cuboid) => cuboid.distance_m(p),
            Form::Cylinder(cylinder) => cylinder.distance_m(p),
            Form::Polytope(polytope) => polytope.distance_m(p),
            Form::Mesh(mesh) => mesh.distance_m(p),
        }
    }

    /// Length of the straight line from `from` to `to` inside (m). A line in a floor is inside. A line that only runs along
    /// another face, or touches an edge or a corner, is not.
    #[must_use]
    pub fn length_inside_m(&self, from: Position, to: Position) -> f64 {
        let [from, to] = self.levels.judged([from, to]);
        match &self.form {
            Form::Mesh(mesh) => mesh.length_inside_m(from, to),
            convex => convex.clip(from, to, 0.0).share() * from.distance_m(to),
        }
    }

    /// The parts of the straight line inside, each from its entry to its exit as distances from `from` (m), in order.
    pub(crate) fn spans(&self, from: Position, to: Position) -> Vec<[f64; 2]> {
        let [from, to] = self.levels.judged([from, to]);
        let length_m = from.distance_m(to);
        match &self.form {
            Form::Mesh(mesh) => mesh.spans(from, to),
            convex => {
                let ends = convex.clip(from, to, 0.0).ends();
                ends.map(|ends| ends.map(|share| share * length_m)).into_iter().collect()
            }
        }
    }

    /// How often the straight line, which is inside somewhere, passes through.
    pub(crate) fn passages(&self, from: Position, to: Position) -> usize {
        match &self.form {
            Form::Mesh(_) => self.spans(from, to).len(),
            Form::Box(_) | Form::Cylinder(_) | Form::Polytope(_) => 1,
        }
    }

    /// Whether the straight line may come within [`LEVEL_M`](Self::LEVEL_M) of it.
    pub(crate) fn is_near(&self, from: Position, to: Position) -> bool {
        let [from, to] = self.levels.judged([from, to]);
        match &self.form {
            Form::Mesh(mesh) => mesh.near(Span::new(from, to), LEVEL_M).next().is_some(),
            convex => convex.clip(from, to, LEVEL_M).share() > 0.0,
        }
    }

    /// Its surface for drawing: vertices (m), and triangles whose corners run counterclockwise seen from outside.
    /// A cylinder is drawn with 48 sides.
    #[must_use]
    pub fn mesh(&self) -> (Vec<Position>, Vec<[u32; 3]>) {
        let surface = match &self.form {
            Form::Box(cuboid) => cuboid.surface(),
            Form::Cylinder(cylinder) => cylinder.surface(),
            Form::Polytope(polytope) => polytope.surface().clone(),
            Form::Mesh(mesh) => mesh.surface().clone(),
        };
        (surface.vertices, surface.triangles)
    }

    /// Adds all shares of the way of a gaze at which this shape may begin or end to hide it, and maybe some more.
    pub(crate) fn sight_changes(&self, gaze: &Gaze, shares: &mut Vec<f64>) {
        let [eye, from, to] = self.levels.judged([gaze.eye, gaze.from, gaze.to]);
        let gaze = Gaze { eye, from, to };
        match &self.form {
            Form::Box(cuboid) => gaze.changes_by_surface(&cuboid.surface(), shares),
            Form::Polytope(polytope) => gaze.changes_by_surface(polytope.surface(), shares),
            Form::Mesh(mesh) => gaze.changes_by_surface(mesh.surface(), shares),
            Form::Cylinder(cylinder) => gaze.changes_by_cylinder(cylinder, shares),
        }
    }

    /// Its flat faces; none of a cylinder.
    pub(crate) fn facets(&self) -> Vec<Facet> {
        match &self.form {
            Form::Box(cuboid) => facet::of_planes(&cuboid.planes(), &cuboid.surface()),
            Form::Polytope(polytope) => facet::of_planes(polytope.planes(), polytope.surface()),
            Form::Mesh(mesh) => facet::of_surface(mesh.surface(), |place, inwards| mesh.depth_m(place, inwards)),
            Form::Cylinder(_) => Vec::new(),
        }
    }

    /// Its vertical edges; none of a cylinder.
    pub(crate) fn vertical_edges(&self) -> Vec<Edge> {
        match &self.form {
            Form::Box(cuboid) => facet::vertical_edges(&cuboid.surface()),
            Form::Polytope(polytope) => facet::vertical_edges(polytope.surface()),
            Form::Mesh(mesh) => facet::vertical_edges(mesh.surface()),
            Form::Cylinder(_) => Vec::new(),
        }
    }

    /// How far the ball of `sweep` travels before it touches the shape (m); `None` if it does not within range.
    pub(crate) fn touch_m(&self, sweep: &Sweep) -> Option<f64> {
        let [from, _] = self.levels.judged([sweep.from, sweep.at(sweep.range_m)]);
        let sweep = &Sweep { from, ..*sweep };
        if let Form::Mesh(mesh) = &self.form {
            if mesh.contains(sweep.from) {
                return Some(0.0);
            }
            let span = Span::new(sweep.from, sweep.at(sweep.range_m));
            let touches = mesh.near(span, sweep.radius_m);
            return touches
                .filter_map(|corners| sweep.touch_m(None, |p| triangle::distance_m(corners, p)))
                .min_by(f64::total_cmp);
        }
        let cast = self.body.as_ref().and_then(|body| body.cast(sweep));
        sweep.touch_m(cast, |p| self.distance_m(p))
    }
}

/// Smallest extent of a solid (m); a smaller one is treated as a mistake in the scenario.
const LEAST_SIZE_M: f64 = 1e-6;

/// `size_m` if it is a valid extent.
fn size(size_m: f64) -> Option<f64> {
    (size_m.is_finite() && size_m >= LEAST_SIZE_M).then_some(size_m)
}

/// The extent under `key`, checked.
fn thickness(key: &str, size_m: f64) -> Result<f64, SettingError> {
    size(size_m).ok_or_else(|| SettingError::new(key, size_m, format!("a finite number of {LEAST_SIZE_M} or more")))
}

/// The place under `key`, checked.
fn place(key: &str, p: Position) -> Result<Position, SettingError> {
    if p.is_finite() { Ok(p) } else { Err(SettingError::new(key, p, "finite coordinates")) }
}
