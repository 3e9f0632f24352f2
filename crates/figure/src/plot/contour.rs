//! Lines of equal value on a grid.

use sextant_channel::Position;

use sextant_recording::GridPlane;

/// The straight pieces of the line on which the grid has the value `level`, in cells whose corners are four neighbouring
/// vertices (marching squares; Lorensen and Cline 1987 in the plane). Between two vertices the value is linear. A saddle is
/// divided as the mean of its corners says.
pub(crate) fn contour(plane: &GridPlane, level: f64) -> Vec<[Position; 2]> {
    let columns = plane.columns as usize;
    let rows = plane.values.len() / columns;
    let value = |column: usize, row: usize| plane.values[row * columns + column];
    let place = |column: usize, row: usize| {
        plane.first + Position::new(column as f64 * plane.step_m, row as f64 * plane.step_m, 0.0)
    };
    let mut pieces = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            // Counterclockwise from the lower left.
            let corners = [(column - 1, row - 1), (column, row - 1), (column, row), (column - 1, row)];
            let values = corners.map(|(column, row)| value(column, row));
            if values.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let places = corners.map(|(column, row)| place(column, row));
            let is_above = values.map(|value| value >= level);
            let crossing = |edge: usize| {
                let (from, to) = (edge, (edge + 1) % 4);
                let share = (level - values[from]) / (values[to] - values[from]);
                places[from] + (places[to] - places[from]) * share
            };
            let crossed: Vec<usize> = (0..4).filter(|&edge| is_above[edge] != is_above[(edge + 1) % 4]).collect();
            match crossed[..] {
                [a, b] => pieces.push([crossing(a), crossing(b)]),
                [a, b, c, d] => {
                    let middle = values.iter().sum::<f64>() / 4.0;
                    // The first corner and the middle are on the same side: the line cuts the second and the fourth off.
                    let pairs = if (middle >= level) == is_above[0] { [(a, b), (c, d)] } else { [(d, a), (b, c)] };
                    pieces.extend(pairs.map(|(a, b)| [crossing(a), crossing(b)]));
                }
                _ => {}
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(columns: u32, rows: u32, value: impl Fn(f64, f64) -> f64) -> GridPlane {
        let vertices = (0..rows).flat_map(|row| (0..columns).map(move |column| (f64::from(column), f64::from(row))));
        let values = vertices.map(|(x, y)| value(x - 20.0, y - 20.0)).collect();
        GridPlane { first: Position::new(-20.0, -20.0, 0.0), step_m: 1.0, columns, values }
    }

    #[test]
    fn the_contour_of_a_hill_is_a_circle() {
        let hill = plane(41, 41, |x, y| 100.0 - x * x - y * y);
        let pieces = contour(&hill, 19.0);
        assert!(pieces.len() > 40, "{}", pieces.len());
        for place in pieces.iter().flatten() {
            let radius_m = place.distance_m(Position::ORIGIN);
            // Linear interpolation of a parabola over 1 m is off by at most 1/4, that is 1/4 / (2 · 9) m.
            assert!((radius_m - 9.0).abs() < 0.02, "{radius_m} m");
        }
        let length_m: f64 = pieces.iter().map(|[from, to]| from.distance_m(*to)).sum();
        assert!((length_m - 18.0 * std::f64::consts::PI).abs() < 0.2, "{length_m} m");
        assert!(contour(&hill, 101.0).is_empty());
    }

    #[test]
    fn the_lines_of_a_saddle_do_not_cross() {
        let saddle = |corner: f64| GridPlane {
            first: Position::ORIGIN,
            step_m: 1.0,
            columns: 2,
            values: vec![corner, 0.0, 0.0, corner],
        };
        for (corner, near) in [(4.0, Position::new(1.0, 0.0, 0.0)), (1.5, Position::ORIGIN)] {
            let pieces = contour(&saddle(corner), 1.0);
            assert_eq!(pieces.len(), 2);
            assert!(
                pieces.iter().any(|ends| ends.iter().all(|end| end.distance_m(near) < 0.8)),
                "{corner}: one line cuts off {near}: {pieces:?}"
            );
        }
    }
}
