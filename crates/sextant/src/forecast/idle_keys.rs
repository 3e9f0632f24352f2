//! Keys that change nothing: deaths after the end of the run, and what another mode of RPL would use.

use sextant_apps::routing::{RplConfig, RplMode, TreeConfig};
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

    /// Settings of RPL that its mode does not use.
    pub(super) fn idle_keys_of_rpl(&mut self) {
        let Some(TreeConfig::Rpl(rpl)) = self.scenario.config().routing.as_ref().map(|routing| &routing.tree) else {
            return;
        };
        let usual = RplConfig::default();
        let is_storing = rpl.mode == RplMode::Storing;
        let has_none = rpl.mode == RplMode::None;
        for (key, is_set, is_used, why) in [
            (
                "route_table",
                rpl.route_table != usual.route_table,
                is_storing,
                "only nodes with `mode = \"storing\"` keep tables",
            ),
            ("dao_tries", rpl.dao_tries != usual.dao_tries, !has_none, "no DAOs are sent with `mode = \"none\"`"),
        ] {
            if is_set && !is_used {
                self.warn(format!("routing.tree.rpl.{key}"), format!("it changes nothing: {why}"));
            }
        }
    }
}
