//! Tables of what obstacles absorb round each stop, which are faster than tracing each line.

use rayon::prelude::*;
use sextant_channel::{Position, Stop};
use sextant_kernel::{Interrupted, Watch};

use crate::absorption::AbsorptionMap;
use crate::numerics::normal::index;

/// Maximum size of the tables (values). Larger surveys get coarser tables.
const MOST_VALUES: f64 = 5e7;

/// Absorption along horizontal rays from each stop that has absorbing cells near it.
#[derive(Debug, Default)]
pub(super) struct Shadows {
    /// Where the table of a stop begins; `None` for a stop without absorbing cells near it.
    first: Vec<Option<usize>>,
    /// Absorption up to each station, ray by ray.
    absorbed: Vec<f32>,
    /// Number of rays in a quarter turn.
    rays: usize,
    /// Number of stations of a ray, one more than the number of spans.
    stations: usize,
    stations_per_m: f64,
}

impl Shadows {
    /// Traces the rays again, up to `reach_m`.
    pub(super) fn trace(
        &mut self,
        map: &AbsorptionMap,
        stops: &[Stop],
        reach_m: f64,
        watch: &dyn Watch,
    ) -> Result<(), Interrupted> {
        let is_near = |stop: &Stop| {
            let Position { x_m, y_m, .. } = stop.position;
            !map.is_clear_within([x_m - reach_m, y_m - reach_m], [x_m + reach_m, y_m + reach_m])
        };
        let near: Vec<Position> = stops.iter().filter(|stop| is_near(stop)).map(|stop| stop.position).collect();
        let mut next = 0;
        let count = crate::numerics::whole;
        // Neighbouring rays are a cell apart at their ends, where a quarter turn is longest in even steps of the
        // pseudo-angle.
        let (mut rays, mut spans) = (2.0 * reach_m / map.cell_m(), reach_m / map.cell_m());
        let coarser = (near.len() as f64 * 4.0 * rays * spans / MOST_VALUES).sqrt().max(1.0);
        (rays, spans) = ((rays / coarser).ceil().max(2.0), (spans / coarser).ceil().max(2.0));
        self.rays = count(rays);
        self.stations = count(spans) + 1;
        self.stations_per_m = spans / reach_m;
        let table = 4 * self.rays * self.stations;
        self.first.clear();
        self.first.extend(stops.iter().map(|stop| {
            is_near(stop).then(|| {
                next += table;
                next - table
            })
        }));
        self.absorbed.clear();
        self.absorbed.resize(next, 0.0);
        let (rays, stations) = (self.rays, self.stations);
        self.absorbed.par_chunks_mut(table).zip(&near).try_for_each(|(table, &from)| {
            watch.check()?;
            for (ray, absorbed) in table.chunks_mut(stations).enumerate() {
                trace_ray(map, from, direction(ray, rays), reach_m, absorbed);
            }
            Ok(())
        })
    }

    /// Whether a stop has a table.
    pub(super) fn has(&self, stop: u32) -> bool {
        self.first[stop as usize].is_some()
    }

    /// What the projection on the plane of a line from a stop along `way` absorbs, by interpolation.
    #[inline]
    pub(super) fn absorbed_level(&self, stop: u32, way: [f64; 2], level_m: f64) -> f64 {
        let Some(first) = self.first[stop as usize] else { return 0.0 };
        let (rays, last) = (self.rays as f64, (self.stations - 1) as f64);
        let along = (level_m * self.stations_per_m).min(last - 1e-9);
        let across = turn(way) * rays;
        let (station, ray) = (index(along), index(across).min(4 * self.rays - 1));
        let next_ray = if ray + 1 < 4 * self.rays { ray + 1 } else { 0 };
        let (u, v) = (along - station as f64, across - ray as f64);
        let at = |ray: usize| {
            let values = &self.absorbed[first + ray * self.stations + station..][..2];
            let (near, far) = (f64::from(values[0]), f64::from(values[1]));
            near + (far - near) * u
        };
        let (right, left) = (at(ray), at(next_ray));
        right + (left - right) * v
    }
}

/// Computes what is absorbed up to each station of a ray.
fn trace_ray(map: &AbsorptionMap, from: Position, direction: [f64; 2], reach_m: f64, absorbed: &mut [f32]) {
    let gap = reach_m / (absorbed.len() - 1) as f64 / map.cell_m();
    let to = from + Position::new(direction[0], direction[1], 0.0) * reach_m;
    let mut station = 0;
    let mut at = 0.0;
    let mut sum = 0.0;
    let mut put = |until: f64, here: f64, sum: f64, rate: f64| {
        while station < absorbed.len() && at <= until {
            #[expect(clippy::cast_possible_truncation, reason = "absorption needs no precision")]
            {
                absorbed[station] = (sum + rate * (at - here).max(0.0)) as f32;
            }
            station += 1;
            at += gap;
        }
    };
    map.crossings(from, to, |cell, enter, leave| {
        let rate = map.cells[cell];
        put(enter, enter, sum, 0.0);
        put(leave, enter, sum, rate);
        sum += rate * (leave - enter);
    });
    put(f64::INFINITY, f64::INFINITY, sum, 0.0);
}

/// The direction of a ray, in equal steps of the pseudo-angle.
fn direction(ray: usize, rays: usize) -> [f64; 2] {
    let share = (ray % rays) as f64 / rays as f64;
    let (a, b) = (1.0 - share, share);
    let [x, y] = [[a, b], [-b, a], [-a, -b], [b, -a]][ray / rays];
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

/// The pseudo-angle of a direction, in quarter turns from east by north: it grows with the angle, but needs only one
/// division.
#[inline]
fn turn([x, y]: [f64; 2]) -> f64 {
    let sum = x.abs() + y.abs();
    if sum <= 0.0 {
        return 0.0;
    }
    match (x >= 0.0, y >= 0.0) {
        (true, true) => y / sum,
        (false, true) => 1.0 - x / sum,
        (false, false) => 2.0 - y / sum,
        (true, false) => 3.0 + x / sum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{RobotId, SimTime, Unwatched};

    #[test]
    fn the_pseudo_angle_undoes_the_directions() {
        for ray in 0..28 {
            let expected = f64::from(u8::try_from(ray).unwrap()) / 7.0;
            assert!((turn(direction(ray, 7)) - expected).abs() < 1e-12, "ray {ray}");
        }
    }

    #[test]
    fn the_table_holds_what_lines_absorb_but_for_the_rims_of_shadows() {
        let mut map = AbsorptionMap::new([-6.0, -6.0], [5.9, 5.9], 0.5, 1e6);
        for j in 14..18 {
            for i in 15..20 {
                map.cells[j * 24 + i] = 1.0;
            }
        }
        map.count();
        let stop = Stop {
            robot: RobotId(0),
            time: SimTime::ZERO,
            position: Position::new(-3.3, -1.2, 0.0),
            heading_rad: None,
        };
        let mut shadows = Shadows::default();
        shadows.trace(&map, &[stop], 10.0, &Unwatched).unwrap();
        assert!(shadows.has(0));
        let (mut error, mut sum, mut worst) = (0.0, 0.0, 0.0_f64);
        for i in 0..4000 {
            let angle = f64::from(i) * 0.618;
            let level_m = 10.0 * f64::from(i) / 4000.0;
            let way = [level_m * libm::cos(angle), level_m * libm::sin(angle)];
            let exact = map.absorbed_level(stop.position, stop.position + Position::new(way[0], way[1], 0.0));
            let found = shadows.absorbed_level(0, way, level_m);
            error += (found - exact).abs();
            sum += exact;
            worst = worst.max(found - exact);
        }
        assert!(sum > 100.0 && error < 0.05 * sum && worst < 1.5, "{error} of {sum}, {worst}");
    }
}
