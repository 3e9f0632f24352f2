//! The directions that most of several arcs of a circle have in common.

use std::f64::consts::{PI, TAU};

use crate::grid_ml::directions::wrapped;

/// An arc of a circle.
#[derive(Clone, Copy)]
pub(super) struct Arc {
    pub(super) middle: f64,
    /// Half its width (rad), at most π.
    pub(super) half: f64,
}

/// An arc that most of several have in common.
#[derive(Clone, Copy)]
pub(super) struct Agreed {
    pub(super) middle: f64,
    /// Half its width (rad).
    pub(super) half: f64,
    /// How many arcs have it in common.
    pub(super) agreeing: usize,
}

/// The directions that the most bearings allow, if these are more than half of all.
pub(super) fn most_agreed(lines: &[Arc]) -> Option<Agreed> {
    // Ends are turned by their angle from the first arc, so that they are sorted round the circle.
    let origin = lines.first()?.middle;
    let turn = |angle: f64| (angle - origin).rem_euclid(TAU);
    let everywhere = lines.iter().filter(|line| line.half >= PI).count();
    let narrow = lines.iter().filter(|line| line.half < PI);
    // At an equal angle an interval begins before another ends: closed intervals that touch agree.
    let mut ends: Vec<(f64, Edge)> = narrow
        .flat_map(|line| [(turn(line.middle - line.half), Edge::Begins), (turn(line.middle + line.half), Edge::Ends)])
        .collect();
    if ends.is_empty() {
        return Some(Agreed { middle: 0.0, half: PI, agreeing: everywhere });
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // Before the first end, those intervals hold that end before they begin.
    let mut agreeing = everywhere
        + lines
            .iter()
            .filter(|line| line.half < PI && turn(line.middle + line.half) < turn(line.middle - line.half))
            .count();
    let mut most = 0;
    let mut arcs: Vec<[f64; 2]> = Vec::new();
    for (i, &(angle, edge)) in ends.iter().enumerate() {
        match edge {
            Edge::Begins => {
                agreeing += 1;
                let next = ends.get(i + 1).map_or(ends[0].0 + TAU, |end| end.0);
                if agreeing > most {
                    most = agreeing;
                    arcs.clear();
                }
                if agreeing == most {
                    arcs.push([angle, next]);
                }
            }
            Edge::Ends => agreeing -= 1,
        }
    }
    if 2 * most <= lines.len() {
        return None;
    }
    // The hull of the arcs is all but the widest gap between two of them.
    let gap_before = |i: usize| {
        let before = if i == 0 { arcs[arcs.len() - 1][1] - TAU } else { arcs[i - 1][1] };
        arcs[i][0] - before
    };
    let first = (0..arcs.len()).max_by(|&a, &b| gap_before(a).total_cmp(&gap_before(b)).then(b.cmp(&a)))?;
    let width = TAU - gap_before(first);
    let middle = wrapped(origin + arcs[first][0] + 0.5 * width);
    Some(Agreed { middle, half: 0.5 * width, agreeing: most })
}

/// An end of an interval, in the order in which they count at one angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Edge {
    Begins,
    Ends,
}
