//! How much work a map is.

use std::sync::{Mutex, PoisonError};

use sextant_kernel::{Watch, Work};

/// Passes everything on to another watch, and adds up the operations of the work that begins.
#[derive(Debug)]
pub(super) struct CountedWork<'a> {
    watch: &'a dyn Watch,
    operations: Mutex<f64>,
}

impl<'a> CountedWork<'a> {
    /// No work so far.
    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, operations: Mutex::new(0.0) }
    }

    /// Operations of all work that has begun, at most.
    pub(super) fn operations(&self) -> f64 {
        *self.operations.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Watch for CountedWork<'_> {
    fn begin(&self, work: Work) {
        *self.operations.lock().unwrap_or_else(PoisonError::into_inner) += work.operations;
        self.watch.begin(work);
    }

    fn advance(&self, steps: u64) {
        self.watch.advance(steps);
    }

    fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }
}
