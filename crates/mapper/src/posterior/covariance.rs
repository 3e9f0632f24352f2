//! The covariance of places.

use sextant_channel::Position;

/// Covariance (m²) of places with probabilities, each given by how far it is from their mean.
pub(crate) fn covariance(places: impl Iterator<Item = (Position, f64)>) -> [[f64; 3]; 3] {
    let mut covariance = [[0.0; 3]; 3];
    for (apart, probability) in places {
        let apart: [f64; 3] = apart.into();
        for (row, &a) in covariance.iter_mut().zip(&apart) {
            for (entry, &b) in row.iter_mut().zip(&apart) {
                *entry += probability * a * b;
            }
        }
    }
    covariance
}
