//! The reception curve averaged over the cell of a vertex.

/// Points of the midpoint rule along each side of the cell.
const POINTS: u32 = 6;
/// Number of directions to the stop, over an eighth of the circle.
const DIRECTIONS: u32 = 4;

/// Mean of `probability` over a square cell of side `cell_m` whose middle is `distance_m` away, and over the
/// directions to the cell. The variance of the distance is the same for a cube.
pub(crate) fn averaged_over_cell(probability: impl Fn(f64) -> f64, distance_m: f64, cell_m: f64) -> f64 {
    let mut sum = 0.0;
    let along = |i: u32| ((f64::from(i) + 0.5) / f64::from(POINTS) - 0.5) * cell_m;
    for direction in 0..DIRECTIONS {
        let angle = std::f64::consts::FRAC_PI_4 * (f64::from(direction) + 0.5) / f64::from(DIRECTIONS);
        let (x_m, y_m) = (distance_m * libm::cos(angle), distance_m * libm::sin(angle));
        for i in 0..POINTS {
            for j in 0..POINTS {
                sum += probability(libm::hypot(x_m + along(i), y_m + along(j)));
            }
        }
    }
    sum / f64::from(POINTS * POINTS * DIRECTIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_and_a_cliff_becomes_a_slope() {
        let line = averaged_over_cell(|d| 1.0 - 0.05 * d, 10.0, 0.5);
        assert!((line - 0.5).abs() < 1e-3, "{line}");
        let cliff = |d: f64| f64::from(u8::from(d <= 10.0));
        assert!((averaged_over_cell(cliff, 10.0, 0.5) - 0.5).abs() < 0.05);
        assert!(averaged_over_cell(cliff, 9.0, 0.5) >= 1.0);
        assert!(averaged_over_cell(cliff, 11.0, 0.5) <= 0.0);
        let near = averaged_over_cell(cliff, 9.9, 0.5);
        assert!(near > 0.55 && near < 0.85, "{near}");
    }
}
