//! Line of sight and link budget: lines through obstacles, links, draws of shadowing, range sensors.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant_channel::{
    BoxConfig, Channel, ChannelConfig, CorrelationConfig, CylinderConfig, Dbm, Obstacle, ObstacleConfig,
    ObstacleField, Position, PrismConfig, ShadowingConfig, ShapeConfig, SpatialConfig,
};
use sextant_kernel::{Purpose, Seed, StationId};

const SEED: Seed = Seed(1);
const LINES: u64 = 1024;
const LENGTH_M: f64 = 60.0;
/// One obstacle for each 25 m², for any number of obstacles.
const SPACING_M: f64 = 5.0;

fn uniform(index: u64, axis: u64, low: f64, high: f64) -> f64 {
    low + (high - low) * SEED.uniform(Purpose::new(1), [index, axis, 0])
}

/// Side of the square town that `count` obstacles make (m).
fn side_m(count: u32) -> f64 {
    SPACING_M * f64::from(count).sqrt()
}

/// Boxes, cylinders and prisms of 0.5 to 3 m in turn.
fn town(count: u32) -> ObstacleField {
    let side_m = side_m(count);
    let obstacles = (0..u64::from(count)).map(|i| {
        let (x, y) = (uniform(i, 0, 0.0, side_m), uniform(i, 1, 0.0, side_m));
        let size = [uniform(i, 2, 0.5, 3.0), uniform(i, 3, 0.5, 3.0), uniform(i, 4, 1.0, 3.0)];
        let shape = match i % 3 {
            0 => ShapeConfig::Box(BoxConfig {
                center_m: Position::new(x, y, 0.5 * size[2]),
                size_m: size,
                yaw_deg: uniform(i, 5, 0.0, 180.0),
            }),
            1 => ShapeConfig::Cylinder(CylinderConfig {
                base_m: Position::new(x, y, 0.0),
                radius_m: 0.5 * size[0],
                height_m: size[2],
            }),
            _ => ShapeConfig::Prism(PrismConfig {
                corners_m: vec![[x, y], [x + size[0], y], [x + size[0], y + size[1]], [x, y + 0.5 * size[1]]],
                bottom_m: 0.0,
                height_m: size[2],
            }),
        };
        let config = ObstacleConfig::absorbing(shape, 4.6);
        Obstacle::try_from(config).expect("an obstacle with a volume")
    });
    ObstacleField::new(obstacles.collect())
}

/// Lines of 60 m with their middles in the town, a metre above ground.
fn lines(count: u32) -> Vec<(Position, Position)> {
    let side_m = side_m(count);
    (0..LINES)
        .map(|i| {
            let middle = Position::new(uniform(i, 10, 0.0, side_m), uniform(i, 11, 0.0, side_m), 1.0);
            let azimuth_rad = uniform(i, 12, 0.0, std::f64::consts::TAU);
            let half = Position::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0) * (0.5 * LENGTH_M);
            (middle - half, middle + half)
        })
        .collect()
}

fn crossings(c: &mut Criterion) {
    let mut group = c.benchmark_group("crossings_60_m");
    group.throughput(Throughput::Elements(LINES));
    for count in [100, 1_000, 10_000] {
        let (field, lines) = (town(count), lines(count));
        let mut found = Vec::new();
        group.bench_function(count.to_string(), |b| {
            b.iter(|| {
                let mut total = 0;
                for &(from, to) in &lines {
                    field.crossings(from, to, &mut found);
                    total += found.len();
                }
                black_box(total)
            });
        });
        group.bench_function(format!("loss_{count}"), |b| {
            b.iter(|| lines.iter().map(|&(from, to)| field.loss(from, to).0).sum::<f64>());
        });
    }
    group.finish();
}

fn link(c: &mut Criterion) {
    let mut group = c.benchmark_group("link");
    group.throughput(Throughput::Elements(LINES));
    let channel = |correlation, obstacles| {
        let shadowing = Some(ShadowingConfig { sigma_db: None, correlation });
        let law = ChannelConfig { shadowing, ..ChannelConfig::default() }.try_into().expect("a good channel");
        Channel::new(law, obstacles, SEED)
    };
    let nodes = |i: usize| (StationId(u32::try_from(i).expect("few lines")), StationId(7));
    let lines = lines(1_000);
    for (name, obstacles) in [("budget_free", ObstacleField::default()), ("budget_1000_obstacles", town(1_000))] {
        let channel = channel(CorrelationConfig::PerPacket, obstacles);
        group.bench_function(name, |b| {
            b.iter(|| {
                let power = |(i, &(from, to)): (usize, &(Position, Position))| {
                    let (a, b) = nodes(i);
                    channel.received_power(Dbm(-50.0), a, from, b, to, 3).map_or(0.0, |power| power.0)
                };
                lines.iter().enumerate().map(power).sum::<f64>()
            });
        });
    }
    for (name, correlation) in [
        ("shadowing_per_packet", CorrelationConfig::PerPacket),
        ("shadowing_per_link", CorrelationConfig::PerLink),
        ("shadowing_spatial", CorrelationConfig::Spatial(SpatialConfig { distance_m: 5.0 })),
    ] {
        let channel = channel(correlation, ObstacleField::default());
        group.bench_function(name, |b| {
            b.iter(|| {
                let gain = |(i, &(from, to)): (usize, &(Position, Position))| {
                    let (a, b) = nodes(i);
                    channel.shadowing(a, from, b, to, 3).0
                };
                lines.iter().enumerate().map(gain).sum::<f64>()
            });
        });
    }
    group.finish();
}

fn clearance(c: &mut Criterion) {
    let mut group = c.benchmark_group("clearance_10_m");
    group.throughput(Throughput::Elements(LINES));
    let (field, lines) = (town(1_000), lines(1_000));
    group.bench_function("1000", |b| {
        b.iter(|| lines.iter().map(|&(from, to)| field.clearance_m(from, to - from, 10.0, 0.2)).sum::<f64>());
    });
    group.finish();
}

criterion_group!(benches, crossings, link, clearance);
criterion_main!(benches);
