//! Level faces: to what a place or a line in the boundary of a solid belongs.

use super::surface::Surface;
use super::triangle;
use crate::geometry::position::Position;

/// A place or a line this near to a level face lies in it (m). It is more than the rounding of any coordinate in a
/// scenario or a mesh file, and less than anybody knows a height.
pub(crate) const LEVEL_M: f64 = 1e-3;

/// The share of the height of a solid that may be near to a level face: no place is near to two faces of a thin sheet.
const NEAR_SHARE: f64 = 0.25;

/// A face this upright is none that is level: the least vertical part of its unit normal.
const LEAST_RISE: f64 = 0.5;

/// The heights of the level faces of a solid.
///
/// What lies in the boundary of a solid belongs to it exactly if what is just above is inside: a solid has its floor,
/// and neither its side faces nor its roof. So a wall that stands on the ground blocks stations on the ground, stations
/// on a roof see each other, and a line in the common plane of two stacked solids is in the upper one alone.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    /// In ascending order.
    heights_m: Vec<f64>,
    /// How near a place is to a level face that it lies in, and how much higher it is judged.
    lift_m: f64,
}

impl Levels {
    /// The level faces of a surface.
    pub(crate) fn of(surface: &Surface) -> Self {
        let mut heights_m: Vec<f64> = surface
            .corners()
            .filter_map(|corners| {
                let normal = triangle::normal(corners);
                let [a, b, c] = corners.map(|corner| corner.z_m);
                let (low_m, high_m) = (a.min(b).min(c), a.max(b).max(c));
                let is_level = high_m - low_m <= LEVEL_M && normal.z_m.abs() > LEAST_RISE * normal.length_m();
                is_level.then(|| f64::midpoint(low_m, high_m))
            })
            .collect();
        heights_m.sort_unstable_by(f64::total_cmp);
        heights_m.dedup_by(|later, earlier| *later <= *earlier);
        let height_m = surface.bounds().map_or(0.0, |bounds| bounds.max.z_m - bounds.min.z_m);
        Self { heights_m, lift_m: LEVEL_M.min(NEAR_SHARE * height_m) }
    }

    /// Where places are judged: if all of them lie in one level face, just above it; otherwise where they are.
    #[inline]
    pub(crate) fn judged<const N: usize>(&self, places: [Position; N]) -> [Position; N] {
        let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for place in places {
            (low_m, high_m) = (low_m.min(place.z_m), high_m.max(place.z_m));
        }
        let (least_m, most_m) = (high_m - self.lift_m, low_m + self.lift_m);
        if least_m > most_m {
            return places;
        }
        let first = self.heights_m.partition_point(|&height_m| height_m < least_m);
        let is_in_face = self.heights_m.get(first).is_some_and(|&height_m| height_m <= most_m);
        if is_in_face { places.map(|place| place + Position::new(0.0, 0.0, self.lift_m)) } else { places }
    }
}

/// Sorts parts of a line (m), and joins those with a millimetre or less between them.
pub(crate) fn join_near(spans: &mut Vec<[f64; 2]>) {
    spans.sort_unstable_by(|one, other| one[0].total_cmp(&other[0]));
    spans.dedup_by(|later, earlier| {
        let is_near = later[0] - earlier[1] <= LEVEL_M;
        if is_near {
            earlier[1] = earlier[1].max(later[1]);
        }
        is_near
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(z_m: f64) -> Position {
        Position::new(3.0, -2.0, z_m)
    }

    /// A prism over a triangle from 1 m to a height.
    fn levels(top_m: f64) -> Levels {
        Levels::of(&Surface::prism(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]], 1.0, top_m))
    }

    #[test]
    fn places_in_one_level_face_are_judged_just_above_it() {
        let levels = levels(3.0);
        assert_eq!(levels.heights_m, [1.0, 3.0]);
        for z_m in [1.0, 1.0 - 1e-12, 0.9995, 1.0005, 3.0, 2.9995] {
            assert_eq!(levels.judged([at(z_m)]), [at(z_m + LEVEL_M)], "{z_m}");
            assert_eq!(levels.judged([at(z_m), at(z_m + 1e-9)])[1], at(z_m + 1e-9 + LEVEL_M), "{z_m}");
        }
        for z_m in [0.0, 0.9985, 1.0015, 2.0, 2.9985, 3.0015] {
            assert_eq!(levels.judged([at(z_m)]), [at(z_m)], "{z_m}");
        }
        // A line that leaves the face is where it is.
        assert_eq!(levels.judged([at(1.0), at(1.1)]), [at(1.0), at(1.1)]);
        assert_eq!(levels.judged([at(1.0), at(3.0)]), [at(1.0), at(3.0)]);
    }

    #[test]
    fn no_place_is_near_to_both_faces_of_a_thin_sheet() {
        let levels = levels(1.0004);
        assert_eq!(levels.judged([at(1.0002)]), [at(1.0002)]);
        let [floor, roof] = [levels.judged([at(1.0)]), levels.judged([at(1.0004)])].map(|[place]| place.z_m);
        assert!(floor > 1.0 && floor < 1.0004 && roof > 1.0004, "{floor} {roof}");
    }
}
