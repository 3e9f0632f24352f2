//! Lines of few corners.

use sextant_channel::nearest_on_line;

/// A place in cells.
pub(super) type Cell = [f64; 2];

pub(super) fn distance(a: Cell, b: Cell) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// The line with fewer corners, none of which left out is farther away from it than `tolerance` (U. Ramer 1972; D. H. Douglas,
/// T. K. Peucker 1973). A line that ends where it begins stays closed.
pub(super) fn simplified(line: &[Cell], tolerance: f64) -> Vec<Cell> {
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return Vec::new() };
    if line.len() > 3 && distance(first, last) <= 0.0 {
        let far = (0..line.len()).max_by(|&a, &b| distance(line[a], first).total_cmp(&distance(line[b], first)));
        let far = far.unwrap_or(0);
        let mut half = simplified(&line[..=far], tolerance);
        half.pop();
        half.extend(simplified(&line[far..], tolerance));
        return half;
    }
    let mut kept = vec![false; line.len()];
    (kept[0], kept[line.len() - 1]) = (true, true);
    let mut open = vec![(0, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let between = from + 1..to;
        let off = |at: &usize| nearest_on_line(line[*at], line[from], line[to]).1;
        if let Some(worst) = between.max_by(|a, b| off(a).total_cmp(&off(b)))
            && off(&worst) > tolerance
        {
            kept[worst] = true;
            open.extend([(from, worst), (worst, to)]);
        }
    }
    line.iter().zip(kept).filter(|(_, is_kept)| *is_kept).map(|(&place, _)| place).collect()
}

/// The line with parts that are nearly along an axis exactly along it: off by at most `tolerance`, and much longer than that.
pub(super) fn squared(mut line: Vec<Cell>, tolerance: f64) -> Vec<Cell> {
    let is_closed = line.len() > 3 && distance(line[0], line[line.len() - 1]) <= 0.0;
    for axis in 0..2 {
        for at in 1..line.len() {
            let (across, along) =
                ((line[at][axis] - line[at - 1][axis]).abs(), (line[at][1 - axis] - line[at - 1][1 - axis]).abs());
            if across <= tolerance && along > 6.0 * across {
                let middle = 0.5 * (line[at][axis] + line[at - 1][axis]);
                (line[at][axis], line[at - 1][axis]) = (middle, middle);
                if is_closed && (at == 1 || at + 1 == line.len()) {
                    let last = line.len() - 1;
                    let from = if at == 1 { 0 } else { last };
                    line[last - from] = line[from];
                }
            }
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_what_is_between_goes() {
        let line: Vec<Cell> =
            (0..10).map(|x| [f64::from(x), 0.0]).chain((0..10).map(|y| [9.3, f64::from(y)])).collect();
        assert_eq!(simplified(&line, 0.5), [[0.0, 0.0], [9.3, 0.0], [9.3, 9.0]]);
        assert_eq!(squared(vec![[0.0, 0.2], [9.0, 0.0], [9.3, 9.0]], 0.5), [[0.0, 0.1], [9.15, 0.1], [9.15, 9.0]]);
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let dense: Vec<Cell> = ring
            .windows(2)
            .flat_map(|leg| {
                (0..4).map(move |step| {
                    [0, 1].map(|axis| leg[0][axis] + (leg[1][axis] - leg[0][axis]) * f64::from(step) / 4.0)
                })
            })
            .chain([[0.0, 0.0]])
            .collect();
        assert_eq!(simplified(&dense, 0.1), ring);
    }
}
