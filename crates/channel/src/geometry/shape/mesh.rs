//! Closed triangle meshes.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use sextant_kernel::{Files, SettingError};

use super::clip::GRAZE_M;
use super::levels::join_near;
use super::obj::{self, MaterialFaces};
use super::surface::Surface;
use super::triangle::{self, Meeting};
use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;
use crate::geometry::span::Span;
use crate::geometry::tree::Tree;

/// A closed triangle mesh, as written in a scenario: either a file, or vertices and triangles.
/// All triangles have the same orientation; those of a cavity have the opposite one. Where parts of the mesh overlap,
/// they count once.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeshConfig {
    /// A Wavefront .obj file in metres, z up. If the obstacle has no material, its faces are those of one obstacle for each
    /// material of the file (`usemtl`), each closed.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub file: Option<PathBuf>,
    /// Vertices (m).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub vertices_m: Option<Vec<Position>>,
    /// Corners of the triangles, as indices of vertices from 0.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub triangles: Option<Vec<[u32; 3]>>,
}

/// A solid bounded by a closed triangle mesh.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    surface: Surface,
    bounds: Bounds,
    tree: Tree,
}

impl Mesh {
    /// The solid that `config` describes; a file path is among `files`.
    pub(crate) fn read(config: MeshConfig, files: &Files) -> Result<Self, SettingError> {
        match (config.file, config.vertices_m, config.triangles) {
            (Some(file), None, None) => {
                let surface = obj::parse(&read_file(&file, files)?).map_err(|flaw| flawed(&file, files, &flaw))?;
                Self::new(surface, "file")
            }
            (None, Some(vertices), Some(triangles)) => Self::new(Surface { vertices, triangles }, "triangles"),
            (Some(_), _, _) => {
                let remedy = "set either `file`, or `vertices_m` and `triangles`";
                Err(SettingError::conflict("file", "`vertices_m` or `triangles`", remedy))
            }
            (None, None, _) => Err(SettingError::missing("vertices_m", "a list of places, or `file`")),
            (None, Some(_), None) => {
                Err(SettingError::missing("triangles", "a list of triangles, three vertex indices each"))
            }
        }
    }

    /// The solids in the file of `config`, one for each material, with its name in the file.
    pub(crate) fn read_parts(file: &Path, files: &Files) -> Result<Vec<(Option<String>, Self)>, SettingError> {
        let parts = obj::parts(&read_file(file, files)?).map_err(|flaw| flawed(file, files, &flaw))?;
        let solid = |MaterialFaces { material, surface }: MaterialFaces| {
            let mesh = Self::new(surface, "file").map_err(|error| match &material {
                Some(name) => {
                    let found = format!("{} in the faces of material `{name}`", error.found());
                    SettingError::new("file", found, error.allowed())
                }
                None => error,
            })?;
            Ok((material, mesh))
        };
        parts.into_iter().map(solid).collect()
    }

    /// The solid inside `surface`; errors name `key`.
    fn new(mut surface: Surface, key: &str) -> Result<Self, SettingError> {
        let error = |found: String| {
            SettingError::new(
                key,
                found,
                "a closed mesh: at each edge exactly two triangles meet, with the same orientation",
            )
        };
        if let Some(index) = surface.vertices.iter().position(|p| !p.is_finite()) {
            return Err(error(format!("a mesh with vertex {index} not finite")));
        }
        let count = surface.vertices.len();
        for (index, corners) in surface.triangles.iter().enumerate() {
            if let Some(vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                return Err(error(format!("a mesh whose triangle {index} names vertex {vertex} of {count}")));
            }
        }
        weld(&mut surface);
        let mut edges: BTreeMap<(u32, u32), i64> = BTreeMap::new();
        for &[a, b, c] in &surface.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        if let Some((&(a, b), _)) = edges.iter().find(|&(_, &balance)| balance != 0) {
            let (a, b) = (surface.vertices[a as usize], surface.vertices[b as usize]);
            return Err(error(format!("a mesh that is open or twisted at the edge from {a} to {b}")));
        }
        let (Some(bounds), true) = (surface.bounds(), surface.has_volume()) else {
            return Err(error(format!("a mesh with a volume of {} m³", surface.volume_m3().abs())));
        };
        if surface.volume_m3() < 0.0 {
            surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let tree = Tree::new(surface.corners().filter_map(Bounds::of));
        Ok(Self { surface, bounds, tree })
    }

    /// Length of the line inside (m): the sum over all crossings of the infinite line and the mesh, exits minus
    /// entries, each clipped to the line. If the line passes within a nanometre of an edge, or along a face,
    /// crossings might count twice or not at all. Then, for each piece between two crossings, its middle is tested
    /// instead. Where parts of the mesh overlap, they count once.
    pub(crate) fn length_inside_m(&self, from: Position, to: Position) -> f64 {
        let length_m = from.distance_m(to);
        if length_m <= 0.0 {
            return 0.0;
        }
        let u = (to - from) * (1.0 / length_m);
        let mut inside_m = 0.0;
        let mut crossings = Vec::new();
        for index in self.tree.along(self.chord(from, u), GRAZE_M) {
            match triangle::meet(self.surface.triangle(index), from, u) {
                Meeting::Miss => {}
                Meeting::Through { at_m, leaves } => {
                    crossings.push((at_m, leaves));
                    let at_m = at_m.clamp(0.0, length_m);
                    inside_m += if leaves { at_m } else { -at_m };
                }
                Meeting::Edge { .. } => return self.length_by_pieces_m(from, u, length_m),
            }
        }
        // A line that ends on a face is not inside.
        let whole_m = if inside_m > GRAZE_M { inside_m } else { 0.0 };
        if are_pairs(&mut crossings) { whole_m } else { self.length_by_pieces_m(from, u, length_m) }
    }

    /// The parts of the line inside, from entry to exit (m). Parts with less than a millimetre between them are one.
    pub(crate) fn spans(&self, from: Position, to: Position) -> Vec<[f64; 2]> {
        let length_m = from.distance_m(to);
        if self.length_inside_m(from, to) <= 0.0 {
            return Vec::new();
        }
        let u = (to - from) * (1.0 / length_m);
        let mut spans = self.pieces(from, u, length_m);
        join_near(&mut spans);
        spans
    }

    /// The part of the infinite line that can be near the mesh.
    fn chord(&self, from: Position, u: Position) -> Span {
        let nearest = from + u * (self.bounds.center() - from).dot(u);
        let reach_m = self.bounds.min.distance_m(self.bounds.max);
        Span::new(nearest - u * reach_m, nearest + u * reach_m)
    }

    fn length_by_pieces_m(&self, from: Position, u: Position, length_m: f64) -> f64 {
        self.pieces(from, u, length_m).iter().map(|[enter_m, leave_m]| leave_m - enter_m).sum()
    }

    /// The parts inside between two crossings (m), in order.
    fn pieces(&self, from: Position, u: Position, length_m: f64) -> Vec<[f64; 2]> {
        let mut cuts = vec![0.0, length_m];
        for index in self.tree.along(self.chord(from, u), GRAZE_M) {
            match triangle::meet(self.surface.triangle(index), from, u) {
                Meeting::Through { at_m, .. } | Meeting::Edge { at_m: Some(at_m) } => cuts.push(at_m),
                Meeting::Miss | Meeting::Edge { at_m: None } => {}
            }
        }
        cuts.retain(|at_m| (0.0..=length_m).contains(at_m));
        cuts.sort_by(f64::total_cmp);
        let pieces = cuts.windows(2).map(|pair| [pair[0], pair[1]]);
        pieces
            .filter(|[enter_m, leave_m]| leave_m - enter_m > GRAZE_M)
            .filter(|[enter_m, leave_m]| self.is_around(from + u * (0.5 * (enter_m + leave_m))))
            .collect()
    }

    /// Whether the mesh winds around `p`. A place on the surface is inside if all places around it are: where two parts touch.
    fn is_around(&self, p: Position) -> bool {
        /// Far enough from all faces through `p` for exact winding, in a direction along which no face is expected.
        const ASIDE_M: [f64; 3] = [0.36e-7, 0.48e-7, 0.8e-7];
        if self.distance_to_surface_m(p) > GRAZE_M {
            return self.winds_around(p);
        }
        let [x_m, y_m, z_m] = ASIDE_M;
        let signs = [-1.0, 1.0];
        let mut around =
            signs.into_iter().flat_map(|x| signs.into_iter().flat_map(move |y| signs.map(|z| [x, y, z])));
        around.all(|[x, y, z]| self.winds_around(p + Position::new(x * x_m, y * y_m, z * z_m)))
    }

    fn winds_around(&self, p: Position) -> bool {
        self.surface.corners().map(|corners| triangle::solid_angle(corners, p)).sum::<f64>() >= 0.5 * 4.0 * PI
    }

    fn distance_to_surface_m(&self, p: Position) -> f64 {
        self.tree.nearest_m(p, |index| triangle::distance_m(self.surface.triangle(index), p))
    }

    /// How far a line from a place on the surface runs inside, along a unit vector (m).
    pub(crate) fn depth_m(&self, from: Position, inwards: Position) -> f64 {
        let ends_m = self.tree.along(self.chord(from, inwards), GRAZE_M).filter_map(|index| {
            match triangle::meet(self.surface.triangle(index), from, inwards) {
                Meeting::Through { at_m, .. } | Meeting::Edge { at_m: Some(at_m) } => Some(at_m),
                Meeting::Miss | Meeting::Edge { at_m: None } => None,
            }
        });
        ends_m.filter(|&at_m| at_m > GRAZE_M).fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn contains(&self, p: Position) -> bool {
        self.bounds.contains(p) && self.is_around(p)
    }

    pub(crate) fn distance_m(&self, p: Position) -> f64 {
        if self.contains(p) { 0.0 } else { self.distance_to_surface_m(p) }
    }

    /// Triangles that a ball of `radius_m` may touch along `span`.
    pub(crate) fn near(&self, span: Span, radius_m: f64) -> impl Iterator<Item = triangle::Triangle> + '_ {
        self.tree.along(span, radius_m).map(|index| self.surface.triangle(index))
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }
}

/// The text of a mesh file.
fn read_file(file: &Path, files: &Files) -> Result<String, SettingError> {
    files.read_text(file).map_err(|cause| {
        let found = format!("`{}`, which cannot be read: {cause}", files.path(file).display());
        SettingError::new("file", found, "a readable .obj file")
    })
}

/// A mesh file has a flaw.
fn flawed(file: &Path, files: &Files, flaw: &str) -> SettingError {
    let found = format!("`{}`, {flaw}", files.path(file).display());
    files.discreet(file, SettingError::new("file", found, "a Wavefront .obj file"))
}

/// Whether the crossings, each with whether it leaves, are an entry and an exit in turn, so that no two parts overlap.
fn are_pairs(crossings: &mut [(f64, bool)]) -> bool {
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    crossings.len().is_multiple_of(2)
        && crossings.iter().zip([false, true].into_iter().cycle()).all(|(a, b)| a.1 == b)
}

/// Merges vertices at the same place, because many programs write separate vertices for each triangle, and removes
/// triangles that have one corner twice.
fn weld(surface: &mut Surface) {
    let mut first: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut vertices = Vec::new();
    let welded: Vec<u32> = surface
        .vertices
        .iter()
        .map(|&p| {
            // + 0.0 makes -0.0 and 0.0 equal.
            let key = <[f64; 3]>::from(p).map(|x| (x + 0.0).to_bits());
            *first.entry(key).or_insert_with(|| {
                vertices.push(p);
                u32::try_from(vertices.len() - 1).expect("no more vertices than indices")
            })
        })
        .collect();
    surface.vertices = vertices;
    for corners in &mut surface.triangles {
        *corners = corners.map(|vertex| welded[vertex as usize]);
    }
    surface.triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
}
