//! Walls traced in a picture.

use sextant_channel::{ObstacleConfig, PrismConfig, ShapeConfig, WallConfig};
use sextant_kernel::text::counted;
use sextant_mapper::convex_hull;

use super::faces::{between_faces, meet_faces};
use super::graph::{WallLine, wall_lines};
use super::lines::{Cell, distance, simplified, squared};
use super::occupancy::{Mask, Occupancy};
use super::thinning::thinned;
use super::{FloorPlan, FloorPlanOptions, blobs, to_mm};

/// What is smaller in both directions is dirt (m).
const SPECK_M: f64 = 0.15;
/// The convex hull of a block is full by this share at least.
const FULL: f64 = 0.75;

/// The walls and blocks of a floor.
pub(super) fn plan(occupancy: &Occupancy, options: &FloorPlanOptions) -> FloorPlan {
    let mut plan = FloorPlan::default();
    let pixel_m = occupancy.pixel_m;
    let (columns, rows) = (occupancy.width as f64 * pixel_m, occupancy.height as f64 * pixel_m);
    plan.notes
        .push(format!("the plan is {columns:.1} by {rows:.1} m, {} by {} pixels", occupancy.width, occupancy.height));
    let mut mask = occupancy.mask();
    drop_specks(&mut mask, pixel_m, &mut plan.notes);
    let depths = mask.depths();
    let thick = blobs::thick(&mask, &depths, 0.5 * options.thickest_m / pixel_m);
    let mut walls = mask.clone();
    thick.members().for_each(|cell| walls.cells[cell] = false);
    let mut covered = mask.empty_like();
    for component in thick.components().into_iter().chain(pillars(&walls, &thick, options.thickest_m / pixel_m)) {
        component.iter().for_each(|&cell| walls.cells[cell] = false);
        add_block(&component, occupancy, options, &mut plan, &mut covered);
    }
    let depths = walls.depths();
    let mut short = 0;
    let mut lines = wall_lines(&walls, &thinned(&walls), &depths);
    lines.iter_mut().for_each(|wall| *wall = between_faces(&straightened(wall), &walls));
    meet_faces(&mut lines);
    for wall in lines {
        match made(&wall, occupancy, options) {
            Some((made, line)) => {
                cover(&mut covered, &line, wall.thickness);
                plan.walls.push(made);
            }
            None => short += 1,
        }
    }
    if short > 0 {
        plan.notes.push(format!("left out: {} shorter than thick", counted(short, "line")));
    }
    if plan.walls.is_empty() && plan.blocks.is_empty() {
        plan.notes.push(occupancy.rule.clone());
    }
    let dark = mask.members().count();
    let read = mask.members().filter(|&cell| covered.cells[cell]).count();
    let outside = covered.members().filter(|&cell| !mask.cells[cell]).count();
    if dark > 0 {
        let percent = |count: usize| 100.0 * count as f64 / dark as f64;
        plan.notes.push(format!(
            "walls and blocks cover {:.0} % of the dark area, and as much as {:.0} % of it beside it",
            percent(read),
            percent(outside)
        ));
    }
    plan
}

fn drop_specks(mask: &mut Mask, pixel_m: f64, notes: &mut Vec<String>) {
    let mut specks = 0;
    for component in mask.components() {
        let places = component.iter().map(|&cell| mask.place(cell));
        let (low, high) = places.fold(([f64::MAX; 2], [f64::MIN; 2]), |(low, high), place| {
            ([0, 1].map(|axis| low[axis].min(place[axis])), [0, 1].map(|axis| high[axis].max(place[axis])))
        });
        let size_m = [0, 1].map(|axis| (high[axis] - low[axis] + 1.0) * pixel_m);
        if size_m[0].max(size_m[1]) < SPECK_M.max(2.0 * pixel_m) {
            specks += 1;
            component.iter().for_each(|&cell| mask.cells[cell] = false);
        }
    }
    if specks > 0 {
        notes.push(format!("left out: {} smaller than {SPECK_M} m", counted(specks, "speck")));
    }
}

/// The parts that stand alone, are at most so long and wide (cells), and are not clearly longer than wide.
fn pillars(walls: &Mask, thick: &Mask, most: f64) -> Vec<Vec<usize>> {
    let is_pillar = |component: &Vec<usize>| {
        let size = |axis: usize| {
            let of = component.iter().map(|&cell| walls.place(cell)[axis]);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min) + 1.0
        };
        let (longer, shorter) = (size(0).max(size(1)), size(0).min(size(1)));
        let is_alone = !component.iter().any(|&cell| thick.neighbours(cell).next().is_some());
        is_alone && longer <= most && longer <= 2.0 * shorter
    };
    walls.components().into_iter().filter(is_pillar).collect()
}

/// Adds a thick part as a prism over its convex hull.
fn add_block(
    component: &[usize],
    occupancy: &Occupancy,
    options: &FloorPlanOptions,
    plan: &mut FloorPlan,
    covered: &mut Mask,
) {
    // The corners of the cells, so that the block is as large as they are.
    let corners = component.iter().flat_map(|&cell| {
        let [x, y] = covered.place(cell);
        [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[dx, dy]| [x + dx, y + dy])
    });
    let hull = convex_hull(corners.collect());
    let twice: f64 = (0..hull.len())
        .map(|at| {
            let (a, b) = (hull[at], hull[(at + 1) % hull.len()]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    let area_m2 = component.len() as f64 * occupancy.pixel_m * occupancy.pixel_m;
    let middle = component.iter().fold([0.0, 0.0], |sum, &cell| {
        let place = covered.place(cell);
        [sum[0] + place[0] / component.len() as f64, sum[1] + place[1] / component.len() as f64]
    });
    let [x_m, y_m] = occupancy.place_m(middle).map(to_mm);
    if component.len() as f64 / (0.5 * twice.abs()) < FULL {
        plan.notes.push(format!(
            "a dark area of {area_m2:.2} m² around ({x_m:.2}, {y_m:.2}) m is neither a wall nor convex, and is left out"
        ));
        return;
    }
    component.iter().for_each(|&cell| covered.cells[cell] = true);
    let mut ring = hull.clone();
    ring.push(hull[0]);
    let mut corners_m: Vec<[f64; 2]> =
        simplified(&ring, 0.5).into_iter().map(|place| occupancy.place_m(place).map(to_mm)).collect();
    corners_m.pop();
    plan.blocks.push(ObstacleConfig {
        name: Some(format!("block {}", plan.blocks.len())),
        ..ObstacleConfig::of(
            ShapeConfig::Prism(PrismConfig { corners_m, bottom_m: 0.0, height_m: options.height_m }),
            options.material.clone(),
        )
    });
}

/// The wall with few corners, and what is nearly along an axis along it.
fn straightened(wall: &WallLine) -> WallLine {
    let tolerance = (0.6 * wall.thickness).max(1.0);
    let mut line = squared(simplified(&wall.line, tolerance), tolerance.max(1.5));
    line.dedup_by(|a, b| distance(*a, *b) <= 0.0);
    WallLine { line, ..wall.clone() }
}

/// A wall along a line, and the line that it has in cells; `None` if it is shorter than thick.
fn made(wall: &WallLine, occupancy: &Occupancy, options: &FloorPlanOptions) -> Option<(WallConfig, Vec<Cell>)> {
    let mut line = wall.line.clone();
    let length: f64 = line.windows(2).map(|leg| distance(leg[0], leg[1])).sum();
    if line.len() < 2 || length < wall.thickness {
        return None;
    }
    loop {
        let points_m = line.iter().map(|&place| occupancy.place_m(place).map(to_mm)).collect();
        let thickness_m = to_mm(wall.thickness * occupancy.pixel_m).max(0.001);
        let config = WallConfig { thickness_m, ..options.wall(points_m) };
        if config.obstacles(0).is_ok() {
            return Some((config, line));
        }
        // A part is too short for its thickness: one corner fewer.
        let shortest = (1..line.len())
            .min_by(|&a, &b| distance(line[a - 1], line[a]).total_cmp(&distance(line[b - 1], line[b])))?;
        let removed = if shortest + 1 < line.len() { shortest } else { shortest - 1 };
        if line.len() <= 2 || removed == 0 {
            return None;
        }
        line.remove(removed);
    }
}

/// Marks the cells of a wall.
fn cover(covered: &mut Mask, line: &[Cell], thickness: f64) {
    let reach = 0.5 * thickness + 0.01;
    for leg in line.windows(2) {
        let length = distance(leg[0], leg[1]);
        let way = [0, 1].map(|axis| (leg[1][axis] - leg[0][axis]) / length.max(1e-9));
        let range = |axis: usize, size: usize| {
            let (low, high) = (leg[0][axis].min(leg[1][axis]) - reach, leg[0][axis].max(leg[1][axis]) + reach);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
            let (low, high) = (low.max(0.0).floor() as usize, high.max(0.0).ceil() as usize);
            low.min(size)..(high + 1).min(size)
        };
        for row in range(1, covered.height) {
            for column in range(0, covered.width) {
                let from = [column as f64 - leg[0][0], row as f64 - leg[0][1]];
                let along = from[0] * way[0] + from[1] * way[1];
                let across = from[1] * way[0] - from[0] * way[1];
                if (-reach..=length + reach).contains(&along) && across.abs() <= reach {
                    covered.cells[row * covered.width + column] = true;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor of cells of 5 cm with rectangles of walls: column, row, width, height in cells.
    fn floor(width: usize, height: usize, rectangles: &[[usize; 4]]) -> Occupancy {
        let mut cells = vec![false; width * height];
        for &[column, row, wide, high] in rectangles {
            for y in row..row + high {
                cells[y * width + column..y * width + column + wide].fill(true);
            }
        }
        Occupancy { width, height, cells, rule: String::new(), pixel_m: 0.05, origin_m: [0.0, 0.0], turn_rad: 0.0 }
    }

    fn read(occupancy: &Occupancy) -> FloorPlan {
        plan(occupancy, &FloorPlanOptions::default())
    }

    #[test]
    fn a_room_with_a_door_is_one_line_round_it() {
        // 6 by 4 m outside, walls of 0.2 m, a door of 0.9 m in the wall below.
        let room =
            floor(140, 100, &[[10, 10, 120, 4], [10, 86, 50, 4], [78, 86, 52, 4], [10, 10, 4, 80], [126, 10, 4, 80]]);
        let plan = read(&room);
        assert_eq!((plan.walls.len(), plan.blocks.len()), (1, 0), "{:?}", plan.walls);
        let wall = &plan.walls[0];
        assert!((wall.thickness_m - 0.2).abs() < 0.02, "{}", wall.thickness_m);
        assert_eq!(wall.points_m.len(), 6, "{:?}", wall.points_m);
        // The middle of the walls: 0.6 to 6.4 and 0.6 to 4.4 m; the door from 3.0 to 3.9 m.
        let expected = [[3.0, 0.6], [0.6, 0.6], [0.6, 4.4], [6.4, 4.4], [6.4, 0.6], [3.9, 0.6]];
        let is_near = |points: &[[f64; 2]]| {
            points.iter().zip(expected).all(|(a, b)| libm::hypot(a[0] - b[0], a[1] - b[1]) < 0.09)
        };
        let reversed: Vec<_> = wall.points_m.iter().rev().copied().collect();
        assert!(is_near(&wall.points_m) || is_near(&reversed), "{:?}", wall.points_m);
        assert!(
            plan.notes.iter().any(|note| note.contains("cover 9") || note.contains("cover 100")),
            "{:?}",
            plan.notes
        );
    }

    /// The picture seen in a mirror: its columns in the other order, or its rows.
    fn mirrored(occupancy: &Occupancy, axis: usize) -> Occupancy {
        let (width, height) = (occupancy.width, occupancy.height);
        let from = |cell: usize| {
            let (column, row) = (cell % width, cell / width);
            if axis == 0 { row * width + width - 1 - column } else { (height - 1 - row) * width + column }
        };
        let cells = (0..width * height).map(|cell| occupancy.cells[from(cell)]).collect();
        Occupancy {
            width,
            height,
            cells,
            rule: String::new(),
            pixel_m: occupancy.pixel_m,
            origin_m: [0.0, 0.0],
            turn_rad: 0.0,
        }
    }

    /// Corners in the order of x and y, rounded to tenths of a millimetre.
    fn corners(plan: &FloorPlan) -> Vec<[i64; 2]> {
        let points = plan.walls.iter().flat_map(|wall| &wall.points_m);
        #[expect(clippy::cast_possible_truncation, reason = "a few metres")]
        let mut corners: Vec<[i64; 2]> =
            points.map(|point| point.map(|length_m| (1e4 * length_m).round() as i64)).collect();
        corners.sort_unstable();
        corners
    }

    #[test]
    fn straight_walls_are_where_their_pixels_are() {
        for wide in 1..=6 {
            for (vertical, at) in [(true, 0), (false, 1)] {
                let bar = if vertical { [20, 20, wide, 70] } else { [20, 20, 70, wide] };
                let plain = floor(110, 100, &[bar]);
                for (picture, mirror) in [(mirrored(&plain, 0), [true, false]), (mirrored(&plain, 1), [false, true])]
                {
                    let size_m = [110.0 * 0.05, 100.0 * 0.05];
                    // Row 20 is 20 pixels below the top.
                    let middle_m = [0.05 * (20.0 + 0.5 * wide as f64), 0.05 * (80.0 - 0.5 * wide as f64)];
                    let ends_m = [[1.0, 4.5], [0.5, 4.0]];
                    for (picture, mirror) in [(&plain, [false, false]), (&picture, mirror)] {
                        let seen = |axis: usize, m: f64| if mirror[axis] { size_m[axis] - m } else { m };
                        let wall = &read(picture).walls[0];
                        let (across, along) = (at, 1 - at);
                        let mut expected = ends_m[along].map(|m| seen(along, m));
                        expected.sort_by(f64::total_cmp);
                        let mut found = [0, 1].map(|end| wall.points_m[end][along]);
                        found.sort_by(f64::total_cmp);
                        let middle = seen(across, middle_m[across]);
                        assert!(wall.points_m.len() == 2, "{wide}, {vertical}, {mirror:?}: {wall:?}");
                        assert!(
                            wall.points_m.iter().all(|point| (point[across] - middle).abs() < 1.1e-3),
                            "{wall:?}"
                        );
                        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1.1e-3), "{wall:?}");
                        assert!((wall.thickness_m - 0.05 * wide as f64).abs() < 1e-9, "{wall:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn mirrored_pictures_have_mirrored_walls() {
        for wide in 1..=4 {
            let room = [
                [10, 10, 120, wide],
                [10, 10, wide, 80],
                [130 - wide, 10, wide, 80],
                [10, 90 - wide, 50, wide],
                [78, 90 - wide, 52, wide],
                [70, 10, wide, 50],
            ];
            let plain = floor(141, 103, &room);
            let found = corners(&read(&plain));
            for axis in 0..2 {
                let size = [70_500, 51_500][axis];
                let mut seen: Vec<[i64; 2]> = corners(&read(&mirrored(&plain, axis)));
                seen.iter_mut().for_each(|corner| corner[axis] = size - corner[axis]);
                seen.sort_unstable();
                let is_same = |(a, b): (&[i64; 2], &[i64; 2])| (0..2).all(|part| (a[part] - b[part]).abs() <= 15);
                assert!(
                    seen.len() == found.len() && seen.iter().zip(&found).all(is_same),
                    "{wide}, {axis}: {seen:?} {found:?}"
                );
            }
        }
    }

    #[test]
    fn walls_that_meet_end_at_the_face_of_the_one_that_goes_on() {
        let plan = read(&floor(200, 120, &[[10, 20, 180, 4], [100, 20, 4, 80], [40, 24, 2, 50]]));
        assert_eq!(plan.walls.len(), 3, "{:?}", plan.walls);
        let through =
            plan.walls.iter().find(|wall| (wall.points_m[0][1] - wall.points_m[1][1]).abs() < 0.01).unwrap();
        assert!((through.points_m[0][0] - through.points_m[1][0]).abs() > 8.85, "{through:?}");
        let face_m = through.points_m[0][1] - 0.5 * through.thickness_m;
        for side in plan.walls.iter().filter(|wall| *wall != through) {
            let top_m = side.points_m[0][1].max(side.points_m[1][1]);
            assert!((top_m - face_m).abs() < 0.06, "{side:?}, {face_m}");
        }
        let thin = plan.walls.iter().map(|wall| wall.thickness_m).fold(f64::MAX, f64::min);
        assert!((thin - 0.1).abs() < 0.015, "{thin}");
    }

    #[test]
    fn pillars_are_blocks_and_dirt_is_left_out() {
        // A large one, a small one, and dirt.
        let plan = read(&floor(200, 120, &[[10, 20, 180, 4], [60, 60, 20, 16], [100, 60, 6, 6], [150, 90, 2, 2]]));
        assert_eq!((plan.walls.len(), plan.blocks.len()), (1, 2), "{plan:?}");
        let ShapeConfig::Prism(prism) = &plan.blocks[0].shape else { panic!("a prism") };
        let width = |axis: usize| {
            let of = prism.corners_m.iter().map(|corner| corner[axis]);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min)
        };
        assert!((width(0) - 1.0).abs() < 0.06 && (width(1) - 0.8).abs() < 0.06, "{prism:?}");
        assert!(plan.notes.iter().any(|note| note.contains("1 speck")), "{:?}", plan.notes);
    }

    #[test]
    fn a_turned_map_has_turned_walls() {
        let mut turned = floor(100, 40, &[[10, 18, 80, 4]]);
        (turned.origin_m, turned.turn_rad) = ([10.0, 20.0], std::f64::consts::FRAC_PI_2);
        let wall = &read(&turned).walls[0];
        // Along x in the picture is along y on the floor.
        let (a, b) = (wall.points_m[0], wall.points_m[1]);
        assert!((a[0] - b[0]).abs() < 0.01 && ((a[1] - b[1]).abs() - 4.0).abs() < 0.11, "{wall:?}");
        assert!((a[0] - 9.0).abs() < 0.06, "{wall:?}");
    }
}
