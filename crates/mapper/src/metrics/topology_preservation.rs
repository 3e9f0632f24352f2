//! Topology preservation: whether nodes along a line keep their order on the map.

use std::ops::Range;

use sextant_channel::{CellIndex, Position};
use sextant_kernel::{Interrupted, Watch};

use crate::numerics::whole;

/// The topology preservation error of a map in the frame of the truth (after Dhanapala and Jayasumana 2014), 0 to 1:
/// over the lines along each axis of the network, the share of the pairs of nodes on one line that are in reverse
/// order on the map, or in one place.
///
/// The paper's networks are lattices. In general a line is a strip (in space a bar) as wide as the median distance of
/// a node to its nearest neighbour: a row of the lattice if there is one. If all true places have the same height,
/// there are lines along two axes, otherwise along three. `None` if no line has two nodes. Nodes that are not mapped
/// are left out.
///
/// # Errors
/// If `watch` ends the work.
pub fn topology_preservation_error(
    truth: &[Position],
    map: &[Option<Position>],
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let pairs: Vec<([f64; 3], [f64; 3])> =
        truth.iter().zip(map).filter_map(|(&truth, image)| Some((truth.into(), (*image)?.into()))).collect();
    let Some(width_m) = median_spacing_m(&pairs, watch)? else { return Ok(None) };
    let low = pairs.iter().fold([f64::INFINITY; 3], |low, (truth, _)| [0, 1, 2].map(|i| low[i].min(truth[i])));
    let is_planar = pairs.iter().all(|(truth, _)| (truth[2] - low[2]).abs() <= 1e-9);
    let (mut out_of_order, mut compared) = (0, 0);
    for along in 0..if is_planar { 2 } else { 3 } {
        watch.check()?;
        let line = |truth: &[f64; 3]| {
            let mut strip = [0, 1, 2].map(|axis| whole((truth[axis] - low[axis]) / width_m + 0.5));
            strip[along] = 0;
            strip
        };
        let mut nodes: Vec<_> =
            pairs.iter().map(|(truth, image)| (line(truth), truth[along], image[along])).collect();
        nodes.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)));
        for line in nodes.chunk_by(|a, b| a.0 == b.0) {
            let mut order: Vec<f64> = line.iter().map(|node| node.2).collect();
            let count = order.len() as u64;
            compared += count * (count - 1) / 2;
            out_of_order += descents(&mut order);
        }
    }
    let share = || out_of_order as f64 / compared as f64;
    Ok((compared > 0).then(share))
}

/// Median distance of a node to its nearest neighbour at another place (m); `None` if all nodes are in one place.
fn median_spacing_m(pairs: &[([f64; 3], [f64; 3])], watch: &dyn Watch) -> Result<Option<f64>, Interrupted> {
    let places: Vec<Position> = pairs.iter().map(|pair| pair.0.into()).collect();
    let Some((first, rest)) = places.split_first() else { return Ok(None) };
    let extent_m = rest.iter().map(|place| place.distance_m(*first)).fold(0.0, f64::max);
    if extent_m <= 0.0 {
        return Ok(None);
    }
    #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
    let cell_m = extent_m / (1.0 + (1.0 + places.len() as f64).sqrt());
    let index = CellIndex::new(&places, cell_m);
    let mut spacings: Vec<f64> = Vec::new();
    for node in 0..places.len() {
        watch.check()?;
        spacings.extend(nearest_m(&places, &index, node, (2.0 * cell_m).min(extent_m / 64.0)..4.0 * extent_m));
    }
    spacings.sort_unstable_by(f64::total_cmp);
    Ok(spacings.get(spacings.len() / 2).copied())
}

/// Distance from `node` to the nearest other place (m), which is looked for in circles of these radii, each twice the last.
fn nearest_m(places: &[Position], index: &CellIndex, node: usize, radii_m: Range<f64>) -> Option<f64> {
    let mut radius_m = radii_m.start;
    while radius_m < radii_m.end {
        let mut nearest = f64::INFINITY;
        index.within(places[node], radius_m, |other| {
            let distance_m = places[other as usize].distance_m(places[node]);
            if distance_m > 0.0 {
                nearest = nearest.min(distance_m);
            }
        });
        if nearest.is_finite() {
            return Some(nearest);
        }
        radius_m *= 2.0;
    }
    None
}

/// Number of pairs `i < j` with `values[i] >= values[j]`; sorts the values (merge sort).
fn descents(values: &mut [f64]) -> u64 {
    let middle = values.len() / 2;
    if middle == 0 {
        return 0;
    }
    let (left, right) = values.split_at_mut(middle);
    let mut count = descents(left) + descents(right);
    let mut merged = Vec::with_capacity(left.len() + right.len());
    let (mut i, mut j) = (0, 0);
    while i < left.len() || j < right.len() {
        if j == right.len() || (i < left.len() && left[i] < right[j]) {
            merged.push(left[i]);
            i += 1;
        } else {
            count += (left.len() - i) as u64;
            merged.push(right[j]);
            j += 1;
        }
    }
    values.copy_from_slice(&merged);
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    /// The error of a map that nobody interrupts.
    fn error_of(truth: &[Position], map: &[Option<Position>]) -> Option<f64> {
        topology_preservation_error(truth, map, &Unwatched).unwrap()
    }

    fn lattice(counts: [u32; 3], jitter_m: f64) -> Vec<Position> {
        let draw = |i, axis| jitter_m * (2.0 * Seed(5).uniform(Purpose::new(8), [i, axis, 4]) - 1.0);
        let [nx, ny, nz] = counts;
        let sites = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z].map(f64::from))));
        (0..).zip(sites).map(|(i, [x, y, z])| Position::new(x + draw(i, 0), y + draw(i, 1), z)).collect()
    }

    fn images(truth: &[Position], image: impl Fn(Position) -> Position) -> Vec<Option<Position>> {
        truth.iter().map(|&place| Some(image(place))).collect()
    }

    #[test]
    fn a_map_that_keeps_all_orders_has_no_error_and_a_mirrored_axis_loses_its_own() {
        let truth = lattice([7, 5, 1], 0.2);
        let bent = images(&truth, |p| Position::new(p.x_m.powi(3), p.y_m.exp(), 0.0));
        assert_eq!(error_of(&truth, &bent), Some(0.0));
        let truth = lattice([7, 5, 1], 0.0);
        // Lines along x: 5 rows of 7 nodes, 105 pairs; along y: 7 columns of 5 nodes, 70 pairs.
        let mirrored = images(&truth, |p| Position::new(-p.x_m, p.y_m, 0.0));
        let error = error_of(&truth, &mirrored).unwrap();
        assert!((error - 105.0 / 175.0).abs() < 1e-12, "{error}");
        let collapsed = images(&truth, |p| Position::new(0.0, p.y_m, 0.0));
        let error = error_of(&truth, &collapsed).unwrap();
        assert!((error - 105.0 / 175.0).abs() < 1e-12, "{error}");
    }

    #[test]
    fn in_space_there_are_lines_along_three_axes() {
        let truth = lattice([4, 3, 5], 0.0);
        let mirrored = images(&truth, |p| Position::new(p.x_m, p.y_m, -p.z_m));
        // Along x 15 lines of 6 pairs, along y 20 of 3, along z 12 of 10.
        let error = error_of(&truth, &mirrored).unwrap();
        assert!((error - 120.0 / 270.0).abs() < 1e-12, "{error}");
    }

    #[test]
    fn descents_are_those_of_a_scan_of_all_pairs() {
        for count in 0..40 {
            let mut values: Vec<f64> =
                (0..count).map(|i| (6.0 * Seed(2).uniform(Purpose::new(8), [i, count, 8])).floor()).collect();
            let mut expected = 0;
            for (i, a) in values.iter().enumerate() {
                expected += values[i + 1..].iter().filter(|b| a >= b).count() as u64;
            }
            assert_eq!(descents(&mut values), expected);
        }
    }

    proptest! {
        #[test]
        fn the_nearest_neighbours_are_those_of_a_scan_of_all_pairs(
            places in proptest::collection::vec([-300.0..300.0, -20.0..20.0, 0.0..2.0_f64], 2..400),
            repeated in 0..3_usize,
        ) {
            let mut places: Vec<[f64; 3]> = places;
            places.extend(places[..repeated.min(places.len())].to_vec());
            let pairs: Vec<_> = places.iter().map(|&place| (place, place)).collect();
            let nearest = |from: &[f64; 3]| {
                let distances = places.iter().map(|&to| Position::from(to).distance_m((*from).into()));
                distances.filter(|distance_m| *distance_m > 0.0).fold(f64::INFINITY, f64::min)
            };
            let mut spacings: Vec<f64> = places.iter().map(nearest).filter(|spacing| spacing.is_finite()).collect();
            spacings.sort_unstable_by(f64::total_cmp);
            let expected = spacings.get(spacings.len() / 2).copied();
            prop_assert_eq!(median_spacing_m(&pairs, &Unwatched).unwrap(), expected);
        }
    }

    #[test]
    fn without_two_nodes_apart_there_is_no_error() {
        assert_eq!(error_of(&[], &[]), None);
        assert_eq!(error_of(&[Position::ORIGIN; 3], &[Some(Position::ORIGIN); 3]), None);
    }
}
