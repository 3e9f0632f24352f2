//! Which obstacles the log is evidence of: regions of cells that absorb, each tested by nodes that did not show it.

use crate::numerics::whole;

/// Absorption of a cell that is too small to matter.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;

/// A cell counts if it absorbs at least [`EDGE`] of what [`STRONG`] of the absorbing cells do not exceed: tomography smears
/// obstacles, so that cells around them absorb a little.
const EDGE: f64 = 0.25;
const STRONG: f64 = 0.9;
/// Lines cross if they are not nearly parallel: the length of the mean of their doubled directions, weighted by evidence, is at
/// most this. Two bundles of lines have it at an angle of 18 degrees.
const PARALLEL: f64 = 0.95;
/// A region is an obstacle if it explains the receptions of other nodes by this many standard deviations.
const SURE: f64 = 3.0;
/// An obstacle of which the log is sure has at least this many cells: of many small regions, some have that much evidence by
/// chance.
const FEWEST: usize = 4;
/// With less evidence it is not claimed at all: the 95 % quantile of the normal distribution.
const WEAK: f64 = 1.645;

/// The evidence of the absorption of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CellEvidence {
    /// Fisher information of its absorption where nothing absorbs: that by which chance is judged.
    pub(crate) information: f64,
    /// Sums of the cosines and of the sines of twice the directions of its lines, weighted by their information.
    pub(crate) directions: [f64; 2],
}

impl CellEvidence {
    /// Adds a line of this information with the cosine and the sine of twice its direction.
    pub(crate) fn add(&mut self, information: f64, doubled: [f64; 2]) {
        self.information += information;
        self.directions[0] += information * doubled[0];
        self.directions[1] += information * doubled[1];
    }

    /// The same of two sets of lines.
    pub(crate) fn joined(self, other: &Self) -> Self {
        let [x, y] = [0, 1].map(|axis| self.directions[axis] + other.directions[axis]);
        Self { information: self.information + other.information, directions: [x, y] }
    }

    /// Whether the lines cross.
    fn crosses(&self) -> bool {
        self.information > 0.0 && libm::hypot(self.directions[0], self.directions[1]) <= PARALLEL * self.information
    }
}

/// The cells of a map with this many columns that are `cell` or touch it.
fn around(cell: usize, cells: usize, columns: usize) -> impl Iterator<Item = usize> {
    let (i, j, rows) = (cell % columns, cell / columns, cells / columns);
    let beside =
        move |row: usize| (i.saturating_sub(1)..=(i + 1).min(columns - 1)).map(move |column| row * columns + column);
    (j.saturating_sub(1)..=(j + 1).min(rows - 1)).flat_map(beside)
}

/// A region of cells that absorb.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleClaim {
    /// Its cells: columns and rows of the map.
    pub cells: Vec<[usize; 2]>,
    /// Its area (m²).
    pub area_m2: f64,
    /// How much better the receptions of nodes are explained with it than without it, in standard deviations of the sum over
    /// nodes. Absorption of each half of the nodes is tried on the other half.
    pub evidence: f64,
    /// Whether the evidence is above three standard deviations and the region has at least four cells; otherwise the obstacle is
    /// unsure.
    pub is_sure: bool,
}

impl ObstacleClaim {
    /// The claim of these cells, each `cell_m` wide. `gains` are the gains in log-likelihood of the nodes. `None` if these may be
    /// due to chance.
    pub(crate) fn new(cells: Vec<[usize; 2]>, cell_m: f64, gains: impl Iterator<Item = f64>) -> Option<Self> {
        let (sum, squares) = gains.fold((0.0, 0.0), |(sum, squares), gain| (sum + gain, squares + gain * gain));
        let evidence = if squares > 0.0 { sum / squares.sqrt() } else { 0.0 };
        let is_sure = evidence > SURE && cells.len() >= FEWEST;
        let area_m2 = cells.len() as f64 * cell_m * cell_m;
        (evidence > WEAK).then_some(Self { area_m2, cells, evidence, is_sure })
    }
}

/// The number of the region of each cell of a map with this many columns, and the number of regions. A region is a set of
/// neighbouring cells that absorb much, and where lines cross: in the cell or beside it.
pub(crate) fn regions(cells: &[f64], evidence: &[CellEvidence], columns: usize) -> (Vec<Option<usize>>, usize) {
    let mut absorbing: Vec<f64> = cells.iter().copied().filter(|&cell| cell > NEGLIGIBLE).collect();
    absorbing.sort_unstable_by(f64::total_cmp);
    let strong = absorbing.get(whole(STRONG * absorbing.len() as f64)).copied().unwrap_or(f64::INFINITY);
    let crosses = |cell: usize| {
        let near = around(cell, cells.len(), columns);
        near.fold(CellEvidence::default(), |sum, near| sum.joined(&evidence[near])).crosses()
    };
    let shown: Vec<bool> = (0..cells.len()).map(|cell| cells[cell] >= EDGE * strong && crosses(cell)).collect();
    let mut region = vec![None; cells.len()];
    let mut count = 0;
    for first in 0..cells.len() {
        if !shown[first] || region[first].is_some() {
            continue;
        }
        region[first] = Some(count);
        let mut open = vec![first];
        while let Some(cell) = open.pop() {
            for next in around(cell, cells.len(), columns) {
                if shown[next] && region[next].is_none() {
                    region[next] = Some(count);
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    (region, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evidence of lines in these directions (degrees), each of this information.
    fn lines(information: f64, directions_deg: &[f64]) -> CellEvidence {
        let mut evidence = CellEvidence::default();
        for direction_deg in directions_deg {
            let doubled = 2.0 * direction_deg.to_radians();
            evidence.add(information, [doubled.cos(), doubled.sin()]);
        }
        evidence
    }

    #[test]
    fn lines_cross_unless_they_are_nearly_parallel() {
        assert!(lines(8.0, &[0.0, 90.0]).crosses() && lines(8.0, &[0.0, 30.0]).crosses());
        assert!(!lines(8.0, &[40.0, 45.0]).crosses(), "lines are nearly parallel");
        assert!(!lines(8.0, &[10.0, 190.0]).crosses(), "there and back is one direction");
        assert!(!CellEvidence::default().crosses(), "no line says anything");
        let joined = lines(8.0, &[0.0]).joined(&lines(8.0, &[90.0]));
        assert!(joined.crosses() && (joined.information - 16.0).abs() < 1e-12);
    }

    #[test]
    fn neighbouring_cells_that_absorb_much_are_one_region() {
        // Two regions: one that turns a corner, and one cell apart from it. A dot absorbs a fifth.
        let text = ["##..", "..#.", "....", " . #"];
        let absorption = |cell| match cell {
            b'#' => 1.0,
            b'.' => 0.2,
            _ => 0.0,
        };
        let cells: Vec<f64> = text.iter().flat_map(|row| row.bytes().map(absorption)).collect();
        let evidence = vec![lines(8.0, &[0.0, 90.0]); cells.len()];
        let (region, count) = regions(&cells, &evidence, 4);
        let of: Vec<usize> = (0..cells.len()).filter(|&cell| region[cell] == Some(0)).collect();
        assert_eq!((count, of, region[15]), (2, vec![0, 1, 6], Some(1)));
        assert_eq!(regions(&cells, &vec![lines(8.0, &[20.0]); cells.len()], 4).1, 0, "no lines cross");
        assert_eq!(regions(&[0.0; 16], &evidence, 4).1, 0, "nothing absorbs");
    }

    #[test]
    fn a_claim_is_sure_if_many_nodes_agree() {
        let claim =
            |gains: &[f64]| ObstacleClaim::new(vec![[1, 2], [1, 3], [1, 4], [2, 4]], 0.5, gains.iter().copied());
        let many = claim(&[1.0; 16]).unwrap();
        assert!(many.is_sure && (many.evidence - 4.0).abs() < 1e-12 && (many.area_m2 - 1.0).abs() < 1e-12);
        assert!(!ObstacleClaim::new(vec![[1, 2]], 0.5, [1.0; 16].into_iter()).unwrap().is_sure, "one cell");
        assert!(!claim(&[1.0; 4]).unwrap().is_sure, "two standard deviations");
        assert!(claim(&[50.0, 0.1]).is_none(), "one node says it all");
        assert!(claim(&[-1.0; 16]).is_none() && claim(&[]).is_none());
    }
}
