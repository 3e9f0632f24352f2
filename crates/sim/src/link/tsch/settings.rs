//! The settings of links with time-slotted channel hopping.

use sextant_kernel::{Files, SettingError, StationId};
use sextant_mac::tsch::{ScheduleKind, TschSettings};

use super::cells::{self, NamedCell};
use super::plan::{CellFault, Plan};
use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::Radio;
use crate::link::radio_settings::RadioSettings;
use crate::link::settings::{KnownStations, KnownTree, LinkSettings, Spectrum};
use crate::service::report::Destination;
use crate::world::layout::PlacedNode;

/// Links of IEEE 802.15.4 with time-slotted channel hopping.
#[derive(Clone, Debug)]
pub struct Tsch {
    /// The radios.
    pub radio: Radio,
    /// Slots, channels and schedule.
    pub tsch: TschSettings,
    /// The cells that the scenario lists.
    cells: Vec<NamedCell>,
    /// The tree along which stations send, if it is known.
    tree: Option<KnownTree>,
    pub(super) plan: Plan,
}

impl Tsch {
    /// The settings that a scenario describes.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let MacConfig::Tsch(tsch) = config.mac else { unreachable!("the channel access chose the technology") };
        let mut errors = Vec::new();
        let radio = Radio::read(config, nodes, &mut errors);
        if config.radio.is_some_and(|radio| radio.channel.is_some()) {
            let remedy = "remove the key: `mac.tsch.hopping` names the channels";
            LinkError::take(
                "radio",
                Err::<(), _>(SettingError::conflict("channel", "`mac.tsch`", remedy)),
                &mut errors,
            );
        }
        let Some(radio) = radio else { return Err(errors) };
        let tsch = TschSettings::new(tsch.clone(), radio.phy()).map_err(|error| error.within("tsch"));
        let tsch = LinkError::take("mac", tsch, &mut errors);
        let cells = match tsch.as_ref().map(|tsch| &tsch.schedule) {
            Some(ScheduleKind::Own(own)) => {
                let cells = cells::read(own, files).map_err(|error| error.within("tsch.schedule.own"));
                LinkError::take("mac", cells, &mut errors)
            }
            _ => Some(Vec::new()),
        };
        match (tsch, cells) {
            (Some(tsch), Some(cells)) if errors.is_empty() => {
                Ok(Self { radio, tsch, cells, tree: None, plan: Plan::default() })
            }
            _ => Err(errors),
        }
    }
}

impl Tsch {
    /// Whether the scenario lists the cells.
    #[must_use]
    pub fn lists_cells(&self) -> bool {
        matches!(self.tsch.schedule, ScheduleKind::Own(_))
    }

    /// What is amiss for the frames of a station, once the stations are known: see [`Plan::fault`].
    pub(crate) fn cell_fault(
        &self,
        from: StationId,
        to: Option<Destination>,
        listeners: &[StationId],
    ) -> Option<CellFault> {
        self.plan.fault(from, to, listeners)
    }
}

impl LinkSettings for Tsch {
    fn radio(&self) -> &dyn RadioSettings {
        &self.radio
    }

    fn spectrum(&self) -> Spectrum {
        self.radio.spectrum(self.tsch.hopping.channels()[0])
    }

    fn further_spectra(&self) -> Vec<Spectrum> {
        self.tsch.hopping.channels()[1..].iter().map(|&channel| self.radio.spectrum(channel)).collect()
    }

    fn know_tree(&mut self, tree: &KnownTree) {
        self.tree = Some(tree.clone());
    }

    fn know_stations(&mut self, stations: &KnownStations<'_>) -> Result<(), SettingError> {
        if stations.has_robots() {
            let remedy = "remove the robots, or give them a network of their own: they do not follow slots";
            return Err(SettingError::conflict("tsch", "robots in the network", remedy).within("mac"));
        }
        let plan = Plan::new(&self.tsch, &self.cells, stations, self.tree.as_ref());
        self.plan = plan.map_err(|error| error.within("mac.tsch"))?;
        Ok(())
    }
}
