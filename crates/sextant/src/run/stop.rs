//! An observer that ends a simulation when the work is to end.

use sextant_kernel::Watch;
use sextant_sim::{Observer, Progress};

/// Ends a simulation once its watch says that the work is to end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop<'a>(pub(super) &'a dyn Watch);

impl Observer for Stop<'_> {
    fn goes_on(&mut self, _progress: Progress) -> bool {
        !self.0.is_stopped()
    }
}
