//! Places from a table of distances.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sextant::channel::Position;
use sextant::mapper::localise::{DistanceProblem, LocaliseMethod, PairDistance, localise as places_of};

use crate::work::supervised;

/// Places, covariances, whether they are in the frame of the anchors, the part of each node, and the residual (m).
type Found = (Vec<Option<[f64; 3]>>, Vec<Option<[[f64; 3]; 3]>>, bool, Vec<u32>, Option<f64>);

/// Computes places from the distances of pairs of nodes.
#[pyfunction]
pub(crate) fn localise(
    py: Python<'_>,
    nodes: usize,
    pairs: Vec<(usize, usize, f64)>,
    anchors: Vec<(usize, [f64; 3])>,
    dimensions: usize,
    method: &str,
) -> PyResult<Found> {
    let method = match method {
        "least_squares" => LocaliseMethod::LeastSquares,
        "smacof" => LocaliseMethod::Smacof,
        "mds" => LocaliseMethod::Mds,
        other => {
            let allowed = "\"least_squares\", \"smacof\", \"mds\"";
            return Err(PyValueError::new_err(format!("method is {other:?}; allowed: {allowed}")));
        }
    };
    let problem = DistanceProblem {
        nodes,
        pairs: pairs.into_iter().map(|(a, b, distance_m)| PairDistance { a, b, distance_m }).collect(),
        anchors: anchors.into_iter().map(|(node, [x_m, y_m, z_m])| (node, Position::new(x_m, y_m, z_m))).collect(),
        dimensions,
    };
    let found = supervised(py, None, None, |watch| places_of(&problem, method, watch))?;
    let found = found.map_err(|why| PyValueError::new_err(why.to_string()))?;
    let places = found.places.iter().map(|place| place.map(Into::into)).collect();
    Ok((places, found.covariances, found.in_world, found.part_of, found.residual_m))
}
