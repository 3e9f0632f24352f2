//! Small surveys, drawn at random.

use std::ops::Range;

use proptest::prelude::*;
use sextant_channel::{EvenSectorsConfig, Position, Reception, SectorConfig, SectorTable};
use sextant_mapper::{SectorTolerance, SilenceRule, TrapezoidConfig};

use super::entry;
use super::oracle::azimuth_width_deg;

/// A small survey: stops anywhere or exactly on vertices, up to three packets a stop.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) profile: TrapezoidConfig,
    pub(super) table: Vec<f64>,
    pub(super) step_m: f64,
    pub(super) stops: Vec<Position>,
    pub(super) receptions: Vec<Reception>,
    pub(super) sectors: Option<SectorTable>,
    pub(super) tolerance: SectorTolerance,
    pub(super) silence: SilenceRule,
}

/// Nodes of a case.
pub(super) const NODES: u32 = 3;

pub(super) fn case(height_m: f64, step_m: f64, range_m: Range<f64>) -> impl Strategy<Value = Case> {
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
        let silence = SilenceRule::default();
        Case { profile, table: Vec::new(), step_m, stops, receptions, sectors, tolerance, silence }
    })
}

/// The same with a table instead of the trapezoid. The first value is that of the trapezoid, the others are
/// arbitrary.
pub(super) fn table_case(height_m: f64, step_m: f64, range_m: Range<f64>) -> impl Strategy<Value = Case> {
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

/// The same with sectors. Most receptions are in the sector that points to a possible place of the node, some in
/// another sector, some in an unknown one.
pub(super) fn sector_case(height_m: f64, step_m: f64, range_m: Range<f64>) -> impl Strategy<Value = Case> {
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
    let ring = prop_oneof![Just(None), (1_u8..9, -90.0..80.0, 1.0..100.0).prop_map(Some)];
    let sectors = (sectors, ring);
    let rules = (0_u8..3, 0_u8..4);
    (case(height_m, step_m, range_m), sectors, proptest::array::uniform3(place), choices, rules).prop_map(
        |(mut case, (sectors, ring), places, choices, (tolerance, silence))| {
            let sectors = (0..).zip(&sectors).map(|(sector, &(from, width, [low, high]))| SectorConfig {
                sector: 3 * sector,
                azimuth_from_deg: from,
                azimuth_to_deg: from + width,
                elevation_from_deg: low,
                elevation_to_deg: high,
            });
            let mut sectors: Vec<SectorConfig> = sectors.collect();
            // A ring that fills the circle, alone or beside sectors that do not.
            if let Some((azimuth_sectors, low, tall)) = ring {
                let elevations_deg = vec![[low, f64::min(low + tall, 90.0)]];
                let even = EvenSectorsConfig { azimuth_sectors, first_azimuth_deg: 20.0, elevations_deg };
                let ring = SectorTable::try_from(even).expect("a sound ring");
                if azimuth_sectors % 2 == 0 {
                    sectors.clear();
                }
                sectors
                    .extend(ring.iter().map(|sector| SectorConfig { sector: 100 + sector.sector, ..sector.clone() }));
            }
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
            let tolerance = match tolerance {
                0 => SectorTolerance::Angular,
                1 => SectorTolerance::AngularLiteral,
                _ => SectorTolerance::Positional,
            };
            let silence = if silence == 0 { SilenceRule::Everywhere } else { SilenceRule::Covered };
            let sectors = SectorTable::new(sectors).expect("sound sectors");
            Case { sectors: Some(sectors), tolerance, silence, ..case }
        },
    )
}
