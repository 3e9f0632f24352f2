//! The silhouette of an obstacle, seen from one direction.

use std::collections::BTreeMap;

use sextant_channel::{Bounds, Position};
use sextant_mapper::convex_hull;
use sextant_recording::Solid;

use super::view::{Panel, View};
use crate::paint::palette::{OBSTACLE, OBSTACLE_RIM};
use crate::paint::picture::{Picture, Stroke};

/// The outline of an obstacle.
pub(crate) const RIM: Stroke = Stroke::new(OBSTACLE_RIM, 1.0);

type Corner = [f64; 2];

/// Draws the obstacles. Of a sheet that is seen from its flat side, such as the floor of a storey from above, the outline alone is drawn:
/// filled, it would hide what is behind it.
pub(crate) fn draw_solids(picture: &mut Picture, panel: &Panel, solids: &[Solid]) {
    let (sheets, others): (Vec<&Solid>, Vec<&Solid>) = solids.iter().partition(|solid| is_sheet(solid, panel.view));
    others.into_iter().for_each(|solid| Silhouette::of(solid, panel.view).draw(picture, panel));
    sheets.into_iter().for_each(|sheet| draw_rims(picture, panel, std::slice::from_ref(sheet), RIM));
}

/// Whether an obstacle is thin in the direction of the view, and large across it.
fn is_sheet(solid: &Solid, view: View) -> bool {
    /// The thickest sheet (m), and the share of its width.
    const THICKEST: (f64, f64) = (0.5, 0.3);
    let Some(bounds) = Bounds::of(solid.vertices.iter().copied()) else { return false };
    let Position { x_m, y_m, z_m } = bounds.max - bounds.min;
    let (thickness_m, across_m) = match view {
        View::Top => (z_m, x_m.min(y_m)),
        View::Side => (y_m, x_m),
    };
    thickness_m <= THICKEST.0.min(THICKEST.1 * across_m)
}

/// Draws the outlines of the obstacles within the frame.
pub(crate) fn draw_rims(picture: &mut Picture, panel: &Panel, solids: &[Solid], stroke: Stroke) {
    let at = |corner: &Corner| panel.axes.at(corner[0], corner[1]);
    for solid in solids {
        match Silhouette::of(solid, panel.view) {
            Silhouette::Convex(hull) => {
                let around: Vec<_> = hull.iter().chain(hull.first()).map(at).collect();
                picture.path_within(panel.axes.area, &around, stroke);
            }
            Silhouette::Pieces { rim, .. } => {
                rim.iter()
                    .for_each(|edge| picture.path_within(panel.axes.area, &[at(&edge[0]), at(&edge[1])], stroke));
            }
        }
    }
}

/// The area that an obstacle covers (m).
#[derive(Clone, Debug, PartialEq)]
enum Silhouette {
    /// The corners of a convex area, counterclockwise.
    Convex(Vec<Corner>),
    /// Triangles that cover the area, and the edges of its outline.
    Pieces { triangles: Vec<[Corner; 3]>, rim: Vec<[Corner; 2]> },
}

impl Silhouette {
    fn of(solid: &Solid, view: View) -> Self {
        let corners: Vec<Corner> = solid.vertices.iter().map(|&vertex| view.project(vertex).into()).collect();
        let triangles: Vec<[Corner; 3]> =
            solid.triangles.iter().map(|triangle| triangle.map(|i| corners[i as usize])).collect();
        let hull = convex_hull(corners.clone());
        // If the obstacle is convex, the area of the faces towards the viewer equals that of the hull.
        let facing: f64 = triangles.iter().map(|triangle| area(triangle).max(0.0)).sum();
        let whole: f64 = (1..hull.len().saturating_sub(1)).map(|i| area(&[hull[0], hull[i], hull[i + 1]])).sum();
        if (facing - whole).abs() <= 1e-6 * whole {
            return Self::Convex(hull);
        }
        // An edge is on the outline if only one of its two faces points towards the viewer.
        let mut faces: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for (indices, triangle) in solid.triangles.iter().zip(&triangles) {
            let [a, b, c] = *indices;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *faces.entry([from.min(to), from.max(to)]).or_default() += usize::from(area(triangle) > 0.0);
            }
        }
        let rim = faces.into_iter().filter(|(_, facing)| *facing == 1);
        let rim = rim.map(|(edge, _)| edge.map(|i| corners[i as usize])).collect();
        Self::Pieces { triangles, rim }
    }

    fn draw(&self, picture: &mut Picture, panel: &Panel) {
        let at = |corner: &Corner| panel.axes.at(corner[0], corner[1]);
        match self {
            Self::Convex(hull) => {
                picture.polygon(hull.iter().map(at).collect(), OBSTACLE);
                picture.path(hull.iter().chain(hull.first()).map(at).collect(), RIM);
            }
            Self::Pieces { triangles, rim } => {
                for triangle in triangles.iter().filter(|triangle| area(triangle).abs() > 0.0) {
                    picture.polygon(triangle.iter().map(at).collect(), OBSTACLE);
                    // Without this line, the background is visible between two triangles.
                    let around = triangle.iter().chain(&triangle[..1]).map(at).collect();
                    picture.path(around, Stroke::new(OBSTACLE, 1.0));
                }
                rim.iter().for_each(|[a, b]| picture.line(at(a), at(b), RIM));
            }
        }
    }
}

/// The area of a triangle, positive if it is counterclockwise.
fn area([a, b, c]: &[Corner; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::{Obstacle, Position};

    /// A prism of height 1 with the given footprint; `faces` are the triangles of the footprint.
    fn prism(footprint: &[[f64; 2]], faces: &[[u32; 3]]) -> Solid {
        let count = u32::try_from(footprint.len()).unwrap();
        let level = |z: f64| footprint.iter().map(move |&[x, y]| Position::new(x, y, z));
        let mut triangles: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|i| i + count)).collect();
        triangles.extend(faces.iter().map(|&[a, b, c]| [a, c, b]));
        for i in 0..count {
            let next = (i + 1) % count;
            triangles.extend([[i, next, next + count], [i, next + count, i + count]]);
        }
        Solid { name: String::new(), vertices: level(0.0).chain(level(1.0)).collect(), triangles }
    }

    #[test]
    fn the_silhouette_of_a_box_is_a_rectangle() {
        let config: sextant_channel::ObstacleConfig = serde_json::from_str(
            r#"{"absorption_per_m": 1.0, "shape": {"box": {"center_m": [1.0, 2.0, 0.0], "size_m": [2.0, 4.0, 6.0]}}}"#,
        )
        .unwrap();
        let solid = Solid::of(&Obstacle::try_from(config).unwrap(), 0);
        for (view, expected) in [
            (View::Top, [[0.0, 0.0], [2.0, 0.0], [2.0, 4.0], [0.0, 4.0]]),
            (View::Side, [[0.0, -3.0], [2.0, -3.0], [2.0, 3.0], [0.0, 3.0]]),
        ] {
            assert_eq!(Silhouette::of(&solid, view), Silhouette::Convex(expected.into()));
        }
    }

    #[test]
    fn the_outline_of_an_l_shaped_wall_has_six_sides() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let solid = prism(&corners, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        let Silhouette::Pieces { rim, .. } = Silhouette::of(&solid, View::Top) else {
            panic!("it is not convex");
        };
        let length: f64 = rim.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert_eq!(rim.len(), 6);
        assert!((length - 8.0).abs() < 1e-12, "{length}");
    }
}
