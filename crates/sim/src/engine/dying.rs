//! Nodes that die.

use sextant_kernel::{NodeId, SettingError, SimTime, StationId};

use super::Engine;
use crate::application::{Application, Port};
use crate::batteries::{Bank, BatteryRecord};
use crate::event::Event;
use crate::faults::Death;
use crate::link::books::Books;
use crate::model::Note;
use crate::setup::Setup;

impl<A: Application> Engine<A> {
    /// Schedules the deaths.
    pub(super) fn schedule_deaths(&mut self) {
        for &Death { node, time } in self.faults.deaths() {
            self.model.scene.at(time, Event::Died(StationId(node.0)));
        }
    }

    /// Whether a station has died.
    #[inline]
    pub(super) fn is_dead(&self, station: StationId) -> bool {
        !self.dead.is_empty() && self.dead[station.index()]
    }

    /// Whether an event does not happen, because its station has died. The frame that is on air then still ends.
    #[inline]
    pub(super) fn is_dropped(&self, event: Event) -> bool {
        !self.dead.is_empty()
            && match event {
                Event::Link(station, network, event) => {
                    self.dead[station.index()] && !self.model.networks[network.index()].ends_frame(station, event)
                }
                Event::Timer(station, _)
                | Event::DriveEnded(station)
                | Event::NodeTurned(station)
                | Event::ArcPartDriven(station)
                | Event::TargetEntered(station, _)
                | Event::TargetLeft(station, _)
                | Event::TargetMissed(station, _)
                | Event::FalseAlarmRaised(station)
                | Event::FalseAlarmEnded(station, _)
                | Event::BatteryDue(station)
                | Event::SampleDue(station) => self.dead[station.index()],
                Event::HaloDue(_)
                | Event::TargetTurned(_)
                | Event::Died(_)
                | Event::WarmedUp
                | Event::NoiseStarted(_)
                | Event::NoiseEnded(_) => false,
            }
    }

    /// A node dies: its task is over, and its radios are off from now on, or from the end of the frame on air.
    pub(super) fn die(&mut self, station: StationId) {
        if self.is_dead(station) {
            return;
        }
        self.model.settle_battery(station);
        if let Some(bank) = &mut self.model.batteries {
            bank.die(station, self.model.scene.now);
        }
        self.dead.resize(self.model.scene.roll.len(), false);
        self.dead[station.index()] = true;
        if self.model.halo.is_some() {
            self.applications[station.index()].ended(&mut Port { model: &mut self.model, station });
        }
        self.deaths.push(Death { node: NodeId(station.0), time: self.model.scene.now });
        for network in &mut self.model.networks {
            network.die(station, &mut self.model.scene);
        }
        Port { model: &mut self.model, station }.finish();
    }

    /// Plans the first look at each battery.
    pub(super) fn look_at_batteries(&mut self) {
        let stations = self.model.batteries.as_ref().map(Bank::stations);
        for station in stations.into_iter().flatten() {
            self.model.look_at_battery(station);
        }
    }

    /// Looks at the battery of a node, which dies if it is empty.
    pub(super) fn look_at_battery(&mut self, station: StationId) {
        if !self.model.look_at_battery(station) {
            // Nothing happens in the world.
            self.model.scene.discounted += 1;
            return;
        }
        self.model.notes.push(Note::Depleted(NodeId(station.0)));
        self.die(station);
    }

    /// What batteries give is counted from now on: the meters of the radios begin anew.
    pub(super) fn restart_batteries(&mut self) {
        let stations = self.model.batteries.as_ref().map(Bank::stations);
        for station in stations.into_iter().flatten() {
            self.model.settle_battery(station);
        }
        if let Some(bank) = &mut self.model.batteries {
            bank.restart(self.model.scene.now);
        }
    }
}

/// What is left of batteries at the end.
pub(super) fn close_batteries(mut bank: Bank, networks: &[Books], now: SimTime) -> Vec<BatteryRecord> {
    for station in bank.stations().filter(|&station| bank.feeds(station)).collect::<Vec<_>>() {
        bank.settle(station, networks.iter().map(|books| books.metered_j(station)).sum(), now);
    }
    bank.close()
}

/// Refuses batteries of nodes in networks that cannot tell what becomes of packets when one is empty.
///
/// # Errors
/// If a network sweeps sectors.
pub(super) fn check_batteries(setup: &Setup) -> Result<(), SettingError> {
    let Some(batteries) = &setup.batteries else { return Ok(()) };
    assert_eq!(batteries.supplies().len(), setup.world.nodes.len(), "one battery for each node");
    if setup.networks.iter().any(|network| network.technology.antennas().is_some()) {
        let remedy = "remove the table: batteries are those of nodes of IEEE 802.15.4";
        return Err(SettingError::conflict("battery", "`mac.sector_sweep`", remedy));
    }
    Ok(())
}
