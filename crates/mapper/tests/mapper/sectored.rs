//! Surveys of a room by two radios, one of them with an antenna array, whose truth only the tests know.

mod estimates;
mod joint;

use sextant_channel::{EvenSectorsConfig, Position, Reception, ReceptionLog, SectorConfig, SectorTable, Stop};
use sextant_kernel::{NodeId, Purpose, Seed};
use sextant_mapper::{MapError, TopologyMap};

/// Size of the room (m). The robot drives on the floor.
const ROOM_M: [f64; 3] = [12.0, 9.0, 2.5];
/// Rings of the antenna array: it sees nothing below the floor.
const RINGS_DEG: [[f64; 2]; 2] = [[0.0, 50.0], [50.0, 90.0]];

/// A radio of the robot.
#[derive(Clone, Copy)]
struct Radio {
    /// Nothing is received farther away (m).
    range_m: f64,
    /// Packets of a node at a stop.
    packets: u32,
    /// Sectors of a ring; 0 for an antenna without.
    sectors: u8,
    /// Standard deviation of the direction from which a node seems to be heard (degrees).
    noise_deg: f64,
    /// Standard deviation of the error of each sector's strength (dB). If above 0, a node names the strongest sector.
    sigma_db: f64,
    /// Rings of sectors.
    rings_deg: &'static [[f64; 2]],
}

const RF: Radio = Radio { range_m: 9.0, packets: 1, sectors: 0, noise_deg: 0.0, sigma_db: 0.0, rings_deg: &[] };
const ARRAY: Radio =
    Radio { range_m: 7.0, packets: 1, sectors: 16, noise_deg: 3.0, sigma_db: 0.0, rings_deg: &RINGS_DEG };

impl Radio {
    /// Probability that a packet is received: no trapezoid.
    fn probability(&self, distance_m: f64) -> f64 {
        let share = distance_m / self.range_m;
        if share >= 1.0 { 0.0 } else { 0.96 * (1.0 - share.powi(3)) }
    }

    fn table(&self) -> Option<SectorTable> {
        let config = EvenSectorsConfig {
            azimuth_sectors: self.sectors,
            first_azimuth_deg: 0.0,
            elevations_deg: self.rings_deg.to_vec(),
        };
        (self.sectors > 0).then(|| SectorTable::try_from(config).expect("sound sectors"))
    }

    /// The sector of highest gain, plus an error for each sector, to a node at `apart` from the robot.
    fn strongest(&self, apart: Position, error: impl Fn(u8) -> f64) -> Option<u8> {
        let azimuth_deg = apart.y_m.atan2(apart.x_m).to_degrees();
        let elevation_deg = apart.z_m.atan2(apart.x_m.hypot(apart.y_m)).to_degrees();
        let strength_dbi = |sector: &SectorConfig| {
            let widths_deg = [
                sector.azimuth_to_deg - sector.azimuth_from_deg,
                sector.elevation_to_deg - sector.elevation_from_deg,
            ];
            let across = azimuth_deg - sector.azimuth_from_deg - 0.5 * widths_deg[0];
            let across = (across + 180.0).rem_euclid(360.0) - 180.0;
            let up = elevation_deg - sector.elevation_from_deg - 0.5 * widths_deg[1];
            let loss_db = 12.0 * ((across / widths_deg[0]).powi(2) + (up / widths_deg[1]).powi(2));
            let peak_dbi = 10.0 * (41_253.0 / (widths_deg[0] * widths_deg[1])).log10();
            peak_dbi - loss_db.min(30.0) + self.sigma_db * error(sector.sector)
        };
        let table = self.table()?;
        let strengths = table.iter().map(|sector| (sector.sector, strength_dbi(sector)));
        strengths.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(sector, _)| sector)
    }

    /// The sector in which a node at `apart` from the robot is heard; `None` if no sector points there.
    fn sector(&self, apart: Position, noise: [f64; 2]) -> Option<u8> {
        let [azimuth, elevation] = [apart.y_m.atan2(apart.x_m), apart.z_m.atan2(apart.x_m.hypot(apart.y_m))];
        let azimuth_deg = azimuth.to_degrees() + self.noise_deg * noise[0];
        let elevation_deg = elevation.to_degrees() + self.noise_deg * noise[1];
        let table = self.table()?;
        let found = table.iter().find(|sector| {
            let width_deg = sector.azimuth_to_deg - sector.azimuth_from_deg;
            (azimuth_deg - sector.azimuth_from_deg).rem_euclid(360.0) <= width_deg
                && (sector.elevation_from_deg..=sector.elevation_to_deg).contains(&elevation_deg)
        });
        found.map(|sector| sector.sector)
    }

    /// What the robot hears of `nodes` at `stops`.
    fn log(&self, seed: u64, nodes: &[Position], stops: &[Position]) -> ReceptionLog {
        let draw = |address| Seed(seed).uniform(Purpose::new(8), address);
        let normal = |address| Seed(seed).normal(Purpose::new(9), address);
        let mut receptions = Vec::new();
        for (node, &place) in (0_u32..).zip(nodes) {
            for (stop, &at) in (0_u32..).zip(stops) {
                let address = |what: u64| [u64::from(node), u64::from(stop), what];
                let sector = if self.sigma_db > 0.0 {
                    self.strongest(place - at, |sector| normal(address(100 + u64::from(sector))))
                } else {
                    self.sector(place - at, [normal(address(0)), normal(address(1))])
                };
                let p =
                    if self.sectors > 0 && sector.is_none() { 0.0 } else { self.probability(place.distance_m(at)) };
                let packets = (0..self.packets).filter(|&packet| draw(address(u64::from(packet))) < p).count();
                let received = u32::try_from(packets).expect("a few packets");
                if received > 0 || self.packets > 1 {
                    let (node, sector) = (NodeId(node), sector.filter(|_| received > 0));
                    let sent = self.packets;
                    receptions.push(Reception { sector, ..Reception::heard(node, stop, received, sent) });
                }
            }
        }
        let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
        let at = |&position: &Position| Stop::at(position);
        let log = ReceptionLog::new(names, stops.iter().map(at).collect(), receptions, Vec::new()).expect("a log");
        match self.table() {
            Some(table) => log.with_sectors(table).expect("sectors of the table"),
            None => log,
        }
    }
}

fn nodes(seed: u64, count: u64) -> Vec<Position> {
    let draw = |i, axis: usize| ROOM_M[axis] * Seed(seed).uniform(Purpose::new(8), [i, axis as u64, 77]);
    (0..count).map(|i| Position::new(draw(i, 0), draw(i, 1), draw(i, 2))).collect()
}

/// Lanes along x, `apart_m` from each other and with stops `apart_m` apart, on the floor.
fn lanes(apart_m: f64) -> Vec<Position> {
    let along =
        |length_m: f64| (0_u32..).map(move |i| apart_m * (f64::from(i) + 0.5)).take_while(move |&at| at < length_m);
    along(ROOM_M[1]).flat_map(|y| along(ROOM_M[0]).map(move |x| Position::new(x, y, 0.0))).collect()
}

/// Mean distance of the nodes from their places (m), and how many are not mapped.
fn mean_error_m(map: &Result<TopologyMap, MapError>, nodes: &[Position]) -> (f64, usize) {
    let map = map.as_ref().expect("a map");
    let errors_m: Vec<f64> = map
        .positions()
        .iter()
        .zip(nodes)
        .filter_map(|(found, node)| Some(found.as_ref()?.distance_m(*node)))
        .collect();
    (errors_m.iter().sum::<f64>() / errors_m.len() as f64, map.unmapped())
}
