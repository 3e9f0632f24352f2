//! What a report says of the directions of the horizon: a table that is filled where it is read.

use std::cell::{Cell, OnceCell};

use super::blur::{Blur, ROUND};

/// What a report says of a direction, before the strength of the straight way is expected anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ReportView {
    /// The log-likelihood if the straight way is open and has the strength that it is expected to have.
    pub(super) ln: f64,
    /// The strength of the straight way at the node, without gain, as the report says (dB).
    pub(super) level_db: f64,
    /// Inverse of the variance of this strength round the expected one (per dB²).
    pub(super) precision: f64,
}

/// What a report says of a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReportFit {
    /// The log-likelihood if the straight way is open.
    pub(super) ln_open: f64,
    /// The strength of the straight way at the node, without gain (dB).
    pub(super) level_db: f64,
}

impl ReportView {
    /// How the report fits a straight way whose strength is expected here (dB), with the variance of [`ReportTables::view`].
    #[inline]
    pub(super) fn fit(self, expected_db: f64, variance: f64) -> ReportFit {
        let off = self.level_db - expected_db;
        let by_report = 1.0 - self.precision * variance;
        ReportFit { ln_open: self.ln - 0.5 * self.precision * off * off, level_db: self.level_db - by_report * off }
    }
}

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
        let between = |i: usize| f64::from(low[i]) + share * (f64::from(high[i]) - f64::from(low[i]));
        ReportView { ln: between(0), level_db: between(1), precision: between(2) }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "tables are in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_made_once_and_read_between_corners() {
        let (views, made) = (ReportViews::default(), Cell::new(0));
        let at = |blur: Blur, along: f64| {
            views.at(blur, along, |corner| {
                made.set(made.get() + 1);
                ReportView { ln: -(corner as f64), level_db: 0.5 * corner as f64, precision: 1.0 }
            })
        };
        for along in [100.0, 100.25, 100.75] {
            let ReportView { ln, level_db, precision } = at(Blur::NONE, along);
            let off = (ln + along).abs() + (level_db - 0.5 * along).abs() + (precision - 1.0).abs();
            assert!(off < 1e-9, "{ln}, {level_db} dB, {precision}");
        }
        assert_eq!(made.get(), 2);
        // A blurred one has corners of its own, up to the last.
        let rough = Blur::of_angle(1.0);
        let end = at(rough, ROUND as f64);
        assert!((end.ln + ROUND as f64).abs() < 1e-9 && (at(rough, 8.0).ln + 8.0).abs() < 1e-9, "{end:?}");
        assert_eq!(made.get(), 6);
    }
}
