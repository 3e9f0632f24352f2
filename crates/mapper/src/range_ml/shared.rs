//! The parameters that all ranges share.

use nalgebra::{SMatrix, SVector};

/// Number of parameters that all ranges share.
pub(super) const SHARED: usize = 7;
/// The places of bias, scale and delay among them; the law of errors comes after.
pub(super) const BIAS: usize = 0;
pub(super) const SCALE: usize = 1;
pub(super) const DELAY: usize = 2;
pub(super) const ERRORS: usize = 3;

pub(super) type Shared = SVector<f64, SHARED>;
pub(super) type SharedMatrix = SMatrix<f64, SHARED, SHARED>;
pub(super) type Mixed = SMatrix<f64, 4, SHARED>;
