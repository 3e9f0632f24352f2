//! What a report says of the directions of the horizon: a table that is filled where it is read.

use std::cell::{Cell, OnceCell};

use super::blur::Blur;
use super::gain_map::ROUND;
use super::report_law::ReportView;

/// What a report says at the corners of the horizon, by how blurred it is. It holds for laws that differ in yaw and level alone.
#[derive(Clone, Debug, Default)]
pub(super) struct ReportViews([OnceCell<Vec<Cell<View>>>; Blur::COUNT]);

/// Log-likelihood, level and precision of a view, in single precision; not numbers where nobody looked.
type View = [f32; 3];

/// Corners from one view to the next. A blurred likelihood has few of them.
fn stride(blur: Blur) -> usize {
    (2 * blur.radius()).max(1)
}

impl ReportViews {
    /// What the report says `along` so many corners of the horizon, linear between the corners that `made` is asked for.
    #[inline]
    pub(super) fn at(&self, blur: Blur, along: f64, made: impl Fn(usize) -> ReportView) -> ReportView {
        let stride = stride(blur);
        let unknown = || vec![Cell::new([f32::NAN; 3]); ROUND / stride + 1];
        let views = self.0[blur.level()].get_or_init(unknown);
        let along = along / stride as f64;
        let first = crate::numerics::whole(along).min(views.len() - 2);
        let of = |at: usize| {
            let known = views[at].get();
            if !known[0].is_nan() {
                return known;
            }
            let ReportView { ln, level_db, precision } = made(at * stride);
            views[at].set([ln, level_db, precision].map(single));
            views[at].get()
        };
        let (low, high, share) = (of(first), of(first + 1), along - first as f64);
        let [ln, level_db, precision] =
            [0, 1, 2].map(|i| f64::from(low[i]) + share * (f64::from(high[i]) - f64::from(low[i])));
        ReportView { ln, level_db, precision }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "tables are in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}
