//! The probability that a node names a sector, given the direction to it.
//!
//! A node names the sector that it hears best. The strength of each sector is its gain in the direction of the node, plus
//! an error, which is normal in decibels and independent from sector to sector. With errors of Gumbel's law instead, the
//! probability that sector s is the strongest is `exp(G_s/β) / Σ exp(G_j/β)` (McFadden 1974). Of two sectors, this is the
//! logistic law of the difference of their gains; it is nearest to the normal one for `β = σ √2/1.702` (Camilli 1994).
//!
//! The logarithms of the probabilities are in tables over the octahedral map of the sphere (Cigolle et al. 2014). A vertex
//! stands for the cell round it, which a near stop sees under a large angle. So there is a table for each doubling
//! of the distance, in which probabilities are means over that angle.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;
use sextant_channel::{SectorConfig, SectorTable, Wedge};

use super::single::single;
use crate::lattice::Lattice;
use crate::numerics::normal::logistic_scale;
use crate::numerics::octahedron::{folded, unfolded};
use crate::numerics::whole;

/// A sector is not possible where its probability is below this.
const NEGLIGIBLE: f64 = 1e-6;
/// Least probability in a table.
const LEAST: f64 = 1e-9;
/// Least and most cells along an axis of a table.
const CELLS: [f64; 2] = [32.0, 256.0];
/// Tables, at most.
const LEVELS: usize = 8;
/// Least and most directions along an axis over which a probability is averaged.
const MIDDLES: [usize; 2] = [3, 9];

/// The gains of the sectors in a direction.
#[derive(Clone, Debug)]
struct Pattern {
    wedges: Vec<(u8, Wedge)>,
    /// Gain at the middle of each sector (dBi).
    peaks_db: Vec<f64>,
    /// How far side lobes are below the peak (dB).
    side_lobe_db: f64,
    /// β (dB).
    scale_db: f64,
}

impl Pattern {
    /// Elliptical main lobes with the half-power widths of the wedges (Kraus 1988: 41 253 square degrees over a sphere).
    fn new(table: &SectorTable, sigma_db: f64, side_lobe_db: f64) -> Self {
        let wedges: Vec<(u8, Wedge)> =
            table.iter().filter_map(|sector| Some((sector.sector, sector.wedge().ok()?))).collect();
        let peak_db = |(_, wedge): &(u8, Wedge)| {
            let [azimuth, elevation] = widths(wedge).map(f64::to_degrees);
            10.0 * libm::log10(41_253.0 / (azimuth * elevation))
        };
        let peaks_db = wedges.iter().map(peak_db).collect();
        Self { wedges, peaks_db, side_lobe_db, scale_db: logistic_scale(sigma_db) }
    }

    /// Adds the probabilities of all sectors in a direction to `sums`.
    fn add(&self, direction: [f64; 3], gains: &mut [f64], sums: &mut [f64]) {
        let [azimuth, elevation] = angles(direction);
        let mut highest = f64::NEG_INFINITY;
        for (gain, ((_, wedge), &peak_db)) in gains.iter_mut().zip(self.wedges.iter().zip(&self.peaks_db)) {
            let off = off_axis(wedge, azimuth, elevation);
            let loss_db: f64 = off.iter().zip(widths(wedge)).map(|(off, width)| 12.0 * (off / width).powi(2)).sum();
            *gain = peak_db - loss_db.min(self.side_lobe_db);
            highest = highest.max(*gain);
        }
        for gain in gains.iter_mut() {
            let exponent = (*gain - highest) / self.scale_db;
            *gain = if exponent > -40.0 { libm::exp(exponent) } else { 0.0 };
        }
        let sum: f64 = gains.iter().sum();
        sums.iter_mut().zip(&*gains).for_each(|(total, weight)| *total += weight / sum);
    }
}

/// Azimuth and elevation of a direction (rad).
fn angles([x, y, z]: [f64; 3]) -> [f64; 2] {
    [libm::atan2(y, x), libm::atan2(z, (x * x + y * y).sqrt())]
}

/// Widths of a wedge in azimuth and elevation (rad).
fn widths(wedge: &Wedge) -> [f64; 2] {
    [wedge.azimuth_width_rad, wedge.elevation_rad[1] - wedge.elevation_rad[0]]
}

/// Azimuth and elevation from the middle of a wedge (rad).
fn off_axis(wedge: &Wedge, azimuth: f64, elevation: f64) -> [f64; 2] {
    let middle = wedge.azimuth_from_rad + 0.5 * wedge.azimuth_width_rad;
    let across = (azimuth - middle + PI).rem_euclid(TAU) - PI;
    [across, elevation - 0.5 * (wedge.elevation_rad[0] + wedge.elevation_rad[1])]
}

/// The probabilities of the sectors of a listener.
#[derive(Clone, Debug)]
pub(crate) struct SoftSectors {
    pattern: Pattern,
    /// The place of each sector in the tables, by its identity.
    column: Vec<usize>,
    columns: usize,
    /// From the farthest vertices to the nearest ones.
    levels: Vec<Level>,
}

/// A table for the vertices beyond a distance.
#[derive(Clone, Debug)]
struct Level {
    /// The square of the distance (m²).
    beyond_squared: f64,
    /// Number of cells along an axis of the map.
    cells: usize,
    /// Logarithms of the probabilities of all sectors at each corner of the cells, by rows.
    values: Vec<f32>,
}

impl SoftSectors {
    /// The sectors of `table`, whose strengths have errors of `sigma_db` and side lobes that are `side_lobe_db` below
    /// the peak.
    pub(crate) fn new(
        table: &SectorTable,
        sigma_db: f64,
        side_lobe_db: f64,
        lattice: &Lattice,
        range_m: f64,
    ) -> Self {
        let pattern = Pattern::new(table, sigma_db, side_lobe_db);
        let columns = pattern.wedges.len();
        let mut column = vec![usize::MAX; 256];
        for (at, &(id, _)) in pattern.wedges.iter().enumerate() {
            column[usize::from(id)] = at;
        }
        let narrowest = pattern.wedges.iter().flat_map(|(_, wedge)| widths(wedge)).fold(PI, f64::min);
        let step_m = lattice.step_m();
        let mut levels = Vec::new();
        let mut distance_m = range_m;
        while levels.len() < LEVELS {
            let angle = libm::atan(step_m / distance_m);
            let is_last = distance_m <= step_m || levels.len() + 1 == LEVELS;
            // Over this angle the ratio of the probabilities of two sectors changes by a factor of e at their edge.
            let change = narrowest * pattern.scale_db / 24.0;
            let cells = (2.0 * PI / change.max(angle)).clamp(CELLS[0], CELLS[1]);
            let beyond_squared = if is_last { 0.0 } else { 0.5 * distance_m * distance_m };
            levels.push(Level::new(&pattern, whole(cells.ceil()), angle, beyond_squared));
            if is_last {
                break;
            }
            distance_m *= 0.5;
        }
        Self { pattern, column, columns, levels }
    }

    /// The logarithm of the probability that a node at `apart` from the stop names `sector`.
    pub(crate) fn ln_probability(&self, sector: u8, [x, y, z]: [f64; 3]) -> f64 {
        let column = self.column[usize::from(sector)];
        let square = x * x + y * y + z * z;
        let level = self.levels.iter().find(|level| square >= level.beyond_squared);
        match level {
            Some(level) if column < self.columns && square > 1e-18 => level.at([x, y, z], column, self.columns),
            _ => 0.0,
        }
    }

    /// The directions from which each sector may be named, as a table of wider wedges. Directions far from all sectors do
    /// not count.
    pub(crate) fn possible(&self, table: &SectorTable) -> SectorTable {
        let Some(level) = self.levels.first() else { return table.clone() };
        let wedges: Vec<Wedge> = table.iter().filter_map(|sector| sector.wedge().ok()).collect();
        let mut reach: Vec<[[f64; 2]; 2]> =
            wedges.iter().map(|wedge| widths(wedge).map(|width| [-0.5 * width, 0.5 * width])).collect();
        let mut gains = vec![0.0; self.columns];
        let mut probabilities = gains.clone();
        for direction in level.directions() {
            let [azimuth, elevation] = angles(direction);
            let is_near = |wedge: &Wedge| {
                off_axis(wedge, azimuth, elevation).iter().zip(widths(wedge)).all(|(off, width)| off.abs() <= width)
            };
            // Right above the stop there is no azimuth.
            if direction[0].abs().max(direction[1].abs()) < 1e-9 || !wedges.iter().any(is_near) {
                continue;
            }
            probabilities.fill(0.0);
            self.pattern.add(direction, &mut gains, &mut probabilities);
            for ((wedge, reach), &probability) in wedges.iter().zip(&mut reach).zip(&probabilities) {
                if probability >= NEGLIGIBLE {
                    for (reach, off) in reach.iter_mut().zip(off_axis(wedge, azimuth, elevation)) {
                        *reach = [reach[0].min(off), reach[1].max(off)];
                    }
                }
            }
        }
        let margin_deg = 270.0 / level.cells as f64;
        let wider = table.iter().zip(&wedges).zip(&reach).map(|((sector, wedge), [azimuth, elevation])| {
            let middle = |low: f64, high: f64| 0.5 * (low + high);
            let azimuth_deg = (wedge.azimuth_from_rad + 0.5 * wedge.azimuth_width_rad).to_degrees();
            let elevation_deg = middle(wedge.elevation_rad[0], wedge.elevation_rad[1]).to_degrees();
            let from = azimuth_deg + azimuth[0].to_degrees() - margin_deg;
            let width_deg = (azimuth[1] - azimuth[0]).to_degrees() + 2.0 * margin_deg;
            SectorConfig {
                sector: sector.sector,
                azimuth_from_deg: from,
                azimuth_to_deg: from + width_deg.min(360.0),
                elevation_from_deg: (elevation_deg + elevation[0].to_degrees() - margin_deg).max(-90.0),
                elevation_to_deg: (elevation_deg + elevation[1].to_degrees() + margin_deg).min(90.0),
            }
        });
        SectorTable::new(wider).unwrap_or_else(|_| table.clone())
    }
}

impl Level {
    /// The table with probabilities that are means over the angle under which a cell of the lattice is seen.
    fn new(pattern: &Pattern, cells: usize, angle: f64, beyond_squared: f64) -> Self {
        let columns = pattern.wedges.len();
        let mut level = Self { beyond_squared, cells, values: Vec::new() };
        let directions: Vec<[f64; 3]> = level.directions().collect();
        let narrowest = pattern
            .wedges
            .iter()
            .map(|(_, wedge)| widths(wedge))
            .fold([PI; 2], |a, b| [0, 1].map(|i| a[i].min(b[i])));
        let [across, up] = narrowest.map(|width| middles(angle, 0.5 * width));
        let rows: Vec<Vec<f32>> = directions
            .par_chunks(cells + 1)
            .map(|row| {
                let (mut gains, mut sums) = (vec![0.0; columns], vec![0.0; columns]);
                let mut values = Vec::with_capacity(row.len() * columns);
                for &direction in row {
                    sums.fill(0.0);
                    for &along in &across {
                        for &up in &up {
                            pattern.add(turned(direction, along, up), &mut gains, &mut sums);
                        }
                    }
                    let mean = 1.0 / (across.len() * up.len()) as f64;
                    values.extend(sums.iter().map(|sum| single(libm::log((sum * mean).max(LEAST)))));
                }
                values
            })
            .collect();
        level.values = rows.concat();
        level
    }

    /// The directions of the corners of the cells, by rows.
    fn directions(&self) -> impl Iterator<Item = [f64; 3]> + use<> {
        let cells = self.cells;
        let at = move |i: usize| 2.0 * i as f64 / cells as f64 - 1.0;
        (0..=cells).flat_map(move |row| (0..=cells).map(move |column| unfolded(at(column), at(row))))
    }

    /// The value of a column in the direction of `apart`, interpolated between the four corners of its cell.
    #[inline]
    fn at(&self, apart: [f64; 3], column: usize, columns: usize) -> f64 {
        let [u, v] = folded(apart).map(|along| 0.5 * (along + 1.0) * self.cells as f64);
        let (i, j) = (whole(u).min(self.cells - 1), whole(v).min(self.cells - 1));
        let (right, up) = (u - i as f64, v - j as f64);
        let corner = |i: usize, j: usize| f64::from(self.values[(j * (self.cells + 1) + i) * columns + column]);
        let [low, high] = [j, j + 1].map(|j| corner(i, j) + right * (corner(i + 1, j) - corner(i, j)));
        low + up * (high - low)
    }
}

/// The middles of equal parts of an angle, each at most `part` wide as far as there are not too many.
fn middles(angle: f64, part: f64) -> Vec<f64> {
    let count = whole((angle / part).ceil()).clamp(MIDDLES[0], MIDDLES[1]);
    (0..count).map(|i| angle * ((i as f64 + 0.5) / count as f64 - 0.5)).collect()
}

/// A direction turned by small angles, along a parallel and along a meridian.
fn turned([x, y, z]: [f64; 3], along: f64, up: f64) -> [f64; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    let across = (x * x + y * y).sqrt();
    let east = if across > 0.0 { [-y / across, x / across, 0.0] } else { [1.0, 0.0, 0.0] };
    let [x, y, z] = [x, y, z].map(|component| component / length);
    let north = [y * east[2] - z * east[1], z * east[0] - x * east[2], x * east[1] - y * east[0]];
    let (along, up) = (libm::tan(along), libm::tan(up));
    [x + along * east[0] + up * north[0], y + along * east[1] + up * north[1], z + up * north[2]]
}

#[cfg(test)]
mod tests {
    use sextant_channel::{EvenSectorsConfig, Position};
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    fn table(azimuth_sectors: u8, elevations_deg: Vec<[f64; 2]>) -> SectorTable {
        let config = EvenSectorsConfig { azimuth_sectors, first_azimuth_deg: 0.0, elevations_deg };
        SectorTable::try_from(config).expect("sound sectors")
    }

    fn soft(table: &SectorTable, sigma_db: f64) -> SoftSectors {
        SoftSectors::new(table, sigma_db, 30.0, &Lattice::new(Position::ORIGIN, 0.01, [9, 9, 9]), 10.0)
    }

    fn towards(azimuth_deg: f64, elevation_deg: f64, distance_m: f64) -> [f64; 3] {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let across = distance_m * elevation.cos();
        [across * azimuth.cos(), across * azimuth.sin(), distance_m * elevation.sin()]
    }

    #[test]
    fn probabilities_are_those_of_the_strongest_of_sectors_with_normal_errors() {
        // Each of 20 000 draws: 8 gains in decibels, 45 degrees wide, with normal errors; the strongest is named.
        let table = table(8, vec![[-90.0, 90.0]]);
        for sigma_db in [1.0, 2.0] {
            let soft = soft(&table, sigma_db);
            for azimuth_deg in [0.0, 10.0, 20.0, 22.5, 31.0] {
                let mut named = [0_u32; 8];
                for draw in 0..20_000 {
                    let strength = |sector: usize| {
                        let off = (azimuth_deg - 45.0 * sector as f64 + 180.0_f64).rem_euclid(360.0) - 180.0;
                        let gain = -(12.0 * (off / 45.0).powi(2)).min(30.0);
                        gain + sigma_db * Seed(3).normal(Purpose::new(8), [draw, sector as u64, 0])
                    };
                    let best = (0..8).max_by(|&a, &b| strength(a).total_cmp(&strength(b))).unwrap();
                    named[best] += 1;
                }
                for (sector, &count) in (0_u8..).zip(&named) {
                    let found = soft.ln_probability(sector, towards(azimuth_deg, 0.0, 9.0)).exp();
                    let drawn = f64::from(count) / 20_000.0;
                    assert!((found - drawn).abs() < 0.03, "{sigma_db} dB, {azimuth_deg}: {sector}: {found}, {drawn}");
                }
            }
        }
    }

    #[test]
    fn probabilities_of_all_sectors_sum_to_one_in_every_direction() {
        let table = table(16, vec![[0.0, 50.0], [50.0, 90.0]]);
        let soft = soft(&table, 1.5);
        for i in 0..500 {
            let draw = |axis| Seed(1).uniform(Purpose::new(8), [i, axis, 0]) - 0.5;
            let apart = [draw(0), draw(1), draw(2)].map(|component| 8.0 * component);
            let sum: f64 = (0..32).map(|sector| soft.ln_probability(sector, apart).exp()).sum();
            // Between the values of the table the logarithms are interpolated.
            assert!((sum - 1.0).abs() < 0.1, "{apart:?}: {sum}");
        }
        assert!(soft.ln_probability(3, [0.0; 3]).abs() < 1e-12, "at the stop");
    }

    #[test]
    fn near_a_stop_a_sector_says_little() {
        let table = table(16, vec![[-90.0, 90.0]]);
        let lattice = Lattice::new(Position::ORIGIN, 0.5, [9, 9, 1]);
        let soft = SoftSectors::new(&table, 1.5, 30.0, &lattice, 10.0);
        // More than a sector off: impossible far away, not so where a cell of the lattice is wider than the sectors.
        let off = |distance_m: f64| soft.ln_probability(0, towards(30.0, 0.0, distance_m));
        assert!(off(9.0) < -9.0 && off(0.3) > -4.0, "{} {}", off(9.0), off(0.3));
        let possible = soft.possible(&table);
        let first = possible.iter().next().unwrap();
        let width_deg = first.azimuth_to_deg - first.azimuth_from_deg;
        assert!((35.0..90.0).contains(&width_deg), "{width_deg}");
    }
}
