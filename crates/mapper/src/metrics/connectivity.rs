//! One-hop connectivity error: whether neighbours stay neighbours on the map.

use rayon::prelude::*;
use sextant_channel::{CellIndex, Position};
use sextant_kernel::{Interrupted, Watch};

use super::ellipse::{Affine, NetworkAxes};
use super::error::MetricError;

/// How a neighbourhood, which is a ball on the ground, is transferred to the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeighbourhoodRule {
    /// One ellipse for all nodes: the image of the ball under the affine map from ground to map that fits
    /// best (least squares).
    Affine,
    /// One ellipse for all nodes: its half-axes are the ball's radius times the ratios of map to ground of the
    /// lines that cross the network through its middle (the thesis' ratios for the network as a whole).
    EndPoints,
    /// An ellipse for each node, its half-axes from the node's own distances to the lines that cross the network
    /// (Gunathillake 2018, eq. 3.6 to 3.8, read so that it can be computed: the distance along an axis scales that
    /// axis; axes may be oblique; ratios of nodes within a tenth of the half-extent of an axis, and those
    /// beyond half or twice the network's, are replaced or limited).
    PerNode,
}

/// How many neighbours are lost and gained on the map. Pairs are ordered: each pair of neighbours counts twice.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectivityError {
    /// Radius of the neighbourhood on the ground (m).
    pub radius_m: f64,
    /// Pairs of neighbours on the ground.
    pub physical: u64,
    /// Pairs of neighbours on the ground that are not neighbours on the map, or that have a node without a place on
    /// the map.
    pub lost: u64,
    /// Pairs of neighbours on the map that are not neighbours on the ground.
    pub gained: u64,
    /// Nodes without a neighbour on the ground.
    pub isolated: usize,
    /// Share of its neighbours that each node has lost; `None` for a node without neighbours.
    pub per_node: Vec<Option<f64>>,
}

impl ConnectivityError {
    /// The one-hop connectivity error, 0 to 1: share of the pairs of neighbours that are lost (`E_total` of the
    /// thesis); 0 if there are no pairs.
    #[must_use]
    pub fn connectivity_error(&self) -> f64 {
        share(self.lost, self.physical)
    }

    /// Share of the neighbours on the map that are not neighbours on the ground.
    #[must_use]
    pub fn false_neighbour_rate(&self) -> f64 {
        share(self.gained, self.physical - self.lost + self.gained)
    }

    /// 1 − F₁ of the map's neighbours: counts lost and gained neighbours alike, so that a map with all nodes in one
    /// point is not perfect.
    #[must_use]
    pub fn symmetric_loss(&self) -> f64 {
        share(self.lost + self.gained, 2 * self.physical - self.lost + self.gained)
    }

    /// Share of the nodes with neighbours that have lost at most the share `limit` of them: the distribution function
    /// of the error of a node.
    #[must_use]
    pub fn share_of_nodes_within(&self, limit: f64) -> f64 {
        let errors = || self.per_node.iter().flatten();
        share(errors().filter(|&&error| error <= limit).count() as u64, errors().count() as u64)
    }
}

fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The one-hop connectivity error of a map at one neighbourhood radius on the ground.
///
/// Two nodes are neighbours on the ground if they are at most `radius_m` apart, whatever stands between them. They
/// are neighbours on the map if the second lies in the ellipse (ellipsoid) round the first that `rule` makes of that
/// ball. If all true places have the same height, the comparison is in the plane. Ellipses are computed from the
/// mapped nodes only. A node that is not mapped has lost all its neighbours, and they have lost it.
///
/// # Errors
/// If the lists differ in length, the radius is not a positive number, the mapped nodes do not determine an ellipse,
/// or `watch` ends the work.
pub fn connectivity_error(
    truth: &[Position],
    map: &[Option<Position>],
    radius_m: f64,
    rule: NeighbourhoodRule,
    watch: &dyn Watch,
) -> Result<ConnectivityError, MetricError> {
    if truth.len() != map.len() {
        return Err(MetricError::Length { truth: truth.len(), map: map.len() });
    }
    if !(radius_m.is_finite() && radius_m > 0.0) {
        return Err(MetricError::Radius(radius_m));
    }
    let pairs: Vec<(Position, Position)> =
        truth.iter().zip(map).filter_map(|(&truth, image)| image.map(|image| (truth, image))).collect();
    // Images in coordinates in which the neighbourhood of each node is an axis-aligned ellipsoid, and the half-axes
    // of this ellipsoid in units of the radius.
    let (images, half_axes): (Vec<Position>, Vec<[f64; 3]>) = match rule {
        NeighbourhoodRule::Affine => {
            let affine = Affine::fit(&pairs)?;
            pairs.iter().map(|&(_, image)| (affine.to_ground(image), [1.0; 3])).unzip()
        }
        NeighbourhoodRule::EndPoints => {
            let axes = NetworkAxes::through(&pairs)?;
            pairs.iter().map(|&(_, image)| (axes.scaled(image), [1.0; 3])).unzip()
        }
        NeighbourhoodRule::PerNode => {
            let axes = NetworkAxes::through(&pairs)?;
            pairs.iter().map(|&(truth, image)| (axes.scaled(image), axes.half_axes(truth, image))).unzip()
        }
    };
    Ok(count(truth, map, radius_m, &images, &half_axes, watch)?)
}

/// Nodes that one thread counts the neighbours of at a time.
const NODES_AT_A_TIME: usize = 1024;

/// Counts neighbours, given the mapped nodes' images and half-axes.
fn count(
    truth: &[Position],
    map: &[Option<Position>],
    radius_m: f64,
    images: &[Position],
    half_axes: &[[f64; 3]],
    watch: &dyn Watch,
) -> Result<ConnectivityError, Interrupted> {
    let nodes: Vec<usize> = (0..truth.len()).filter(|&node| map[node].is_some()).collect();
    let mut image_of = vec![None; truth.len()];
    for (image, &node) in nodes.iter().enumerate() {
        image_of[node] = Some(image);
    }
    let neighbourhoods = Neighbourhoods {
        truth,
        radius_m,
        ground: CellIndex::new(truth, radius_m),
        mapped: CellIndex::new(images, radius_m),
        images,
        half_axes,
        nodes: &nodes,
        image_of: &image_of,
    };
    let parts = (0..truth.len().div_ceil(NODES_AT_A_TIME)).into_par_iter().map(|part| {
        watch.check()?;
        let first = part * NODES_AT_A_TIME;
        let nodes = first..truth.len().min(first + NODES_AT_A_TIME);
        Ok(nodes.map(|node| neighbourhoods.of(node)).collect::<Vec<_>>())
    });
    let parts: Vec<Vec<NeighbourCounts>> = parts.collect::<Result<_, Interrupted>>()?;
    let mut error = ConnectivityError {
        radius_m,
        physical: 0,
        lost: 0,
        gained: 0,
        isolated: 0,
        per_node: Vec::with_capacity(truth.len()),
    };
    for NeighbourCounts { physical, kept, gained } in parts.into_iter().flatten() {
        error.physical += physical;
        error.lost += physical - kept;
        error.gained += gained;
        error.isolated += usize::from(physical == 0);
        error.per_node.push((physical > 0).then(|| share(physical - kept, physical)));
    }
    Ok(error)
}

/// Numbers of neighbours of a node.
#[derive(Clone, Copy)]
struct NeighbourCounts {
    /// On the ground.
    physical: u64,
    /// On the ground and on the map.
    kept: u64,
    /// On the map alone.
    gained: u64,
}

/// The places of all nodes on the ground and on the map.
struct Neighbourhoods<'a> {
    truth: &'a [Position],
    radius_m: f64,
    ground: CellIndex,
    mapped: CellIndex,
    images: &'a [Position],
    half_axes: &'a [[f64; 3]],
    /// The node of each image.
    nodes: &'a [usize],
    /// The image of each node.
    image_of: &'a [Option<usize>],
}

impl Neighbourhoods<'_> {
    /// The neighbours of a node. Time in proportion to their number.
    fn of(&self, node: usize) -> NeighbourCounts {
        let place = self.truth[node];
        let mut found = NeighbourCounts { physical: 0, kept: 0, gained: 0 };
        self.ground.within(place, self.radius_m, |other| found.physical += u64::from(other as usize != node));
        let Some(image) = self.image_of[node] else { return found };
        let [a, b, c] = self.half_axes[image].map(|half_axis| half_axis * self.radius_m);
        let centre = self.images[image];
        self.mapped.within(centre, a.max(b).max(c), |other| {
            let apart = self.images[other as usize] - centre;
            let other = self.nodes[other as usize];
            let inside = (apart.x_m / a).powi(2) + (apart.y_m / b).powi(2) + (apart.z_m / c).powi(2) <= 1.0;
            if other != node && inside {
                // The same comparison as on the ground.
                let apart = self.truth[other] - place;
                let is_neighbour = apart.dot(apart) <= self.radius_m * self.radius_m;
                if is_neighbour { found.kept += 1 } else { found.gained += 1 }
            }
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    const RULES: [NeighbourhoodRule; 3] =
        [NeighbourhoodRule::Affine, NeighbourhoodRule::EndPoints, NeighbourhoodRule::PerNode];

    fn square(side: u32, layers: u32) -> Vec<Position> {
        let sites = (0..layers).flat_map(|z| (0..side).flat_map(move |y| (0..side).map(move |x| [x, y, z])));
        sites.map(|site| site.map(f64::from).into()).collect()
    }

    fn images(truth: &[Position], image: impl Fn(Position) -> Position) -> Vec<Option<Position>> {
        truth.iter().map(|&place| Some(image(place))).collect()
    }

    #[test]
    fn a_perfect_map_has_no_error_and_as_many_pairs_as_the_lattice() {
        // Unit square lattice, radius 1: each of the 2 · 5 · 4 edges is two ordered pairs.
        let truth = square(5, 1);
        for rule in RULES {
            let error = connectivity_error(&truth, &images(&truth, |p| p), 1.0 + 1e-9, rule, &Unwatched).unwrap();
            assert_eq!((error.physical, error.lost, error.gained, error.isolated), (80, 0, 0, 0), "{rule:?}");
            assert!(error.symmetric_loss().abs() < 1e-15);
            assert!((error.share_of_nodes_within(0.0) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_large_network_is_counted_part_by_part_and_nodes_without_neighbours_apart() {
        let side = 40;
        let mut truth = square(side, 1);
        assert!(truth.len() > NODES_AT_A_TIME);
        let lonely = [0, 5, 9].map(|i| Position::new(1000.0 * f64::from(i + 1), 40.0 * f64::from(i), 0.0));
        truth.extend(lonely);
        let error =
            connectivity_error(&truth, &images(&truth, |p| p), 1.01, NeighbourhoodRule::Affine, &Unwatched).unwrap();
        let pairs = 4 * u64::from(side * (side - 1));
        assert_eq!((error.physical, error.lost, error.gained, error.isolated), (pairs, 0, 0, lonely.len()));
        assert_eq!(error.per_node.len(), truth.len());
        let (lattice, apart) = error.per_node.split_at(truth.len() - lonely.len());
        assert!(lattice.iter().all(|share| *share == Some(0.0)) && apart.iter().all(Option::is_none));
    }

    #[test]
    fn stretching_shearing_and_mirroring_the_map_changes_nothing() {
        let sheared = |p: Position| Position::new(3.0 - 0.5 * p.x_m + 0.2 * p.y_m, 4.0 * p.y_m, p.z_m);
        let turned = |p: Position| Position::new(0.5 * p.z_m, 2.0 * p.x_m, -3.0 * p.y_m + 0.4 * p.z_m);
        for rule in RULES {
            let truth = square(5, 1);
            let error = connectivity_error(&truth, &images(&truth, sheared), 1.5, rule, &Unwatched).unwrap();
            assert_eq!((error.lost, error.gained), (0, 0), "{rule:?}");
            let truth = square(5, 5);
            let error = connectivity_error(&truth, &images(&truth, turned), 1.5, rule, &Unwatched).unwrap();
            assert_eq!((error.lost, error.gained), (0, 0), "{rule:?} in 3D");
        }
    }

    #[test]
    fn a_node_far_from_its_place_loses_its_neighbours_and_they_lose_it() {
        // The middle of a 9 × 9 lattice moves onto a node one lane away: it has lost its four neighbours.
        let truth = square(9, 1);
        let mut map = images(&truth, |p| p);
        map[40] = None;
        let error = connectivity_error(&truth, &map, 1.001, NeighbourhoodRule::Affine, &Unwatched).unwrap();
        assert_eq!((error.physical, error.lost, error.gained), (288, 8, 0));
        assert!((error.connectivity_error() - 8.0 / 288.0).abs() < 1e-15);
        assert!((error.symmetric_loss() - 8.0 / 568.0).abs() < 1e-15);
        assert_eq!(error.per_node[40], Some(1.0));
        assert_eq!(error.per_node[41], Some(0.25));
        assert!((error.share_of_nodes_within(0.1) - 76.0 / 81.0).abs() < 1e-12);
    }

    #[test]
    fn a_node_that_moves_gains_false_neighbours() {
        // A node moves next to a node far away. The others are so many that the affine map hardly changes.
        let truth = square(20, 1);
        let mut map = images(&truth, |p| p);
        map[210] = Some(Position::new(2.5, 2.5, 0.0));
        let error = connectivity_error(&truth, &map, 1.05, NeighbourhoodRule::Affine, &Unwatched).unwrap();
        assert_eq!((error.lost, error.gained), (8, 8));
        let expected = 8.0 / f64::from(u32::try_from(error.physical).unwrap());
        assert!((error.false_neighbour_rate() - expected).abs() < 1e-12);
        assert!((error.connectivity_error() - expected).abs() < 1e-12);
        assert!((error.symmetric_loss() - expected).abs() < 1e-12);
    }

    #[test]
    fn counts_agree_with_a_scan_of_all_pairs() {
        let draw = |i, axis, what| Seed(6).normal(Purpose::new(8), [i, axis, what]);
        let truth: Vec<Position> =
            (0..150).map(|i| Position::new(10.0 * draw(i, 0, 0), 6.0 * draw(i, 1, 0), 2.0 * draw(i, 2, 0))).collect();
        let map: Vec<Option<Position>> = (0..)
            .zip(&truth)
            .map(|(i, &p)| (i % 13 != 5).then(|| p + Position::new(draw(i, 0, 1), draw(i, 1, 1), draw(i, 2, 1))))
            .collect();
        let pairs: Vec<_> = truth.iter().zip(&map).filter_map(|(&p, image)| image.map(|q| (p, q))).collect();
        let affine = Affine::fit(&pairs).unwrap();
        for radius_m in [1.0, 3.0, 8.0] {
            let (mut physical, mut lost, mut gained) = (0, 0, 0);
            for (i, a) in truth.iter().enumerate() {
                for (j, b) in truth.iter().enumerate().filter(|&(j, _)| j != i) {
                    let near = a.distance_m(*b) <= radius_m;
                    let near_on_map = map[i]
                        .zip(map[j])
                        .is_some_and(|(a, b)| affine.to_ground(a).distance_m(affine.to_ground(b)) <= radius_m);
                    physical += u64::from(near);
                    lost += u64::from(near && !near_on_map);
                    gained += u64::from(!near && near_on_map);
                }
            }
            let error = connectivity_error(&truth, &map, radius_m, NeighbourhoodRule::Affine, &Unwatched).unwrap();
            assert_eq!((error.physical, error.lost, error.gained), (physical, lost, gained));
        }
    }

    /// What [`Neighbourhoods`] counts, over all pairs.
    fn literal(
        truth: &[Position],
        map: &[Option<Position>],
        radius_m: f64,
        images: &[Position],
        half_axes: &[[f64; 3]],
    ) -> [u64; 3] {
        let nodes: Vec<usize> = (0..truth.len()).filter(|&node| map[node].is_some()).collect();
        let on_map = |from: usize, to: usize| {
            let [from, to] = [from, to].map(|node| nodes.iter().position(|&other| other == node));
            from.zip(to).is_some_and(|(from, to)| {
                let apart = images[to] - images[from];
                let [a, b, c] = half_axes[from].map(|half_axis| half_axis * radius_m);
                (apart.x_m / a).powi(2) + (apart.y_m / b).powi(2) + (apart.z_m / c).powi(2) <= 1.0
            })
        };
        let mut counts = [0; 3];
        for from in 0..truth.len() {
            for to in (0..truth.len()).filter(|&to| to != from) {
                let apart = truth[to] - truth[from];
                let near = apart.dot(apart) <= radius_m * radius_m;
                let near_on_map = on_map(from, to);
                let pair = [near, near && !near_on_map, !near && near_on_map];
                counts.iter_mut().zip(pair).for_each(|(count, is_one)| *count += u64::from(is_one));
            }
        }
        counts
    }

    proptest! {
        #[test]
        fn cells_count_what_all_pairs_count(
            places in proptest::collection::vec(([-20.0..20.0, -9.0..9.0, 0.0..3.0_f64], [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64], 0..8_u8), 1..70),
            half_axes in [0.5..2.0_f64, 0.5..2.0, 0.5..2.0],
            radius_m in 0.1..30.0_f64,
        ) {
            let truth: Vec<Position> = places.iter().map(|&(place, _, _)| place.into()).collect();
            let map: Vec<Option<Position>> = places
                .iter()
                .map(|&(place, error, kind)| (kind > 0).then(|| Position::from(place) + Position::from(error)))
                .collect();
            let images: Vec<Position> = map.iter().copied().flatten().collect();
            let half_axes = vec![half_axes; images.len()];
            let error = count(&truth, &map, radius_m, &images, &half_axes, &Unwatched).unwrap();
            let expected = literal(&truth, &map, radius_m, &images, &half_axes);
            prop_assert_eq!([error.physical, error.lost, error.gained], expected);
        }
    }

    #[test]
    fn inputs_without_an_ellipse_are_rejected() {
        let truth = square(3, 1);
        let map = images(&truth, |_| Position::ORIGIN);
        for rule in RULES {
            let collapsed = connectivity_error(&truth, &map, 1.0, rule, &Unwatched);
            assert!(matches!(collapsed, Err(MetricError::Degenerate(_))), "{rule:?}: {collapsed:?}");
            let nobody = connectivity_error(&truth, &vec![None; 9], 1.0, rule, &Unwatched);
            assert!(matches!(nobody, Err(MetricError::Degenerate(_))), "{rule:?}: {nobody:?}");
        }
        let line: Vec<Position> = (0..6).map(|i| Position::new(f64::from(i), 0.0, 0.0)).collect();
        let error = connectivity_error(&line, &images(&line, |p| p), 1.0, NeighbourhoodRule::Affine, &Unwatched);
        assert!(matches!(error, Err(MetricError::Degenerate(_))));
        assert_eq!(
            connectivity_error(&truth, &[], 1.0, NeighbourhoodRule::Affine, &Unwatched),
            Err(MetricError::Length { truth: 9, map: 0 })
        );
        assert_eq!(
            connectivity_error(&truth, &images(&truth, |p| p), -1.0, NeighbourhoodRule::Affine, &Unwatched),
            Err(MetricError::Radius(-1.0))
        );
    }
}
