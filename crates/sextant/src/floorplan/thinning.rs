//! The middle lines of walls.

use super::occupancy::Mask;

/// The set thinned to lines of one cell, which hang together as it did (T. Y. Zhang, C. Y. Suen: A fast parallel algorithm for
/// thinning digital patterns. Communications of the ACM, 1984).
pub(super) fn thinned(mask: &Mask) -> Mask {
    let mut mask = mask.clone();
    let mut members: Vec<usize> = mask.members().collect();
    loop {
        let mut changed = false;
        for is_second in [false, true] {
            let removed: Vec<usize> =
                members.iter().copied().filter(|&cell| is_removed(&mask, cell, is_second)).collect();
            removed.iter().for_each(|&cell| mask.cells[cell] = false);
            changed |= !removed.is_empty();
        }
        if !changed {
            return mask;
        }
        members.retain(|&cell| mask.cells[cell]);
    }
}

/// The number of times that the ring of neighbours of a cell changes from outside to inside.
pub(super) fn crossings(mask: &Mask, cell: usize) -> usize {
    (0..8).filter(|&at| !mask.has_neighbour(cell, at) && mask.has_neighbour(cell, (at + 1) % 8)).count()
}

fn is_removed(mask: &Mask, cell: usize, is_second: bool) -> bool {
    let ring: [bool; 8] = std::array::from_fn(|at| mask.has_neighbour(cell, at));
    let count = ring.iter().filter(|&&is_in| is_in).count();
    let [above, _, right, _, below, _, left, _] = ring;
    let all = |sides: [bool; 3]| sides == [true; 3];
    let (one, other) = if is_second {
        ([above, right, left], [above, below, left])
    } else {
        ([above, right, below], [right, below, left])
    };
    let is_edge = !all(one) && !all(other);
    (2..=6).contains(&count) && is_edge && crossings(mask, cell) == 1
}
