//! What is left in the batteries of nodes.

use sextant_kernel::StationId;

use super::Model;
use crate::batteries::Outlook;
use crate::event::Event;

impl Model {
    /// Takes what a node drew until now from its battery. Returns whether it has one, and lives.
    pub(crate) fn settle_battery(&mut self, station: StationId) -> bool {
        let Self { scene, networks, batteries, .. } = self;
        let Some(bank) = batteries.as_mut().filter(|bank| bank.feeds(station)) else { return false };
        let metered_j = networks.iter_mut().map(|network| network.metered_j(station, scene)).sum();
        bank.settle(station, metered_j, scene.now);
        true
    }

    /// Looks at the battery of a node: returns whether it is empty, or else plans the next look.
    pub(crate) fn look_at_battery(&mut self, station: StationId) -> bool {
        if !self.settle_battery(station) {
            return false;
        }
        match self.batteries.as_ref().map(|bank| bank.outlook(station)) {
            Some(Outlook::Empty) => true,
            Some(Outlook::Lasts(span)) => {
                self.scene.after(span, Event::BatteryDue(station));
                false
            }
            None => false,
        }
    }

    /// Energy that is left in the battery of a station (J); `None` if it has none, or has died.
    pub(crate) fn charge_j(&mut self, station: StationId) -> Option<f64> {
        if !self.settle_battery(station) {
            return None;
        }
        Some(self.batteries.as_ref()?.left_j(station))
    }
}
