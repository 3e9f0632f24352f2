//! Deaths that are due after the end of the run.

use sextant_kernel::SimTime;
use sextant_kernel::text::counted;

use super::warning::Warnings;

impl Warnings<'_> {
    /// Deaths that are due after the end of the run.
    pub(super) fn late_deaths(&mut self) {
        let Some(duration) = self.setup.duration else { return };
        let end = SimTime::ZERO + duration;
        let deaths = self.setup.faults.deaths();
        let late = deaths.iter().filter(|death| death.time >= end).count();
        if late > 0 {
            let all = counted(deaths.len(), "death");
            let end_s = duration.as_secs_f64();
            self.warn("faults.deaths", format!("{late} of {all} are due after the end of the run, at {end_s} s"));
        }
    }
}
