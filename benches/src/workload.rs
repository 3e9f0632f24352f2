//! Reception logs that are drawn at random instead of simulated: nodes and stops in a plane, a ball or a room, and
//! links that succeed or fail independently. Only their sizes are those of real surveys.

use std::collections::BTreeMap;

use sextant_channel::{EvenSectorsConfig, Position, Reception, ReceptionLog, ReceptionLogBuilder, SectorTable, Stop};
use sextant_kernel::{NodeId, Purpose, Seed};
use sextant_mapper::{Lattice, ReceptionProfile};

/// A survey to be mapped.
#[derive(Clone, Debug)]
pub struct Workload {
    /// Its name in tables.
    pub name: &'static str,
    /// What the robot heard.
    pub log: ReceptionLog,
    /// Distance beyond which nothing was heard (m).
    pub range_m: f64,
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// Where the nodes really are (m).
    pub places: Vec<Position>,
}

/// Transmit power less sensitivity (dB), path-loss exponent and shadowing (dB) of the suburban environment
/// (Gunathillake 2018, table 3.4).
const SUBURBAN: (f64, f64, f64) = (40.0, 2.7, 9.6);

/// Side of the square of `plane` (m).
const SIDE_M: f64 = 30.0;

/// Lanes of the S path of `plane`, and its stops.
const LANES: u32 = 12;
const PLANE_STOPS: u32 = 444;

/// W1: 500 nodes in a square of 30 m, 444 stops along an S path, 10 m of range, a grid of 0.25 m.
#[must_use]
pub fn plane() -> Workload {
    let seed = Seed(1);
    let per_lane = PLANE_STOPS / LANES;
    let stops: Vec<Position> = (0..PLANE_STOPS)
        .map(|stop| {
            let (lane, along) = (stop / per_lane, stop % per_lane);
            let along = f64::from(if lane % 2 == 0 { along } else { per_lane - 1 - along });
            let spread = |share: f64| (share * 1.04 - 0.02) * SIDE_M;
            Position::new(
                spread(along / f64::from(per_lane - 1)),
                spread(f64::from(lane) / f64::from(LANES - 1)),
                0.0,
            )
        })
        .collect();
    let nodes: Vec<Position> = (0..500)
        .map(|node| {
            let draw = |axis| SIDE_M * seed.uniform(Purpose::new(1), [node, axis, 0]);
            Position::new(draw(0), draw(1), 0.0)
        })
        .collect();
    Workload {
        name: "plane",
        log: survey(seed, &nodes, &stops, 10.0),
        range_m: 10.0,
        grid_step_m: 0.25,
        places: nodes,
    }
}

/// W2: 1736 nodes in a ball of 1400 m³, 706 stops along a path that fills it, 3 m of range, a grid of 0.25 m.
#[must_use]
pub fn ball() -> Workload {
    let seed = Seed(2);
    let radius_m = libm::cbrt(3.0 * 1400.0 / (4.0 * std::f64::consts::PI));
    let inside = |place: &Position| place.length_m() <= radius_m;
    let anywhere = (0..).map(|node| {
        let draw = |axis| radius_m * (2.0 * seed.uniform(Purpose::new(1), [node, axis, 0]) - 1.0);
        Position::new(draw(0), draw(1), draw(2))
    });
    let nodes: Vec<Position> = anywhere.filter(inside).take(1736).collect();
    let sites = (-6..=6).flat_map(|z| (-6..=6).flat_map(move |y| (-6..=6).map(move |x| [x, y, z])));
    let spacing_m = 1.255;
    let mut stops: Vec<Position> =
        sites.map(|site| Position::from(site.map(f64::from)) * spacing_m).filter(inside).collect();
    stops.truncate(706);
    Workload { name: "ball", log: survey(seed, &nodes, &stops, 3.0), range_m: 3.0, grid_step_m: 0.25, places: nodes }
}

/// A square of `nodes / 0.5` m² with one stop each square metre, 10 m of range, a grid of 0.24 m. W4 has 100 000 nodes
/// and twice as many stops, W5 ten times that.
#[must_use]
pub fn field(nodes: u32) -> Workload {
    field_with_stops(nodes, 1.0)
}

/// The same with a stop each `spacing_m` in both directions.
#[must_use]
pub fn field_with_stops(nodes: u32, spacing_m: f64) -> Workload {
    let seed = Seed(4);
    let side = (f64::from(2 * nodes)).sqrt().round();
    let sites = || (0..).map(|i| f64::from(i) * spacing_m).take_while(|&at| at < side);
    let stops: Vec<Position> = sites().flat_map(|y| sites().map(move |x| Position::new(x, y, 0.0))).collect();
    let nodes: Vec<Position> = (0..u64::from(nodes))
        .map(|node| {
            let draw = |axis| side * seed.uniform(Purpose::new(1), [node, axis, 0]);
            Position::new(draw(0), draw(1), 0.0)
        })
        .collect();
    Workload {
        name: "field",
        log: survey(seed, &nodes, &stops, 10.0),
        range_m: 10.0,
        grid_step_m: 0.24,
        places: nodes,
    }
}

/// W3: 881 nodes in a room of 40 m by 20 m by 4 m, 1000 stops in five layers, 7 m of range, a grid of 0.2 m, and an
/// antenna of 8 sectors in each of two rings, below and above the horizon.
#[must_use]
pub fn room() -> Workload {
    let seed = Seed(3);
    let sites = (0..5).flat_map(|z| (0..10).flat_map(move |y| (0..20).map(move |x| [x, y, z])));
    let stops: Vec<Position> = sites
        .map(|site| site.map(f64::from))
        .map(|[x, y, z]| Position::new(2.0 * x + 1.0, 2.0 * y + 1.0, z))
        .collect();
    let nodes: Vec<Position> = (0..881)
        .map(|node| {
            let draw = |axis| seed.uniform(Purpose::new(1), [node, axis, 0]);
            Position::new(40.0 * draw(0), 20.0 * draw(1), 4.0 * draw(2))
        })
        .collect();
    let omni = survey(seed, &nodes, &stops, 7.0);
    let sectored = omni.receptions().iter().map(|reception| {
        let apart = nodes[reception.node.index()] - stops[reception.stop as usize];
        let turn = libm::atan2(apart.y_m, apart.x_m).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let azimuth = (0..8).rfind(|&i| turn >= (f64::from(i) - 0.5) / 8.0).filter(|_| turn < 7.5 / 8.0).unwrap_or(0);
        Reception { sector: Some(azimuth + if apart.z_m > 0.0 { 8 } else { 0 }), ..reception }
    });
    let mut receptions = ReceptionLogBuilder::default();
    receptions.extend(sectored);
    let even = EvenSectorsConfig {
        azimuth_sectors: 8,
        first_azimuth_deg: 0.0,
        elevations_deg: vec![[-90.0, 0.0], [0.0, 90.0]],
    };
    let sectors = SectorTable::try_from(even).expect("sound sectors");
    let log = receptions.build(omni.names().to_vec(), omni.stops().to_vec(), Vec::new());
    let log = log.and_then(|log| log.with_sectors(sectors)).expect("a log without contradictions");
    Workload { name: "room", log, range_m: 7.0, grid_step_m: 0.2, places: nodes }
}

/// The log of `nodes` heard at `stops`: one packet each, log-distance loss, shadowing drawn for each packet, and
/// nothing heard beyond `range_m`.
fn survey(seed: Seed, nodes: &[Position], stops: &[Position], range_m: f64) -> ReceptionLog {
    let (margin_db, exponent, sigma_db) = SUBURBAN;
    let mut receptions = ReceptionLogBuilder::default();
    let tiles = tiles(stops, range_m);
    for (node, place) in (0..).zip(nodes) {
        for &stop in near(&tiles, place, range_m) {
            let distance_m = place.distance_m(stops[stop as usize]);
            if distance_m >= range_m {
                continue;
            }
            let shadowing_db = sigma_db * seed.normal(Purpose::new(4), [node, u64::from(stop), 0]);
            if margin_db + shadowing_db >= 10.0 * exponent * libm::log10(distance_m.max(0.1)) {
                let node = NodeId(u32::try_from(node).expect("a node"));
                receptions.push(Reception::heard(node, stop, 1, 1));
            }
        }
    }
    let stops = stops.iter().map(|&position| Stop::at(position)).collect();
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    receptions.build(names, stops, Vec::new()).expect("a log without contradictions")
}

/// Stops by square of side `range_m`.
fn tiles(stops: &[Position], range_m: f64) -> BTreeMap<[i64; 2], Vec<u32>> {
    let mut tiles: BTreeMap<_, Vec<u32>> = BTreeMap::new();
    for (stop, place) in (0..).zip(stops) {
        tiles.entry(tile(place, range_m)).or_default().push(stop);
    }
    tiles
}

/// The stops in the squares round a place, which hold all within `range_m`.
fn near<'t>(
    tiles: &'t BTreeMap<[i64; 2], Vec<u32>>,
    place: &Position,
    range_m: f64,
) -> impl Iterator<Item = &'t u32> {
    let [y, x] = tile(place, range_m);
    (y - 1..=y + 1).flat_map(move |y| tiles.range([y, x - 1]..=[y, x + 1])).flat_map(|(_, stops)| stops)
}

/// Row and column of the square. Squares of one row are neighbours in the map.
#[expect(clippy::cast_possible_truncation, reason = "a few thousand squares")]
fn tile(place: &Position, range_m: f64) -> [i64; 2] {
    [place.y_m, place.x_m].map(|value| (value / range_m).floor() as i64)
}

/// Which of `vertices` has the highest product over all stops, and the product: the likelihood as it is written.
#[must_use]
pub fn likeliest(
    lattice: &Lattice,
    vertices: impl Iterator<Item = u64>,
    log: &ReceptionLog,
    profile: &ReceptionProfile,
    node: NodeId,
) -> (u64, f64) {
    let mut heard = vec![false; log.stops().len()];
    for reception in log.of(node) {
        heard[reception.stop as usize] = true;
    }
    let mut best = (0, f64::NEG_INFINITY);
    for index in vertices {
        let vertex = lattice.position(lattice.vertex(index));
        let mut product = 1.0;
        for (stop, &heard) in log.stops().iter().zip(&heard) {
            let s = profile.probability(vertex.distance_m(stop.position));
            product *= if heard { s } else { 1.0 - s };
        }
        if product > best.1 {
            best = (index, product);
        }
    }
    best
}
