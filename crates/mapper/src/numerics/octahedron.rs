//! The octahedral map of the sphere (Cigolle et al. 2014): directions as places of a square.

/// The octahedral map of a direction: both coordinates from −1 to 1.
#[inline]
pub(crate) fn folded([x, y, z]: [f64; 3]) -> [f64; 2] {
    let scale = 1.0 / (x.abs() + y.abs() + z.abs());
    let (u, v) = (x * scale, y * scale);
    if z >= 0.0 { [u, v] } else { [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)] }
}

/// The direction of a place on the map, of any length.
pub(crate) fn unfolded(u: f64, v: f64) -> [f64; 3] {
    let z = 1.0 - u.abs() - v.abs();
    if z >= 0.0 { [u, v, z] } else { [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v), z] }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    #[test]
    fn the_map_of_directions_is_undone() {
        for i in 0..200 {
            let draw = |axis| Seed(9).uniform(Purpose::new(8), [i, axis, 0]) - 0.5;
            let direction = [draw(0), draw(1), draw(2)];
            let [u, v] = folded(direction);
            let back = unfolded(u, v);
            let length = |d: [f64; 3]| d.iter().map(|c| c * c).sum::<f64>().sqrt();
            for axis in 0..3 {
                assert!((back[axis] / length(back) - direction[axis] / length(direction)).abs() < 1e-12);
            }
        }
    }
}
