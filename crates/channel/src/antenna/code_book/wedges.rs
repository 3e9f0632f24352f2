//! The directions of the sectors of a code book.

use super::CodeBook;
use super::steps::Steps;
use crate::antenna::sector::{SectorConfig, SectorDirections};

impl CodeBook {
    /// The wedge of each sector: the smallest interval of azimuth and of elevation that has all directions of the grid
    /// where it is the best; if there are none, the direction of its own greatest gain. A step more on each side has
    /// the directions in between where it is still the best.
    pub(in crate::antenna) fn table(&self) -> SectorDirections {
        let (columns, count) = (self.azimuths.count, self.azimuths.count * self.elevations.count);
        let sectors = self.identities.len();
        let best_of_cell: Vec<usize> = (0..count)
            .map(|cell| {
                let gain = |sector: usize| self.gains_dbi[sector * count + cell];
                (1..sectors).fold(0, |best, sector| if gain(sector) > gain(best) { sector } else { best })
            })
            .collect();
        let wedges = (0..self.sector_count()).map(|sector| {
            let index = usize::from(sector);
            let mut cells: Vec<usize> = (0..count).filter(|&cell| best_of_cell[cell] == index).collect();
            if cells.is_empty() {
                let gains = &self.gains_dbi[index * count..(index + 1) * count];
                let peak = (1..count).fold(0, |peak, cell| if gains[cell] > gains[peak] { cell } else { peak });
                cells.push(peak);
            }
            let mut of_column = vec![false; columns];
            cells.iter().for_each(|cell| of_column[cell % columns] = true);
            let (first, last) = self.arc(&of_column);
            let rows = || cells.iter().map(|cell| cell / columns);
            let elevation = self.elevations_of(rows().min().unwrap_or(0), rows().max().unwrap_or(0));
            SectorConfig {
                sector: self.identities[index],
                azimuth_from_deg: first,
                azimuth_to_deg: last,
                elevation_from_deg: elevation[0],
                elevation_to_deg: elevation[1],
            }
        });
        SectorDirections::new(wedges).expect("intervals of a grid are ascending, and each sector has one")
    }

    /// The smallest arc of azimuth that has all marked columns (degrees).
    fn arc(&self, marked: &[bool]) -> (f64, f64) {
        let Steps { first_deg, step_deg, count } = self.azimuths;
        let columns: Vec<usize> = (0..count).filter(|&column| marked[column]).collect();
        // The widest gap between neighbouring columns, around the circle.
        let turn = 360.0 / step_deg;
        let gap = |i: usize| match columns.get(i + 1) {
            Some(&next) => (next - columns[i]) as f64,
            None => columns[0] as f64 + turn - columns[i] as f64,
        };
        let widest =
            (0..columns.len()).fold(columns.len() - 1, |best, i| if gap(i) > gap(best) + 1e-6 { i } else { best });
        let first = columns[(widest + 1) % columns.len()];
        let from = first_deg + first as f64 * step_deg - step_deg;
        let width = 360.0 - gap(widest) * step_deg + 2.0 * step_deg;
        (from, from + width.min(360.0))
    }

    /// The elevations of these rows of the grid (degrees). Without a gain outside, the outermost rows reach straight up
    /// and down. A planar cut reaches as far as it holds.
    fn elevations_of(&self, lowest: usize, highest: usize) -> [f64; 2] {
        let Steps { first_deg, step_deg, count } = self.elevations;
        if count == 1 {
            let half_deg = self.cut_half_deg;
            return [(first_deg - half_deg).max(-90.0), (first_deg + half_deg).min(90.0)];
        }
        let holds = self.outside_dbi.is_none();
        let low = if holds && lowest == 0 { -90.0 } else { first_deg + step_deg * (lowest as f64 - 1.0) };
        let high = if holds && highest + 1 == count { 90.0 } else { first_deg + step_deg * (highest as f64 + 1.0) };
        [low.max(-90.0), high.min(90.0)]
    }
}
