//! ML-TM against the formula of the thesis, written down as it stands and evaluated at every vertex.

use proptest::prelude::*;
use sextant_channel::{
    EvenSectorsConfig, LogError, Position, Reception, ReceptionLog, SectorConfig, SectorTable, Stop,
};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime, Unwatched};
use sextant_mapper::{
    CountRule, EstimateKind, Lattice, MapError, MlTm, MlTmConfig, ProfileConfig, ReceptionProfile,
    SectorLayoutConfig, SectorTolerance, SectorsConfig, TableProfile, TieRule, TrapezoidConfig,
};

const LITERAL_FLOOR: f64 = 1e-6;

fn stop(place: Position) -> Stop {
    Stop { robot: RobotId(0), time: SimTime::ZERO, position: place }
}

fn entry(node: u32, stop: u32, received: u32, sent: u32) -> Reception {
    Reception { node: NodeId(node), stop, received, sent, sector: None, rssi_dbm: None }
}

fn log(nodes: u32, stops: &[Position], receptions: Vec<Reception>) -> ReceptionLog {
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    let stops = stops.iter().map(|&place| stop(place)).collect();
    ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log without contradictions")
}

fn ml_tm(config: MlTmConfig) -> MlTm {
    MlTm::try_from(config).expect("good settings")
}

/// The thesis' algorithm: the product of Z over all stops, at every vertex of the lattice.
struct Oracle<'a> {
    profile: &'a TrapezoidConfig,
    /// In place of the trapezoid, if there is one.
    table: Option<&'a TableProfile>,
    log: &'a ReceptionLog,
    lattice: &'a Lattice,
    tolerance: SectorTolerance,
}

impl Oracle<'_> {
    fn s(&self, d: f64, floor: f64, ceiling: f64) -> f64 {
        let TrapezoidConfig { p0, plateau_m: r, range_m, .. } = *self.profile;
        let s = if let Some(table) = self.table {
            table.probability(d)
        } else if d <= r {
            p0
        } else if d >= range_m {
            0.0
        } else {
            p0 * (range_m - d) / (range_m - r)
        };
        s.max(floor).min(ceiling)
    }

    /// Whether the direction from the stop of a reception to the vertex is in the sector of the reception, by angles.
    fn is_in_sector(&self, vertex: Position, reception: &Reception) -> bool {
        let sector = self.log.sectors().zip(reception.sector).and_then(|(table, id)| {
            table.iter().find(|sector| sector.sector == id).filter(|_| self.tolerance != SectorTolerance::Unlimited)
        });
        let Some(sector) = sector else {
            return true;
        };
        let apart = vertex - self.log.stops()[reception.stop as usize].position;
        let across = apart.x_m.hypot(apart.y_m);
        let (azimuth, elevation) = (apart.y_m.atan2(apart.x_m), apart.z_m.atan2(across));
        let (from, width) = (sector.azimuth_from_deg.to_radians(), azimuth_width_deg(sector).to_radians());
        let [low, high] = [sector.elevation_from_deg, sector.elevation_to_deg].map(f64::to_radians);
        let turn = std::f64::consts::TAU;
        match self.tolerance {
            SectorTolerance::Angular => {
                let margin = (self.lattice.step_m() / self.profile.range_m).atan();
                let off_axis = (azimuth - from - 0.5 * width + 2.5 * turn).rem_euclid(turn) - 0.5 * turn;
                // At the stop itself, and right above it, a direction is rounding.
                apart.length_m() <= 1e-9
                    || (across <= 1e-9 || off_axis.abs() <= 0.5 * width + margin)
                        && (low - margin..=high + margin).contains(&elevation)
            }
            _ => {
                let h = self.lattice.half_diagonal_m();
                // Distances beyond an edge; the third line is what lies behind.
                let beyond_first = -across * (azimuth - from).sin();
                let beyond_last = -across * (from + width - azimuth).sin();
                let behind = -across * (azimuth - from - 0.5 * width).cos();
                let half_turn = std::f64::consts::PI;
                let azimuth_fits = if width > half_turn {
                    width >= turn || beyond_first <= h || beyond_last <= h
                } else {
                    beyond_first <= h && beyond_last <= h && behind <= h
                };
                let far = apart.length_m();
                azimuth_fits
                    && (sector.elevation_from_deg <= -90.0 || far * (low - elevation).sin() <= h)
                    && (sector.elevation_to_deg >= 90.0 || far * (elevation - high).sin() <= h)
                    && -far * (elevation - 0.5 * (low + high)).cos() <= h
            }
        }
    }

    fn product(&self, node: NodeId, vertex: Position, floor: f64, ceiling: f64) -> f64 {
        let mut product = 1.0;
        for (stop, place) in (0..).zip(self.log.stops()) {
            let counts = self.log.of(node).iter().find(|r| r.stop == stop);
            let (received, sent) = counts.map_or((0, 1), |r| (r.received, r.sent));
            let s = self.s(vertex.distance_m(place.position), floor, ceiling);
            let in_sector = counts.is_none_or(|reception| self.is_in_sector(vertex, &reception));
            for packet in 0..sent {
                product *= match (packet < received, in_sector) {
                    (true, true) => s,
                    (true, false) => floor,
                    (false, _) => 1.0 - s,
                };
            }
        }
        product
    }

    /// Vertices of the search set with their likelihoods, and whether the node is infeasible.
    fn likelihoods(&self, node: NodeId) -> (Vec<(u64, f64)>, bool) {
        let receivers: Vec<Reception> = self.log.of(node).iter().filter(|r| r.received > 0).collect();
        let range_squared = self.profile.range_m.powi(2);
        let near = |vertex: Position, reception: &Reception| {
            let apart = vertex - self.log.stops()[reception.stop as usize].position;
            apart.dot(apart) < range_squared && self.is_in_sector(vertex, reception)
        };
        let (floor, ceiling) = (self.profile.floor, self.profile.ceiling);
        let mut strict = Vec::new();
        let mut relaxed = Vec::new();
        for index in 0..self.lattice.len() {
            let vertex = self.lattice.position(self.lattice.vertex(index));
            if !receivers.is_empty() && receivers.iter().all(|reception| near(vertex, reception)) {
                let product = self.product(node, vertex, floor, ceiling);
                if product > 0.0 {
                    strict.push((index, product));
                }
            }
            if receivers.iter().any(|reception| near(vertex, reception)) {
                let (floor, ceiling) = (floor.max(LITERAL_FLOOR), ceiling.min(1.0 - LITERAL_FLOOR));
                relaxed.push((index, self.product(node, vertex, floor, ceiling)));
            }
        }
        if strict.is_empty() { (relaxed, true) } else { (strict, false) }
    }

    fn maximisers(likelihoods: &[(u64, f64)]) -> (f64, Vec<u64>) {
        let highest = likelihoods.iter().fold(0.0, |high: f64, &(_, p)| high.max(p));
        let equal = |&&(_, p): &&(u64, f64)| p.ln() >= highest.ln() - 1e-9;
        (highest, likelihoods.iter().filter(equal).map(|&(i, _)| i).collect())
    }

    fn mean_and_covariance(&self, likelihoods: &[(u64, f64)]) -> (Position, [[f64; 3]; 3]) {
        let place = |index| self.lattice.position(self.lattice.vertex(index));
        let total: f64 = likelihoods.iter().map(|&(_, p)| p).sum();
        let mean = likelihoods.iter().fold(Position::ORIGIN, |sum, &(i, p)| sum + place(i) * (p / total));
        let mut covariance = [[0.0; 3]; 3];
        for &(index, p) in likelihoods {
            let offset: [f64; 3] = (place(index) - mean).into();
            for (row, a) in covariance.iter_mut().zip(offset) {
                for (entry, b) in row.iter_mut().zip(offset) {
                    *entry += a * b * p / total;
                }
            }
        }
        (mean, covariance)
    }
}

fn azimuth_width_deg(sector: &SectorConfig) -> f64 {
    let width_deg = sector.azimuth_to_deg - sector.azimuth_from_deg;
    if width_deg >= 360.0 { 360.0 } else { width_deg.rem_euclid(360.0) }
}

/// A small survey: stops anywhere or exactly on vertices, up to three packets a stop.
#[derive(Clone, Debug)]
struct Case {
    profile: TrapezoidConfig,
    table: Vec<f64>,
    step_m: f64,
    stops: Vec<Position>,
    receptions: Vec<Reception>,
    sectors: Option<SectorTable>,
    tolerance: SectorTolerance,
}

const NODES: u32 = 3;

fn case(height_m: f64, step_m: f64, range_m: std::ops::Range<f64>) -> impl Strategy<Value = Case> {
    let profile = (0_u8..3, 0.05..1.0, 0.0..0.95, range_m, 0_u8..5, 0_u8..2);
    let place = (0.0..6.0, 0.0..6.0, 0.0..=height_m, 0_u8..3);
    let counts = (0_u32..4, 0_u32..4, 0_u8..6);
    let stop = (place, proptest::array::uniform3(counts));
    (profile, proptest::collection::vec(stop, 1..11)).prop_map(move |(profile, drawn)| {
        let (certain, p0, plateau, range_m, literal, whole_steps) = profile;
        let p0 = if certain == 0 { 1.0 } else { p0 };
        // A whole number of steps: vertices at the very range of a stop.
        let range_m = if whole_steps == 0 { (range_m / step_m).round() * step_m } else { range_m };
        let profile = TrapezoidConfig::new(p0, plateau * range_m, range_m);
        let profile = match literal {
            0 => profile.literal(),
            1 => TrapezoidConfig { floor: 0.04, ceiling: 1.0, ..profile },
            2 => TrapezoidConfig { floor: 0.0, ceiling: 0.8, ..profile },
            _ => profile,
        };
        let mut stops = Vec::new();
        let mut receptions = Vec::new();
        for (stop, ((x, y, z, on_vertex), nodes)) in (0..).zip(drawn) {
            let snapped = |value: f64, phase: f64| ((value / step_m).round() + phase) * step_m;
            stops.push(if on_vertex == 0 {
                // The phases of the lattice, so that distances and likelihoods coincide exactly or nearly so.
                let z = if height_m > 0.0 { snapped(z, 0.145_898_033_750_315) } else { z };
                let (x, y) = (snapped(x, 0.381_966_011_250_105), snapped(y, 0.236_067_977_499_79));
                Position::new(x, y, z)
            } else {
                Position::new(x, y, z)
            });
            for (node, (received, missed, kind)) in (0..).zip(nodes) {
                match kind {
                    0 | 1 => receptions.push(entry(node, stop, 1, 1)),
                    2 => receptions.push(entry(node, stop, received, received + missed)),
                    _ => {}
                }
            }
        }
        let (sectors, tolerance) = (None, SectorTolerance::default());
        Case { profile, table: Vec::new(), step_m, stops, receptions, sectors, tolerance }
    })
}

/// The same with a table in place of the trapezoid: as high next to the node, then anything, falling or not.
fn table_case(height_m: f64, step_m: f64, range_m: std::ops::Range<f64>) -> impl Strategy<Value = Case> {
    let value = prop_oneof![Just(0.0), Just(1.0), 0.0..1.0, 1e-12..1e-3];
    let table = (proptest::collection::vec(value, 1..12), any::<bool>());
    (case(height_m, step_m, range_m), table).prop_map(|(case, (mut values, falls)): (Case, (Vec<f64>, bool))| {
        if falls {
            values.sort_by(|a, b| b.total_cmp(a));
        }
        values.insert(0, case.profile.p0);
        Case { table: values, ..case }
    })
}

/// The same heard in sectors: most of those of a place where the node may be, some of any other place, some unknown.
fn sector_case(height_m: f64, step_m: f64, range_m: std::ops::Range<f64>) -> impl Strategy<Value = Case> {
    let elevations = prop_oneof![
        Just([-90.0, 90.0]),
        Just([-90.0, 0.0]),
        Just([0.0, 90.0]),
        (-90.0..30.0, 1.0..60.0).prop_map(|(low, tall): (f64, f64)| [low, low + tall]),
        (60.0..80.0).prop_map(|low| [low, 90.0]),
    ];
    let width = prop_oneof![2.0..90.0, 90.0..180.0, Just(180.0), 180.0..350.0, Just(360.0)];
    let sectors = proptest::collection::vec((-200.0..400.0, width, elevations), 1..6);
    let place = (0.0..6.0, 0.0..6.0, 0.0..=height_m);
    let choices = proptest::collection::vec(0_u8..20, 1..40);
    (case(height_m, step_m, range_m), sectors, proptest::array::uniform3(place), choices, any::<bool>()).prop_map(
        |(mut case, sectors, places, choices, is_angular)| {
            let sectors = (0..).zip(&sectors).map(|(sector, &(from, width, [low, high]))| SectorConfig {
                sector: 3 * sector,
                azimuth_from_deg: from,
                azimuth_to_deg: from + width,
                elevation_from_deg: low,
                elevation_to_deg: high,
            });
            let sectors: Vec<SectorConfig> = sectors.collect();
            for (reception, &choice) in case.receptions.iter_mut().zip(choices.iter().cycle()) {
                let (x, y, z) = places[reception.node.index()];
                let apart = Position::new(x, y, z) - case.stops[reception.stop as usize];
                let azimuth_deg = apart.y_m.atan2(apart.x_m).to_degrees();
                let elevation_deg = apart.z_m.atan2(apart.x_m.hypot(apart.y_m)).to_degrees();
                let points_there = |sector: &&SectorConfig| {
                    (azimuth_deg - sector.azimuth_from_deg).rem_euclid(360.0) <= azimuth_width_deg(sector)
                        && (sector.elevation_from_deg..=sector.elevation_to_deg).contains(&elevation_deg)
                };
                reception.sector = match choice {
                    0 => sectors.first().map(|sector| sector.sector),
                    1 | 2 => None,
                    _ => sectors.iter().find(points_there).map(|sector| sector.sector),
                };
            }
            let tolerance = if is_angular { SectorTolerance::Angular } else { SectorTolerance::Positional };
            let sectors = SectorTable::new(sectors).expect("sound sectors");
            Case { sectors: Some(sectors), tolerance, ..case }
        },
    )
}

fn agrees_with_the_literal_product(case: Case) -> Result<(), TestCaseError> {
    let mut log = log(NODES, &case.stops, case.receptions);
    if let Some(sectors) = case.sectors {
        log = log.with_sectors(sectors).expect("sectors of the table");
    }
    let config = MlTmConfig {
        ties: TieRule::First,
        sectors: Some(SectorsConfig { tolerance: case.tolerance, layout: None }),
        ..MlTmConfig::new(case.step_m, ProfileConfig::Trapezoid(case.profile.clone()))
    };
    let mut argmax = ml_tm(config.clone());
    let mut posterior = ml_tm(MlTmConfig { estimate: EstimateKind::PosteriorMean, ..config });
    if !case.table.is_empty() {
        let step_m = case.profile.range_m / f64::from(u32::try_from(case.table.len() - 1).expect("a short table"));
        let table = TableProfile::new(step_m, case.table.clone(), case.profile.floor, case.profile.ceiling);
        let profile = ReceptionProfile::Table(table.expect("a good table"));
        argmax = argmax.with_profile(profile.clone());
        posterior = posterior.with_profile(profile);
    }
    let lattice = argmax.lattice(&log).expect("a lattice");
    let table = if let ReceptionProfile::Table(table) = argmax.profile() { Some(table) } else { None };
    let profile = TrapezoidConfig { range_m: argmax.profile().range_m(), ..case.profile.clone() };
    let oracle = Oracle { profile: &profile, table, log: &log, lattice: &lattice, tolerance: case.tolerance };
    let (argmax_map, posterior_map) =
        (argmax.map(&log, &Unwatched).expect("a map"), posterior.map(&log, &Unwatched).expect("a map"));
    for node in 0..NODES {
        let (likelihoods, infeasible) = oracle.likelihoods(NodeId(node));
        let found = &argmax_map.estimates[node as usize];
        let mean = &posterior_map.estimates[node as usize];
        if likelihoods.is_empty() {
            prop_assert!(found.is_none() && mean.is_none());
            let unheard = argmax.surface(&log, NodeId(node), &Unwatched).is_err();
            prop_assert!(unheard);
            continue;
        }
        let (highest, maximisers) = Oracle::maximisers(&likelihoods);
        let found = found.as_ref().expect("the literal product finds a place");
        prop_assert_eq!(found.infeasible, infeasible);
        prop_assert_eq!(found.position, lattice.position(lattice.vertex(maximisers[0])));
        prop_assert_eq!(found.ties as usize, maximisers.len());
        prop_assert!((found.log_likelihood.expect("a likelihood") - highest.ln()).abs() < 1e-9);

        let mean = mean.as_ref().expect("the literal product finds a place");
        let (expected, covariance) = oracle.mean_and_covariance(&likelihoods);
        prop_assert!(mean.position.distance_m(expected) < 1e-9, "{:?} {:?}", mean, expected);
        let found = mean.covariance.expect("a posterior mean has a covariance");
        for (found, expected) in found.as_flattened().iter().zip(covariance.as_flattened()) {
            prop_assert!((found - expected).abs() < 1e-8, "{} {}", found, expected);
        }

        let surface = argmax.surface(&log, NodeId(node), &Unwatched).expect("a surface");
        let finite = surface.log_likelihood.iter().filter(|value| value.is_finite());
        prop_assert_eq!(finite.count(), likelihoods.len());
        prop_assert!((surface.maximum().1 - highest.ln()).abs() < 1e-9);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_plane_has_the_argmax_ties_and_mean_of_the_literal_product(case in case(0.0, 0.5, 1.0..4.0)) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn space_has_the_argmax_ties_and_mean_of_the_literal_product(case in case(3.0, 0.8, 1.0..2.5)) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn sectors_in_the_plane_have_the_argmax_ties_and_mean_of_the_literal_product(
        case in sector_case(0.0, 0.5, 1.5..6.0),
    ) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn sectors_in_space_have_the_argmax_ties_and_mean_of_the_literal_product(
        case in sector_case(3.0, 0.8, 1.5..4.0),
    ) {
        agrees_with_the_literal_product(case)?;
    }

    #[test]
    fn a_table_has_the_argmax_ties_and_mean_of_the_literal_product(
        plane in table_case(0.0, 0.5, 1.0..4.0),
        space in table_case(3.0, 0.8, 1.0..2.5),
    ) {
        agrees_with_the_literal_product(plane)?;
        agrees_with_the_literal_product(space)?;
    }
}

#[test]
fn many_stops_with_outliers_have_the_argmax_of_the_sum_of_logarithms() {
    // Large enough for several batches of vertices and stops; products would underflow.
    let draw = |i: u64, what| Seed(5).uniform(Purpose::new(8), [i, what, 0]);
    let stops: Vec<Position> = (0..300)
        .map(|i| Position::new(25.0 * draw(i, 0), 25.0 * draw(i, 1), 0.0))
        .chain([Position::new(60.0, 45.0, 0.0)])
        .collect();
    let profile = TrapezoidConfig::new(0.9, 2.0, 10.0);
    let mut receptions = Vec::new();
    let truth = [Position::new(12.0, 13.0, 0.0), Position::new(2.0, 20.0, 0.0)];
    for (node, place) in (0..).zip(truth) {
        for (i, &stop) in (0..).zip(&stops) {
            let heard = draw(u64::from(i), 2 + u64::from(node)) < 0.95 - 0.1 * place.distance_m(stop);
            // The last stop hears the second node from 60 m away, and counts more packets than a product holds.
            match (heard, i == 300 && node == 1) {
                (_, true) => receptions.push(entry(node, i, 3, 300)),
                (true, _) => receptions.push(entry(node, i, 1, 1)),
                _ => {}
            }
        }
    }
    let log = log(2, &stops, receptions);
    for step_m in [0.3, 0.45] {
        let ml_tm = ml_tm(MlTmConfig::new(step_m, ProfileConfig::Trapezoid(profile.clone())));
        let map = ml_tm.map(&log, &Unwatched).unwrap();
        let lattice = ml_tm.lattice(&log).unwrap();
        assert_eq!(map.infeasible(), 1, "only the node with the outlier");
        for node in 0..2 {
            let mut counts = vec![(0, 1); stops.len()];
            for r in log.of(NodeId(node)) {
                counts[r.stop as usize] = (r.received, r.sent);
            }
            let mut best = (0, f64::NEG_INFINITY);
            for index in 0..lattice.len() {
                let vertex = lattice.position(lattice.vertex(index));
                let mut sum = 0.0;
                let mut in_reach = (0, 0);
                for (&(received, sent), &place) in counts.iter().zip(&stops) {
                    let d = vertex.distance_m(place);
                    let s = (0.9 * (10.0 - d) / 8.0).clamp(1e-6, 0.9);
                    sum += f64::from(received) * s.ln() + f64::from(sent - received) * (1.0 - s).ln();
                    in_reach.0 += u32::from(received > 0 && d < 10.0);
                    in_reach.1 += u32::from(received > 0);
                }
                let admitted = if node == 0 { in_reach.0 == in_reach.1 } else { in_reach.0 > 0 };
                if admitted && sum > best.1 + 1e-9 {
                    best = (index, sum);
                }
            }
            let estimate = map.estimates[node as usize].as_ref().unwrap();
            assert_eq!(estimate.position, lattice.position(lattice.vertex(best.0)), "node {node}");
            assert!((estimate.log_likelihood.expect("a likelihood") - best.1).abs() < 1e-9);
            assert!(estimate.position.distance_m(truth[node as usize]) < 2.0);
        }
        // The work is a small part of the lattice, outlier or not.
        assert!(map.vertices_evaluated < lattice.len() / 20, "{}", map.vertices_evaluated);
    }
}

#[test]
fn the_worked_example_of_the_thesis_comes_out() {
    // Its numbers follow from r = 0.1, not from the r = 0.2 that its text states.
    let profile = TrapezoidConfig::new(1.0, 0.1, 2.0).literal();
    let config = MlTmConfig::new(1.0, ProfileConfig::Trapezoid(profile));
    let ml_tm = ml_tm(MlTmConfig { ties: TieRule::First, ..config });
    let row = [false, false, true, false, false, false];
    let z = |d: f64, heard: bool| {
        let s = ml_tm.profile().probability(d);
        if heard { s } else { 1.0 - s }
    };
    let printed = [
        ([0.0, 1.44, 2.64, 3.78, 4.68, 6.02], 0.0),
        ([1.41, 0.36, 1.36, 2.42, 3.2, 4.6], 0.0325),
        ([3.16, 1.81, 0.76, 1.3, 2.50, 3.64], 0.3708),
        ([4.4, 3.2, 2.72, 1.97, 1.21, 2.06], 0.0),
    ];
    for (distances, expected) in printed {
        let product: f64 = distances.iter().zip(row).map(|(&d, heard)| z(d, heard)).product();
        assert!((product - expected).abs() < 2e-3, "{product} for the printed {expected}");
    }

    // The robot's stops are not printed; these reproduce the printed distances within 0.07 m. They are shifted as the
    // vertices are, which then stand for the integer places of the example.
    let shift = Position::new(0.381_966_011_250_105, 0.236_067_977_499_79, 0.0);
    let places = [(0.0, 0.0), (0.82, 1.23), (1.30, 2.31), (2.31, 3.02), (3.48, 3.08), (4.50, 4.00)];
    let stops = places.map(|(x, y)| Position::new(x, y, 0.0) + shift);
    let heard = [(0, 2), (1, 1), (1, 2), (1, 3), (2, 4)];
    let log = log(3, &stops, heard.map(|(node, stop)| entry(node, stop, 1, 1)).to_vec());
    let map = ml_tm.map(&log, &Unwatched).unwrap();
    let place = |node: usize| map.estimates[node].as_ref().unwrap().position - shift;
    assert!(place(0).distance_m(Position::new(1.0, 3.0, 0.0)) < 1e-9);
    assert!(place(2).distance_m(Position::new(4.0, 2.0, 0.0)) < 1e-9);
    // For q the printed (2, 2) is a near tie inside the rounding of the stops.
    let surface = ml_tm.surface(&log, NodeId(1), &Unwatched).unwrap();
    let printed = (0..surface.lattice.len())
        .find(|&i| {
            let vertex = surface.lattice.position(surface.lattice.vertex(i));
            (vertex - shift).distance_m(Position::new(2.0, 2.0, 0.0)) < 1e-9
        })
        .and_then(|i| usize::try_from(i).ok())
        .expect("(2, 2) is in the window");
    assert!(surface.log_likelihood[printed] > surface.maximum().1 + 0.9_f64.ln());
}

#[test]
fn without_noise_the_likelihood_is_highest_at_the_truth() {
    // Shares of received packets equal to the profile make every factor highest at the true distance.
    const SENT: u32 = 1_000_000;
    for seed in 0..20 {
        let draw = |i: u64, axis| Seed(seed).uniform(Purpose::new(8), [i, axis, 1]);
        let height_m = if seed % 2 == 0 { 0.0 } else { 4.0 };
        let stops: Vec<Position> =
            (0..40).map(|i| Position::new(12.0 * draw(i, 0), 12.0 * draw(i, 1), height_m * draw(i, 2))).collect();
        let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 6.0));
        let ml_tm = ml_tm(MlTmConfig::new(0.3, profile));
        let empty = log(1, &stops, Vec::new());
        let lattice = ml_tm.lattice(&empty).unwrap();
        let truth = lattice.position(lattice.counts().map(|count| count / 2));
        let packets = |stop: &Position| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most SENT")]
            let received = (ml_tm.profile().probability(truth.distance_m(*stop)) * f64::from(SENT)).round() as u32;
            // A floor of one in a million is no reception.
            if received > 1 { received } else { 0 }
        };
        let receptions = (0..).zip(&stops).map(|(i, stop)| entry(0, i, packets(stop), SENT)).collect();
        let map = ml_tm.map(&log(1, &stops, receptions), &Unwatched).unwrap();
        let estimate = map.estimates[0].as_ref().unwrap();
        assert!(estimate.position.distance_m(truth) < 1e-9, "seed {seed}: {estimate:?}, truth {truth:?}");
        assert!(!estimate.infeasible && estimate.ties == 1);
    }
}

#[test]
fn slots_with_at_least_one_packet_are_mapped_as_one_of_one() {
    let places: Vec<Position> = (0..25_i32).map(|i| Position::new((i % 5).into(), (i / 5).into(), 0.0)).collect();
    let counted =
        vec![entry(0, 6, 2, 3), entry(0, 7, 1, 4), entry(0, 11, 5, 5), entry(0, 12, 0, 9), entry(0, 18, 0, 0)];
    let slots =
        vec![entry(0, 6, 1, 1), entry(0, 7, 1, 1), entry(0, 11, 1, 1), entry(0, 12, 0, 1), entry(0, 18, 0, 0)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 4.0));
    let map = |counts, receptions| {
        let config =
            MlTmConfig { counts, estimate: EstimateKind::PosteriorMean, ..MlTmConfig::new(0.25, profile.clone()) };
        ml_tm(config).map(&log(1, &places, receptions), &Unwatched).unwrap().estimates
    };
    let as_slots = map(Some(CountRule::Packets), slots);
    assert_eq!(map(Some(CountRule::AtLeastOne), counted.clone()), as_slots);
    assert_ne!(map(None, counted), as_slots);
}

#[test]
fn nodes_never_heard_are_not_placed() {
    let stops = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let ml_tm = ml_tm(MlTmConfig::new(0.5, profile));
    let partly = log(3, &stops, vec![entry(0, 0, 1, 1), entry(1, 0, 0, 0), entry(1, 1, 0, 5)]);
    let map = ml_tm.map(&partly, &Unwatched).unwrap();
    assert_eq!((map.mapped(), map.unmapped()), (1, 2));
    assert!(map.estimates[0].is_some());
    assert!(
        matches!(ml_tm.surface(&partly, NodeId(1), &Unwatched), Err(MapError::NotHeard { name }) if name == "n1")
    );
    assert!(matches!(
        ml_tm.surface(&partly, NodeId(7), &Unwatched),
        Err(MapError::UnknownNode { node: 7, nodes: 3 })
    ));
    let silent = ml_tm.map(&log(2, &[], Vec::new()), &Unwatched).unwrap();
    assert_eq!((silent.mapped(), silent.unmapped(), silent.vertices_evaluated), (0, 2, 0));
}

#[test]
fn sectors_come_from_the_settings_or_from_the_log_and_must_be_known() {
    // Heard at two stops of a lane, each time to the left: the mirror image on the right is ruled out.
    let stops = [-1.0, 0.0, 1.0].map(|x| Position::new(x, 0.0, 0.0));
    let heard = |sector| [0, 2].map(|stop| Reception { sector: Some(sector), ..entry(0, stop, 1, 1) }).to_vec();
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 4.0));
    let even = EvenSectorsConfig { azimuth_sectors: 4, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
    let layout = Some(SectorLayoutConfig::Even(even.clone()));
    let with = |sectors| ml_tm(MlTmConfig { sectors, ..MlTmConfig::new(0.25, profile.clone()) });
    let y_m = |map: sextant_mapper::TopologyMap| map.estimates[0].as_ref().map(|estimate| estimate.position.y_m);
    let (left, right) = (log(1, &stops, heard(1)), log(1, &stops, heard(3)));
    let by_settings = with(Some(SectorsConfig { layout: layout.clone(), ..SectorsConfig::default() }));
    let [on_left, on_right] = [&left, &right].map(|log| y_m(by_settings.map(log, &Unwatched).unwrap()).unwrap());
    assert!(on_left > 0.5 && on_right < -0.5, "{on_left}, {on_right}");
    let told = left.clone().with_sectors(SectorTable::try_from(even).unwrap()).unwrap();
    assert_eq!(with(None).map(&told, &Unwatched).unwrap(), by_settings.map(&left, &Unwatched).unwrap());
    // Without a table, or without limit, sectors say nothing.
    assert_eq!(with(None).map(&left, &Unwatched).unwrap(), with(None).map(&right, &Unwatched).unwrap());
    let unlimited = with(Some(SectorsConfig { tolerance: SectorTolerance::Unlimited, layout }));
    assert_eq!(unlimited.map(&told, &Unwatched).unwrap(), with(None).map(&right, &Unwatched).unwrap());
    let error = by_settings.map(&log(1, &stops, heard(7)), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::Log(LogError::UnknownSector { sector: 7, stop: 0, .. })));
    let expected = "node `n0` at stop 0 was heard in sector 7; the listener's sectors are 0 to 3";
    assert_eq!(error.to_string(), expected);
    let list = vec![SectorConfig {
        sector: 0,
        azimuth_from_deg: 0.0,
        azimuth_to_deg: f64::NAN,
        elevation_from_deg: -90.0,
        elevation_to_deg: 90.0,
    }];
    let sectors = Some(SectorsConfig { layout: Some(SectorLayoutConfig::List(list)), ..SectorsConfig::default() });
    let error = MlTm::try_from(MlTmConfig { sectors, ..MlTmConfig::new(0.25, profile) }).unwrap_err();
    assert_eq!(error.key, "sectors.layout.list[0].azimuth_to_deg");
}

#[test]
fn zero_of_zero_packets_is_no_evidence() {
    let places = [(0.0, 0.0), (2.0, 0.5), (1.0, 2.0), (1.0, 0.5)];
    let stops = places.map(|(x, y)| Position::new(x, y, 0.0));
    let heard = vec![entry(0, 0, 1, 1), entry(0, 1, 1, 1)];
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 3.0));
    let ml_tm = ml_tm(MlTmConfig { z_range_m: Some([0.0, 0.0]), ..MlTmConfig::new(0.25, profile) });
    let mut with_nothing = heard.clone();
    with_nothing.push(entry(0, 3, 0, 0));
    let deaf = ml_tm.map(&log(1, &stops, with_nothing), &Unwatched).unwrap();
    let absent = ml_tm.map(&log(1, &stops[..3], heard.clone()), &Unwatched).unwrap();
    let missed = ml_tm.map(&log(1, &stops, heard), &Unwatched).unwrap();
    let likelihood = |map: &sextant_mapper::TopologyMap| map.estimates[0].as_ref().unwrap().log_likelihood.unwrap();
    assert!((likelihood(&deaf) - likelihood(&absent)).abs() < 1e-12);
    assert!(likelihood(&missed) < likelihood(&absent) - 0.01);
}

#[test]
fn a_plateau_is_represented_by_its_mean_and_mirror_images_by_one_of_them() {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let place = |config: MlTmConfig, stops: &[Position], heard: &[u32]| {
        let receptions = heard.iter().map(|&stop| entry(0, stop, 1, 1)).collect();
        let map = ml_tm(config).map(&log(1, stops, receptions), &Unwatched).unwrap();
        let estimate = map.estimates[0].clone().unwrap();
        (estimate.position, estimate.ties)
    };
    // One stop on a vertex: every vertex of its plateau is as likely.
    let step_m = 0.5;
    let centre = Position::new(0.381_966_011_250_105, 0.236_067_977_499_79, 0.0) * step_m;
    let config = MlTmConfig::new(step_m, profile);
    let (mean, ties) = place(config.clone(), &[centre], &[0]);
    assert!(ties >= 9 && mean.distance_m(centre) < 1e-9, "{mean:?}, {ties} ties");
    let (first, _) = place(MlTmConfig { ties: TieRule::First, ..config.clone() }, &[centre], &[0]);
    assert!(first.y_m < centre.y_m - 0.4);

    // A straight lane of stops, the outer ones deaf to the node: it is on one side or on the other.
    let lane: Vec<Position> = (-10..=10).map(|i| centre + Position::new(0.25 * f64::from(i), 0.0, 0.0)).collect();
    let heard = [10];
    let (side, ties) = place(config, &lane, &heard);
    assert!(ties >= 2);
    assert!((side.y_m - centre.y_m).abs() > 1.0, "{side:?} is between the mirror images");
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let draw = |i: u64, what| Seed(11).uniform(Purpose::new(8), [i, what, 2]);
    let stops: Vec<Position> =
        (0..200).map(|i| Position::new(20.0 * draw(i, 0), 20.0 * draw(i, 1), 3.0 * draw(i, 2))).collect();
    let mut receptions = Vec::new();
    for node in 0..200 {
        let place = Position::new(20.0 * draw(node, 3), 20.0 * draw(node, 4), 3.0 * draw(node, 5));
        for (i, &stop) in (0..).zip(&stops) {
            if draw(1000 * node + u64::from(i), 6) < 1.0 - place.distance_m(stop) / 6.0 {
                receptions.push(entry(u32::try_from(node).unwrap(), i, 1, 1));
            }
        }
    }
    let log = log(200, &stops, receptions);
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.5, 5.0));
    let config = MlTmConfig { estimate: EstimateKind::PosteriorMean, ..MlTmConfig::new(0.5, profile) };
    let ml_tm = ml_tm(config);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        format!("{:?}", pool.install(|| ml_tm.map(&log, &Unwatched)).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert!(one.contains("infeasible: true") && one.contains("infeasible: false"));
}

#[test]
fn bad_settings_are_refused_by_name() {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 3.0));
    let good = MlTmConfig::new(0.25, profile);
    assert!(MlTm::try_from(good.clone()).is_ok());
    let bad_profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 4.0, 3.0));
    let bad = [
        (MlTmConfig { grid_step_m: 0.0, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { grid_step_m: f64::NAN, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { grid_step_m: 3.5, ..good.clone() }, "grid_step_m"),
        (MlTmConfig { profile: bad_profile, ..good.clone() }, "profile.trapezoid.plateau_m"),
        (MlTmConfig { z_range_m: Some([1.0, 0.0]), ..good.clone() }, "z_range_m"),
        (MlTmConfig { z_range_m: Some([0.0, f64::INFINITY]), ..good.clone() }, "z_range_m"),
        (MlTmConfig { max_memory_mb: Some(0), ..good.clone() }, "max_memory_mb"),
    ];
    for (config, key) in bad {
        assert_eq!(MlTm::try_from(config).unwrap_err().key, key);
    }
    let fine = MlTm::try_from(MlTmConfig { grid_step_m: 1e-5, ..good }).unwrap();
    let error = fine.map(&log(1, &[Position::ORIGIN], vec![entry(0, 0, 1, 1)]), &Unwatched).unwrap_err();
    assert!(matches!(error, MapError::GridTooLarge { .. }));
    assert!(error.to_string().contains("a grid_step_m of"), "{error}");
}
