//! The gains of all sectors over the directions of a log, and what follows from them: the sphere, or the horizon if all stops
//! and places have one height.
//!
//! A node names the sector that it hears best. The strength of each sector is its gain in the direction of the node, plus an
//! error, which is normal in decibels. With errors of Gumbel's law instead, the probability that sector s is the strongest
//! is `exp(G_s/β) / Σ exp(G_j/β)` (McFadden 1974), with `β = σ √2/1.702` nearest to the normal law (Camilli 1994). One time in
//! fifty a sector is any: a reflection, or a report of an earlier sweep.

use rayon::prelude::*;
use sextant_channel::{Position, SectorGains};

use super::blur::{CELLS, FINER, ROUND};
use super::law::PatternLaw;
use crate::numerics::normal::logistic_scale;
use crate::numerics::octahedron::{folded, unfolded};
use crate::numerics::whole;

/// Corners along an axis.
const CORNERS: usize = CELLS + 1;
/// How often a node names any sector.
pub(super) const ANY: f64 = 0.02;
/// Least gain in a table (dBi): none at all.
const NONE_DBI: f64 = -120.0;

/// The directions in which nodes may be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Directions {
    /// All: the octahedral map.
    Sphere,
    /// Those of the horizon, in the order of azimuths. The last corner is the first one.
    Horizon,
}

/// The gains of all sectors at the corners of the map of directions (dBi), by corner.
#[derive(Clone, Debug)]
pub(super) struct GainMap {
    directions: Directions,
    sectors: usize,
    gains_dbi: Vec<f32>,
    /// The same as factors; empty if nobody asks for them.
    powers: Vec<f32>,
    greatest_dbi: f64,
}

/// The cell of a direction, and where in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct GainCell {
    corner: usize,
    right: f64,
    up: f64,
}

impl Directions {
    /// The cell of a direction, of any length but 0.
    #[inline]
    pub(super) fn cell(self, direction: [f64; 3]) -> GainCell {
        match self {
            Self::Sphere => {
                let [u, v] = folded(direction).map(|along| 0.5 * (along + 1.0) * CELLS as f64);
                let (i, j) = (whole(u).min(CELLS - 1), whole(v).min(CELLS - 1));
                GainCell { corner: j * CORNERS + i, right: u - i as f64, up: v - j as f64 }
            }
            Self::Horizon => {
                let [x, y, _] = direction;
                let across = y / (x.abs() + y.abs());
                // Rounds from 0 to 4 quarters.
                let quarters = if x < 0.0 {
                    2.0 - across
                } else if across < 0.0 {
                    4.0 + across
                } else {
                    across
                };
                let along = 0.25 * quarters * ROUND as f64;
                let corner = whole(along).min(ROUND - 1);
                GainCell { corner, right: along - corner as f64, up: 0.0 }
            }
        }
    }

    /// The directions of all corners, by rows.
    fn corners(self) -> Vec<[f64; 3]> {
        match self {
            Self::Sphere => {
                let at = |i: usize| 2.0 * i as f64 / CELLS as f64 - 1.0;
                (0..CORNERS * CORNERS).map(|corner| unfolded(at(corner % CORNERS), at(corner / CORNERS))).collect()
            }
            Self::Horizon => (0..=ROUND)
                .map(|corner| {
                    let quarters = 4.0 * corner as f64 / ROUND as f64;
                    let x = (quarters - 2.0).abs() - 1.0;
                    let y = if quarters < 2.0 { 1.0 - (quarters - 1.0).abs() } else { (quarters - 3.0).abs() - 1.0 };
                    [x, y, 0.0]
                })
                .collect(),
        }
    }

    /// The means of each column over the corners within `radius` cells of the octahedral map of each corner.
    fn averaged(self, values: &[f32], columns: usize, radius: usize) -> Vec<f32> {
        match self {
            Self::Sphere => averaged(values, columns, radius),
            Self::Horizon => averaged_round(values, columns, radius * FINER),
        }
    }
}

impl GainCell {
    /// Corners along the horizon.
    #[inline]
    pub(super) fn along(self) -> f64 {
        self.corner as f64 + self.right
    }

    /// The value of a column, interpolated between the corners.
    #[inline]
    fn value(self, values: &[f32], columns: usize, column: usize) -> f64 {
        let at = |corner: usize| f64::from(values[corner * columns + column]);
        let along = |corner: usize| {
            let low = at(corner);
            low + self.right * (at(corner + 1) - low)
        };
        let low = along(self.corner);
        if self.up <= 0.0 {
            return low;
        }
        low + self.up * (along(self.corner + CORNERS) - low)
    }
}

impl GainMap {
    pub(super) fn new(gains: &SectorGains, directions: Directions) -> Self {
        let sectors = gains.identities().len();
        let of_corner = |all: &mut Vec<f64>, direction: [f64; 3]| {
            let direction = Position::from(direction);
            let length = direction.dot(direction).sqrt();
            gains.all_dbi(direction * (1.0 / length), all);
            all.iter().map(|gain| single(gain.max(NONE_DBI))).collect::<Vec<f32>>()
        };
        let gains_dbi: Vec<Vec<f32>> = directions.corners().into_par_iter().map_init(Vec::new, of_corner).collect();
        let gains_dbi = gains_dbi.concat();
        let greatest_dbi = f64::from(highest(&gains_dbi));
        Self { directions, sectors, gains_dbi, powers: Vec::new(), greatest_dbi }
    }

    /// The same, also with factors.
    pub(super) fn with_powers(self) -> Self {
        let factor = |gain: &f32| single(libm::pow(10.0, 0.1 * f64::from(*gain)));
        Self { powers: self.gains_dbi.par_iter().map(factor).collect(), ..self }
    }

    /// Adds `weight` times the gains of all sectors, as factors, to `sums`.
    #[inline]
    pub(super) fn add_powers(&self, cell: GainCell, weight: f64, sums: &mut [f64]) {
        let mut add = |corner: usize, share: f64| {
            let row = &self.powers[corner * self.sectors..(corner + 1) * self.sectors];
            sums.iter_mut().zip(row).for_each(|(sum, &power)| *sum += share * f64::from(power));
        };
        let GainCell { corner, right, up } = cell;
        let of_row = weight * (1.0 - up);
        add(corner, of_row * (1.0 - right));
        add(corner + 1, of_row * right);
        if up > 0.0 {
            add(corner + CORNERS, weight * up * (1.0 - right));
            add(corner + CORNERS + 1, weight * up * right);
        }
    }

    /// The directions that it covers.
    #[inline]
    pub(super) fn directions(&self) -> Directions {
        self.directions
    }

    /// Number of sectors.
    pub(super) fn sectors(&self) -> usize {
        self.sectors
    }

    /// The greatest gain of any sector in any direction (dBi).
    pub(super) fn greatest_dbi(&self) -> f64 {
        self.greatest_dbi
    }

    /// The median over all directions of the greatest gain of any sector (dBi).
    pub(super) fn usual_dbi(&self) -> f64 {
        let mut best: Vec<f32> = self.gains_dbi.chunks(self.sectors).map(highest).collect();
        let middle = best.len() / 2;
        f64::from(*best.select_nth_unstable_by(middle, f32::total_cmp).1)
    }

    /// The gain of a sector (dBi).
    #[inline]
    pub(super) fn gain_dbi(&self, cell: GainCell, sector: usize) -> f64 {
        cell.value(&self.gains_dbi, self.sectors, sector)
    }

    /// The gains of all sectors at a corner (dBi).
    pub(super) fn gains_at(&self, corner: usize) -> &[f32] {
        &self.gains_dbi[corner * self.sectors..(corner + 1) * self.sectors]
    }

    /// The greatest gain of all sectors towards nodes in each direction under `law`: means over so many corners on each side
    /// of a direction.
    pub(super) fn tops(&self, law: &PatternLaw, radius: usize) -> Tops {
        let tops = self.gains_dbi.chunks(self.sectors).map(|gains| single(top(gains, law))).collect();
        Tops { dbi: self.averaged(tops, 1, radius) }
    }

    /// What nodes in each direction name under `law`: means over so many corners on each side of a direction.
    pub(super) fn names(&self, law: &PatternLaw, radius: usize) -> Names {
        let scale_db = logistic_scale(law.noise_db);
        let any = single(ANY / self.sectors as f64);
        let mut ln = vec![0.0_f32; self.gains_dbi.len()];
        for (names, gains) in ln.chunks_mut(self.sectors).zip(self.gains_dbi.chunks(self.sectors)) {
            let top = top(gains, law);
            let share = |gain: f32, ripple: f64| libm::exp(((f64::from(gain) + ripple - top) / scale_db).max(-40.0));
            let sum: f64 = gains.iter().zip(&law.ripple_db).map(|(&gain, &ripple)| share(gain, ripple)).sum();
            for ((name, &gain), &ripple) in names.iter_mut().zip(gains).zip(&law.ripple_db) {
                *name = single((1.0 - ANY) * share(gain, ripple) / sum);
            }
        }
        let mut ln = self.averaged(ln, self.sectors, radius);
        ln.iter_mut().for_each(|name| *name = libm::logf(*name + any));
        Names { sectors: self.sectors, ln }
    }

    fn averaged(&self, values: Vec<f32>, columns: usize, radius: usize) -> Vec<f32> {
        if radius > 0 { self.directions.averaged(&values, columns, radius) } else { values }
    }
}

/// The greatest of some gains with their ripple (dBi).
fn top(gains: &[f32], law: &PatternLaw) -> f64 {
    gains.iter().zip(&law.ripple_db).fold(f64::NEG_INFINITY, |top, (&gain, ripple)| top.max(f64::from(gain) + ripple))
}

/// For each corner of the map of directions, the greatest gain of all sectors.
#[derive(Clone, Debug)]
pub(super) struct Tops {
    dbi: Vec<f32>,
}

/// For each corner of the map of directions, the logarithm of the probability of each sector.
#[derive(Clone, Debug)]
pub(super) struct Names {
    sectors: usize,
    ln: Vec<f32>,
}

impl Tops {
    /// The greatest gain of all sectors (dBi).
    #[inline]
    pub(super) fn dbi(&self, cell: GainCell) -> f64 {
        cell.value(&self.dbi, 1, 0)
    }
}

impl Names {
    /// The logarithm of the probability that a node there names a sector.
    #[inline]
    pub(super) fn ln_probability(&self, cell: GainCell, sector: usize) -> f64 {
        cell.value(&self.ln, self.sectors, sector)
    }
}

/// The means of each column over the corners within `radius` of each corner along both axes of the map.
fn averaged(values: &[f32], columns: usize, radius: usize) -> Vec<f32> {
    let within = |at: usize| at.saturating_sub(radius)..(at + radius + 1).min(CORNERS);
    let row = CORNERS * columns;
    let mut along = vec![0.0_f32; values.len()];
    along.chunks_mut(row).zip(values.chunks(row)).for_each(|(means, values)| {
        for (i, mean) in means.chunks_mut(columns).enumerate() {
            average(mean, within(i).map(|corner| &values[corner * columns..(corner + 1) * columns]));
        }
    });
    let mut means = vec![0.0_f32; values.len()];
    means.chunks_mut(row).enumerate().for_each(|(j, mean)| {
        average(mean, within(j).map(|corner| &along[corner * row..(corner + 1) * row]));
    });
    means
}

/// The means of each column over the corners within `radius` of each corner of the horizon.
fn averaged_round(values: &[f32], columns: usize, radius: usize) -> Vec<f32> {
    let row = |at: usize| &values[(at % ROUND) * columns..(at % ROUND + 1) * columns];
    let share = 1.0 / (2 * radius + 1) as f64;
    let mut sums = vec![0.0_f64; columns];
    for at in 0..=2 * radius {
        sums.iter_mut().zip(row(at + ROUND - radius)).for_each(|(sum, &value)| *sum += f64::from(value));
    }
    let mut means = Vec::with_capacity(values.len());
    for at in 0..=ROUND {
        means.extend(sums.iter().map(|&sum| single(share * sum)));
        let (first, next) = (row(at + ROUND - radius), row(at + radius + 1));
        for ((sum, &first), &next) in sums.iter_mut().zip(first).zip(next) {
            *sum += f64::from(next) - f64::from(first);
        }
    }
    means
}

/// Sets `mean` to that of some slices of its length.
fn average<'a>(mean: &mut [f32], slices: impl ExactSizeIterator<Item = &'a [f32]>) {
    let share = 1.0 / slices.len() as f32;
    for slice in slices {
        mean.iter_mut().zip(slice).for_each(|(mean, value)| *mean += share * value);
    }
}

fn highest(gains: &[f32]) -> f32 {
    gains.iter().copied().fold(f32::NEG_INFINITY, f32::max)
}

#[expect(clippy::cast_possible_truncation, reason = "tables are in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}
