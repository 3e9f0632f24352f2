//! The Cramér-Rao bound of places from signal strengths.

use nalgebra::{DMatrix, DVector};
use sextant_channel::Position;

/// Links between nodes whose signal strengths are known.
#[derive(Clone, Copy, Debug)]
pub struct RssLinks<'a> {
    /// True places of all nodes (m).
    pub places: &'a [Position],
    /// Whether each node is an anchor.
    pub is_anchor: &'a [bool],
    /// Two nodes, and the number of packets over which the strength was averaged. A pair may occur more than once.
    pub links: &'a [(usize, usize, f64)],
    /// Path loss exponent.
    pub exponent: f64,
    /// Standard deviation of shadowing of a packet (dB).
    pub sigma_db: f64,
}

/// Lower bound of the root mean square error (m) of each node that is not an anchor. It holds for any unbiased
/// estimator of all places from the strengths of `links` under log-normal shadowing (Patwari et al. 2003):
/// `sqrt(tr (F⁻¹)_ii)`, F having the blocks `F_ii = Σ g u uᵀ/d²`, `F_ij = −g u uᵀ/d²` with `g = k (10 n/(σ ln 10))²`,
/// u the unit vector and d the length of a link of k packets. Two-dimensional if all places have the same height.
/// `None` if the links do not determine the places of all nodes; the entry of an anchor is `None`. Costs O(N³).
#[must_use]
pub fn rss_crlb_m(links: &RssLinks<'_>) -> Option<Vec<Option<f64>>> {
    let RssLinks { places, is_anchor, links, exponent, sigma_db } = *links;
    let first = places.first()?.z_m;
    let dimensions = if places.iter().all(|place| (place.z_m - first).abs() <= 1e-9) { 2 } else { 3 };
    let mut row_of = vec![None; places.len()];
    for (row, node) in (0..places.len()).filter(|&node| !is_anchor[node]).enumerate() {
        row_of[node] = Some(row * dimensions);
    }
    let size = row_of.iter().flatten().count() * dimensions;
    let gain = (10.0 * exponent / (sigma_db * std::f64::consts::LN_10)).powi(2);
    let mut information = DMatrix::zeros(size, size);
    for &(a, b, packets) in links {
        let apart = <[f64; 3]>::from(places[a] - places[b]);
        let apart = DVector::from_iterator(dimensions, apart.into_iter().take(dimensions));
        let block = &apart * apart.transpose() * (packets * gain / apart.norm_squared().powi(2));
        for (from, to, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
            if let (Some(row), Some(column)) = (row_of[from], row_of[to]) {
                let mut view = information.view_mut((row, column), (dimensions, dimensions));
                view += &block * sign;
            }
        }
    }
    let covariance = information.cholesky()?.inverse();
    let bound = |row: usize| (row..row + dimensions).map(|i| covariance[(i, i)]).sum::<f64>().sqrt();
    Some(row_of.into_iter().map(|row| row.map(bound)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_node_between_anchors_has_the_bound_of_two_separate_axes() {
        // Anchors at distance 2 east and west, 4 north and south: 2 g/d² along each axis.
        let at = |x, y| Position::new(x, y, 0.0);
        let places = [at(0.0, 0.0), at(2.0, 0.0), at(-2.0, 0.0), at(0.0, 4.0), at(0.0, -4.0)];
        let is_anchor = [false, true, true, true, true];
        let links = [(0, 1, 1.0), (2, 0, 1.0), (0, 3, 1.0), (0, 4, 1.0)];
        let links = RssLinks { places: &places, is_anchor: &is_anchor, links: &links, exponent: 2.0, sigma_db: 4.0 };
        let gain = (20.0 / (4.0 * std::f64::consts::LN_10)).powi(2);
        let expected = (4.0 / (2.0 * gain) + 16.0 / (2.0 * gain)).sqrt();
        let bound = rss_crlb_m(&links).unwrap();
        assert!((bound[0].unwrap() - expected).abs() < 1e-12);
        assert_eq!(bound[1], None);
        let open = RssLinks { links: &[(0, 1, 1.0)], ..links };
        assert_eq!(rss_crlb_m(&open), None, "one link leaves a circle open");
    }
}
