//! The image on the map of a ball on the ground.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use sextant_channel::Position;

use super::error::MetricError;

/// Smallest ratio of singular values at which places count as spanning plane or space.
const FLATNESS: f64 = 1e-9;

/// 2 if the true places share one height, otherwise 3.
fn dimensions(pairs: &[(Position, Position)]) -> usize {
    let mut heights = pairs.iter().map(|(truth, _)| truth.z_m);
    let first = heights.next().unwrap_or(0.0);
    if heights.all(|height| (height - first).abs() <= 1e-9) { 2 } else { 3 }
}

fn mean(places: impl ExactSizeIterator<Item = Position>) -> Position {
    let share = 1.0 / places.len() as f64;
    places.fold(Position::ORIGIN, |sum, place| sum + place * share)
}

/// `place` with the height dropped in a planar network.
fn flattened(place: Position, dimensions: usize) -> Vector3<f64> {
    Vector3::new(place.x_m, place.y_m, if dimensions == 3 { place.z_m } else { 0.0 })
}

/// The inverse of `matrix`. In a planar network the height is first made independent.
fn inverse(mut matrix: Matrix3<f64>, dimensions: usize) -> Option<Matrix3<f64>> {
    if dimensions == 2 {
        for i in 0..3 {
            matrix[(2, i)] = 0.0;
            matrix[(i, 2)] = 0.0;
        }
        let scale = matrix.norm();
        matrix[(2, 2)] = scale;
    }
    let values = matrix.singular_values();
    if values.min() > FLATNESS * values.max() { matrix.try_inverse() } else { None }
}

/// The affine map from ground to map with the least sum of squared distances, and its inverse.
#[derive(Debug)]
pub(super) struct Affine {
    dimensions: usize,
    to_ground: Matrix3<f64>,
    ground: Vector3<f64>,
    map: Vector3<f64>,
}

impl Affine {
    /// Fits pairs of true and mapped places.
    pub(super) fn fit(pairs: &[(Position, Position)]) -> Result<Self, MetricError> {
        let dimensions = dimensions(pairs);
        if pairs.len() <= dimensions {
            return Err(MetricError::Degenerate("too few nodes are mapped"));
        }
        let ground = flattened(mean(pairs.iter().map(|pair| pair.0)), dimensions);
        let map = flattened(mean(pairs.iter().map(|pair| pair.1)), dimensions);
        let rows = |side: &dyn Fn(&(Position, Position)) -> Vector3<f64>| {
            DMatrix::from_fn(pairs.len(), dimensions, |row, column| side(&pairs[row])[column])
        };
        let truths = rows(&|pair| flattened(pair.0, dimensions) - ground);
        let images = rows(&|pair| flattened(pair.1, dimensions) - map);
        let svd = truths.svd(true, true);
        let values = &svd.singular_values;
        if values.min() <= FLATNESS * values.max() {
            return Err(MetricError::Degenerate("the mapped nodes lie on one line or plane"));
        }
        let solution = svd.solve(&images, 0.0).map_err(MetricError::Degenerate)?;
        let linear =
            Matrix3::from_fn(
                |row, column| {
                    if row < dimensions && column < dimensions { solution[(column, row)] } else { 0.0 }
                },
            );
        let to_ground = inverse(linear, dimensions).ok_or(MetricError::Degenerate("the map is collapsed"))?;
        Ok(Self { dimensions, to_ground, ground, map })
    }

    /// The place on the ground whose image is `image`.
    pub(super) fn to_ground(&self, image: Position) -> Position {
        let place = self.to_ground * (flattened(image, self.dimensions) - self.map) + self.ground;
        Position::new(place.x, place.y, place.z)
    }
}

/// The lines through the middle of the network: east, north and, in space, up. On the map they run through the nodes
/// nearest to their ends.
#[derive(Debug)]
pub(super) struct NetworkAxes {
    dimensions: usize,
    /// Middle of the network on the ground.
    middle: Vector3<f64>,
    /// Half its extent along each axis (m).
    half_extent: Vector3<f64>,
    /// The place on the map nearest to all lines.
    crossing: Vector3<f64>,
    /// Maps places on the map to coordinates along the lines, each divided by the ratio of its line.
    scaled: Matrix3<f64>,
}

impl NetworkAxes {
    /// The lines for pairs of true and mapped places.
    pub(super) fn through(pairs: &[(Position, Position)]) -> Result<Self, MetricError> {
        let dimensions = dimensions(pairs);
        if pairs.len() <= dimensions {
            return Err(MetricError::Degenerate("too few nodes are mapped"));
        }
        let truths = || pairs.iter().map(|pair| flattened(pair.0, dimensions));
        let low = truths().fold(Vector3::repeat(f64::INFINITY), |low, place| low.inf(&place));
        let high = truths().fold(Vector3::repeat(f64::NEG_INFINITY), |high, place| high.sup(&place));
        let (middle, half_extent) = ((low + high) * 0.5, (high - low) * 0.5);
        let nearest = |place: Vector3<f64>| {
            let mut best = (0, f64::INFINITY);
            for (node, truth) in truths().enumerate() {
                let distance = (truth - place).norm_squared();
                if distance < best.1 {
                    best = (node, distance);
                }
            }
            pairs[best.0]
        };
        let mut basis = Matrix3::zeros();
        let mut normal = Matrix3::zeros();
        let mut normal_sum = Vector3::zeros();
        for axis in 0..dimensions {
            let mut along = Vector3::zeros();
            along[axis] = half_extent[axis];
            let [from, to] = [nearest(middle - along), nearest(middle + along)];
            let [start, end] = [from, to].map(|pair| flattened(pair.1, dimensions));
            let length = (end - start).norm();
            let ground = (flattened(to.0, dimensions) - flattened(from.0, dimensions)).norm();
            if !(ground > 0.0 && length > 0.0) {
                return Err(MetricError::Degenerate("the ends of a line across the network coincide"));
            }
            let direction = (end - start) / length;
            // The image of a step of one metre along the axis on the ground.
            basis.set_column(axis, &(direction * (length / ground)));
            let across = Matrix3::identity() - direction * direction.transpose();
            normal += across;
            normal_sum += across * start;
        }
        let scaled = inverse(basis, dimensions)
            .ok_or(MetricError::Degenerate("the lines across the network are parallel on the map"))?;
        let crossing = DMatrix::from_fn(dimensions, dimensions, |row, column| normal[(row, column)])
            .lu()
            .solve(&DVector::from_fn(dimensions, |row, _| normal_sum[row]))
            .ok_or(MetricError::Degenerate("the lines across the network are parallel on the map"))?;
        let crossing = Vector3::from_fn(|row, _| if row < dimensions { crossing[row] } else { 0.0 });
        Ok(Self { dimensions, middle, half_extent, crossing, scaled })
    }

    /// Coordinates of `image` along the lines on the map, in metres on the ground.
    pub(super) fn scaled(&self, image: Position) -> Position {
        let along = self.scaled * (flattened(image, self.dimensions) - self.crossing);
        Position::new(along.x, along.y, along.z)
    }

    /// Half-axes of a node's own ellipse relative to the network's: the distance of its image from the middle along
    /// each line, over that of its place.
    pub(super) fn half_axes(&self, truth: Position, image: Position) -> [f64; 3] {
        let ground = flattened(truth, self.dimensions) - self.middle;
        let map: [f64; 3] = self.scaled(image).into();
        [0, 1, 2].map(|axis| {
            if axis < self.dimensions && ground[axis].abs() >= 0.1 * self.half_extent[axis] {
                (map[axis].abs() / ground[axis].abs()).clamp(0.5, 2.0)
            } else {
                1.0
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_has_its_own_ratios_within_limits() {
        let place = |x, y| Position::new(f64::from(x), f64::from(y), 0.0);
        let mut pairs: Vec<_> =
            (-2..=2).flat_map(|y| (-2..=2).map(move |x| (place(x, y), place(x, y) * 3.0))).collect();
        pairs[0].1 = Position::new(-7.2, -5.4, 0.0);
        pairs[6].1 = Position::new(-0.3, -90.0, 0.0);
        pairs[11].1 = Position::new(-3.6, 8.0, 0.0);
        let axes = NetworkAxes::through(&pairs).unwrap();
        let half_axes = |node: usize| axes.half_axes(pairs[node].0, pairs[node].1);
        // (-2, -2) is 1.2 and 0.9 times as far out as the network's ratio of 3 would have it.
        let expected = [
            (0, [1.2, 0.9, 1.0]),
            // (-1, -1): a tenth and thirty times as far, limited to half and twice.
            (6, [0.5, 2.0, 1.0]),
            // (-1, 0) is on the line along x: it has no ratio of its own along y.
            (11, [1.2, 1.0, 1.0]),
            (24, [1.0, 1.0, 1.0]),
        ];
        for (node, expected) in expected {
            for (found, expected) in half_axes(node).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "node {node}: {:?}", half_axes(node));
            }
        }
        assert!(axes.scaled(Position::new(3.0, -6.0, 0.0)).distance_m(Position::new(1.0, -2.0, 0.0)) < 1e-12);
    }
}
