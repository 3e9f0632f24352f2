//! Beams that follow as a mission.

use std::sync::Arc;

use sextant_kernel::SettingError;
use sextant_sim::{ReadySimulation, Setup, Simulation};

use super::config::BeamTrackingConfig;
use super::settings::BeamTracking;
use super::station::BeamStation;
use crate::mission::{
    LinkRecord, Mission, MissionGoal, MissionLinks, MissionOutcome, MissionPlace, MissionSettings, MissionTeam,
};
use crate::navigation::NavigationMap;

impl MissionSettings for BeamTrackingConfig {
    fn key(&self) -> &'static str {
        "beam_tracking"
    }

    fn name(&self) -> &'static str {
        "beam-tracking"
    }

    fn links(&self) -> MissionLinks {
        MissionLinks::Sectors
    }

    fn check_world(&self, _: &MissionPlace<'_>) -> Result<(), SettingError> {
        Ok(())
    }

    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
        let (links, antennas) = place.sectors();
        Ok(Arc::new(BeamTracking::new(self, links, antennas)?))
    }
}

impl Mission for BeamTracking {
    fn goal(&self) -> MissionGoal {
        MissionGoal::Link
    }

    fn prepare(
        self: Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
        setup: Setup,
    ) -> Result<ReadySimulation<'static, MissionOutcome>, SettingError> {
        let simulation = Simulation::with(setup, self.stations(map, team))?;
        Ok(simulation.ready(|own| {
            let records = own.robots.into_iter().filter_map(BeamStation::into_record);
            let links = records.fold(LinkRecord::default(), |sum, record| sum.with(&record));
            MissionOutcome { links: Some(links), ..MissionOutcome::default() }
        }))
    }
}
