//! Sums over the ranges of a node: how its place, and what all ranges share, would better be.

use nalgebra::{Matrix4, SMatrix, SVector, Vector4};
use sextant_channel::RangeErrorDensity;

use super::shared::{ERRORS, Mixed, Shared, SharedMatrix};

/// The slope of the log-posterior by the state of a node, and its curvature.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeSlopes {
    pub(super) value: f64,
    pub(super) slope: Vector4<f64>,
    pub(super) curvature: Matrix4<f64>,
    pub(super) mixed: Mixed,
    pub(super) shared_slope: Shared,
    pub(super) shared_curvature: SharedMatrix,
}

/// How an error changes: by x, y and z of the node, by its bias and that of all ranges, by scale, by delay.
pub(super) type ByPlace = SVector<f64, 6>;

/// Sums over the ranges of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct RangeSums {
    log_density: f64,
    slope: ByPlace,
    curvature: SMatrix<f64, 6, 6>,
    law_slope: Vector4<f64>,
    law_curvature: Matrix4<f64>,
    mixed: SMatrix<f64, 6, 4>,
}

impl RangeSums {
    pub(super) fn zeros() -> Self {
        Self {
            log_density: 0.0,
            slope: ByPlace::zeros(),
            curvature: SMatrix::zeros(),
            law_slope: Vector4::zeros(),
            law_curvature: Matrix4::zeros(),
            mixed: SMatrix::zeros(),
        }
    }

    /// Adds a range with its curvature along a direction.
    pub(super) fn add_place(&mut self, density: &RangeErrorDensity, by: &ByPlace, curvature: f64) {
        self.log_density += density.log_density;
        self.slope += by * density.by_error;
        // The lower triangle alone.
        for column in 0..6 {
            let along = by[column] * curvature;
            for row in column..6 {
                self.curvature[(row, column)] += by[row] * along;
            }
        }
    }

    /// Adds what the same range says of the law, with the weight of the product of its slopes.
    pub(super) fn add_law(&mut self, density: &RangeErrorDensity, by: &ByPlace, weight: f64) {
        let by_law = Vector4::from(density.by_law);
        self.law_slope += by_law;
        self.law_curvature += by_law * by_law.transpose();
        self.mixed += by * (by_law * (density.by_error * weight)).transpose();
    }

    /// The slopes by the state of the node and what all ranges share.
    pub(super) fn slopes(mut self) -> NodeSlopes {
        self.curvature.fill_upper_triangle_with_lower_triangle();
        let mut shared_slope = Shared::zeros();
        shared_slope.fixed_rows_mut::<3>(0).copy_from(&self.slope.fixed_rows::<3>(3));
        shared_slope.fixed_rows_mut::<4>(ERRORS).copy_from(&self.law_slope);
        let mut mixed = Mixed::zeros();
        mixed.fixed_columns_mut::<3>(0).copy_from(&self.curvature.fixed_view::<4, 3>(0, 3));
        mixed.fixed_columns_mut::<4>(ERRORS).copy_from(&self.mixed.fixed_rows::<4>(0));
        let mut shared_curvature = SharedMatrix::zeros();
        shared_curvature.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.curvature.fixed_view::<3, 3>(3, 3));
        let with_law = self.mixed.fixed_rows::<3>(3);
        shared_curvature.fixed_view_mut::<3, 4>(0, ERRORS).copy_from(&with_law);
        shared_curvature.fixed_view_mut::<4, 3>(ERRORS, 0).copy_from(&with_law.transpose());
        shared_curvature.fixed_view_mut::<4, 4>(ERRORS, ERRORS).copy_from(&self.law_curvature);
        NodeSlopes {
            value: self.log_density,
            slope: self.slope.fixed_rows::<4>(0).into_owned(),
            curvature: self.curvature.fixed_view::<4, 4>(0, 0).into_owned(),
            mixed,
            shared_slope,
            shared_curvature,
        }
    }
}
