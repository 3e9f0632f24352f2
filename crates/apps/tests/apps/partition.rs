//! Areas are divided among robots.

use sextant_apps::{
    BalanceConfig, CutConfig, FreeArea, PartitionConfig, RobotPart, SPathConfig, Surroundings, partition,
};
use sextant_channel::{Bounds, ObstacleField, Position};
use sextant_kernel::Seed;
use sextant_sim::layout::{Region, RegionConfig};

fn area(region: &RegionConfig) -> FreeArea {
    FreeArea::new(&Region::try_from(region).expect("a region"), &ObstacleField::default(), 0.0)
}

/// An L of 700 m².
fn letter_l() -> RegionConfig {
    let corners_m = vec![[0., 0.], [40., 0.], [40., 10.], [10., 10.], [10., 40.], [0., 40.]];
    RegionConfig::Polygon { corners_m, z_m: 0.0 }
}

fn regions() -> [RegionConfig; 3] {
    let min_m = Position::new(-10.0, 5.0, 0.0);
    [
        RegionConfig::Rectangle { min_m, max_m: Position::new(50.0, 25.0, 0.0) },
        RegionConfig::Disc { center_m: Position::new(3.0, 4.0, 0.0), radius_m: 20.0 },
        letter_l(),
    ]
}

fn by_area(cut: CutConfig) -> PartitionConfig {
    PartitionConfig { balance: BalanceConfig::Area, cut }
}

fn no_cost(_: usize, _: &RobotPart) -> Option<f64> {
    None
}

/// Whether a place is in the box of a part, seen from above.
fn holds(of: &Bounds, place: Position) -> bool {
    (of.min.x_m..=of.max.x_m).contains(&place.x_m) && (of.min.y_m..=of.max.y_m).contains(&place.y_m)
}

#[test]
fn parts_cover_the_region_and_have_the_same_area() {
    for config in regions() {
        let area = area(&config);
        let all_m2 = area.area_m2(&area.bounds());
        for cut in [CutConfig::Bisection, CutConfig::Strips] {
            for robots in [1, 2, 3, 5, 8, 13] {
                let parts = partition(&area, robots, by_area(cut), 0.0, no_cost);
                assert_eq!(parts.len(), robots);
                for part in &parts {
                    let share = area.area_m2(&part.own) / all_m2 * robots as f64;
                    assert!((share - 1.0).abs() < 1e-6, "{cut:?} {robots}: {share}");
                }
                let places: Vec<Position> = area.places(area.bounds(), 0.0).collect();
                assert!(places.len() > 10_000);
                let lost = places.iter().filter(|&&place| !parts.iter().any(|part| holds(&part.surveyed, place)));
                assert_eq!(lost.count(), 0, "{cut:?} {robots}");
                assert_eq!(parts, partition(&area, robots, by_area(cut), 0.0, no_cost), "the same each time");
            }
        }
    }
}

#[test]
fn neighbours_share_strips_within_the_region() {
    let area = area(&regions()[0]);
    for robots in [2, 4, 7] {
        let parts = partition(&area, robots, by_area(CutConfig::Bisection), 3.0, no_cost);
        for part in &parts {
            for (own, surveyed, whole, side) in [
                (part.own.min.x_m, part.surveyed.min.x_m, area.bounds().min.x_m, 1.0),
                (part.own.max.x_m, part.surveyed.max.x_m, area.bounds().max.x_m, -1.0),
                (part.own.min.y_m, part.surveyed.min.y_m, area.bounds().min.y_m, 1.0),
                (part.own.max.y_m, part.surveyed.max.y_m, area.bounds().max.y_m, -1.0),
            ] {
                let beyond_m = side * (own - surveyed);
                let expected_m = (side * (own - whole)).min(1.5);
                assert!((beyond_m - expected_m).abs() < 1e-6, "{robots}: {beyond_m} m, not {expected_m} m");
            }
        }
    }
}

/// The time of an S path over a part by a robot that starts at `start`, or at the corner of its part.
fn time_s(part: &RobotPart, start: Option<Position>) -> Option<f64> {
    let Bounds { min: min_m, max: max_m } = part.surveyed;
    let path = SPathConfig::new(RegionConfig::Rectangle { min_m, max_m }, 2.0);
    let obstacles = ObstacleField::default();
    let start = start.unwrap_or(min_m);
    let surroundings = Surroundings { obstacles: &obstacles, start, radius_m: 0.2, seed: Seed(1), robot: 0 };
    let way = sextant_apps::ControllerConfig::SPath(path).expected_way(&surroundings).ok()?;
    Some(way.length_m + 1.2 * way.stops as f64)
}

#[test]
fn robots_that_drive_far_get_smaller_parts() {
    let area = area(&regions()[0]);
    let depot = Position::new(-200.0, 15.0, 0.0);
    let slowest = |parts: &[RobotPart], start| {
        let times: Vec<f64> = parts.iter().map(|part| time_s(part, start).expect("a path")).collect();
        (times.iter().copied().fold(0.0, f64::max), times.iter().sum::<f64>() / times.len() as f64)
    };
    for start in [None, Some(depot)] {
        for robots in [2, 3, 4, 8] {
            let by_time = PartitionConfig::default();
            let timed = partition(&area, robots, by_time, 2.0, |_, part| time_s(part, start));
            let plain = partition(&area, robots, by_area(CutConfig::Bisection), 2.0, no_cost);
            let ((timed_s, mean_s), (plain_s, _)) = (slowest(&timed, start), slowest(&plain, start));
            assert!(timed_s <= plain_s + 1e-9, "{robots}: {timed_s} s, {plain_s} s");
            // A lane more or less is some 20 s.
            assert!(timed_s - mean_s < 45.0, "{robots}: {timed_s} s, mean {mean_s} s");
        }
    }
}

#[test]
fn obstacles_do_not_count_as_area() {
    let field = area(&regions()[0]);
    let half = Bounds { max: Position::new(20.0, 25.0, 0.0), ..field.bounds() };
    assert!((field.area_m2(&half) - 600.0).abs() < 1e-6);
    assert!((area(&letter_l()).area_m2(&area(&letter_l()).bounds()) - 700.0).abs() < 15.0);
    let disc = area(&regions()[1]);
    assert!((disc.area_m2(&disc.bounds()) / (std::f64::consts::PI * 400.0) - 1.0).abs() < 0.01);
}
