//! How far the mapped nodes are from their true places.

use sextant_channel::Position;

/// Distribution of the distance between true and mapped places (m). Quantiles between two nodes are
/// interpolated linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize))]
pub struct PositionError {
    /// Mean (m).
    pub mean: f64,
    /// Median (m).
    pub median: f64,
    /// 80th percentile (m).
    pub p80: f64,
    /// 90th percentile (m).
    pub p90: f64,
    /// 95th percentile (m).
    pub p95: f64,
    /// Maximum (m).
    pub max: f64,
}

impl PositionError {
    /// The distribution of `errors_m`; `None` if there are none.
    #[must_use]
    pub fn of(errors_m: &[f64]) -> Option<Self> {
        let mut sorted = errors_m.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let &max = sorted.last()?;
        let (count, last) = (sorted.len() as f64, (sorted.len() - 1) as f64);
        let quantile = |share: f64| {
            let place = share * last;
            let below = crate::numerics::whole(place);
            let above = (below + 1).min(sorted.len() - 1);
            sorted[below] + place.fract() * (sorted[above] - sorted[below])
        };
        Some(Self {
            mean: sorted.iter().sum::<f64>() / count,
            median: quantile(0.5),
            p80: quantile(0.8),
            p90: quantile(0.9),
            p95: quantile(0.95),
            max,
        })
    }

    /// The distribution of the distances between the places `truth` and their images on the map, over the nodes
    /// that are mapped; `None` if there are none.
    #[must_use]
    pub fn between(truth: &[Position], map: &[Option<Position>]) -> Option<Self> {
        Self::of(&Self::sorted_m(truth, map))
    }

    /// The distances themselves, in rising order (m): the steps of their distribution function.
    #[must_use]
    pub(crate) fn sorted_m(truth: &[Position], map: &[Option<Position>]) -> Vec<f64> {
        let mapped = truth.iter().zip(map).filter_map(|(truth, image)| image.map(|image| image.distance_m(*truth)));
        let mut errors_m: Vec<f64> = mapped.collect();
        errors_m.sort_unstable_by(f64::total_cmp);
        errors_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_eleven_equal_steps_are_known() {
        let errors: Vec<f64> = (0..11).rev().map(f64::from).collect();
        let error = PositionError::of(&errors).unwrap();
        for (value, expected) in [
            (error.mean, 5.0),
            (error.median, 5.0),
            (error.p80, 8.0),
            (error.p90, 9.0),
            (error.p95, 9.5),
            (error.max, 10.0),
        ] {
            assert!((value - expected).abs() < 1e-12, "{error:?}");
        }
        assert_eq!(PositionError::of(&[]), None);
    }

    #[test]
    fn unmapped_nodes_have_no_position_error() {
        let truth = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0)];
        let error = PositionError::between(&truth, &[Some(Position::new(3.0, 4.0, 0.0)), None]).unwrap();
        assert!((error.mean - 5.0).abs() < 1e-12 && (error.max - 5.0).abs() < 1e-12);
        assert_eq!(PositionError::between(&truth, &[None, None]), None);
        let both = [Some(Position::new(3.0, 4.0, 0.0)), Some(Position::new(1.0, 2.0, 0.0))];
        assert_eq!(PositionError::sorted_m(&truth, &both), [2.0, 5.0]);
    }
}
