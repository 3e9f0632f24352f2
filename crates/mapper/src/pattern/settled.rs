//! A law that was estimated, and the maps under it.

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch, Work};

use super::evidence::PatternTables;
use super::fit::{FoundPattern, Likelihoods, SectorSurvey, WaysOfLaw};
use super::places::CellPosterior;
use super::scene::AntennaScene;
use super::{PatternFit, PatternMap};
use crate::error::MapError;
use crate::log_facts::reach::HeardNode;
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Cell, Estimate, FitState};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The law of a log, with all that the map of a node depends on beside what was heard of it.
pub(super) struct SettledLaw {
    settings: PatternMap,
    pub(super) scene: AntennaScene,
    found: FoundPattern,
    likelihoods: Likelihoods,
}

impl SettledLaw {
    /// The law of `log`, estimated from some of its nodes.
    pub(super) fn of(
        settings: PatternMap,
        scene: AntennaScene,
        log: &ReceptionLog,
        nodes: &[(NodeId, SearchBox)],
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<Self, MapError> {
        let found = SectorSurvey { log, scene: &scene }.fit(nodes, name, watch)?;
        let likelihoods = Likelihoods::new(found.law.clone(), &scene.map, WaysOfLaw::Known);
        Ok(Self { settings, scene, found, likelihoods })
    }

    /// The map of a log of the same stops, of which these nodes were `heard`.
    pub(super) fn map(
        &self,
        log: &ReceptionLog,
        heard: &[HeardNode],
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<TopologyMap, MapError> {
        let mut map = TopologyMap {
            heights: Some(self.scene.heights),
            ..TopologyMap::of_places(name, vec![None; log.node_count()], CoordinateFrame::World)
        };
        let survey = SectorSurvey { log, scene: &self.scene };
        let boxes = self.scene.boxes(heard);
        let operations = survey.operations(boxes.len() as f64);
        watch.begin(Work { name, unit: "node", steps: boxes.len() as u64, operations });
        let solved: Result<Vec<Option<CellPosterior>>, MapError> = boxes
            .par_iter()
            .map(|node| {
                watch.check()?;
                let places = self.likelihoods.places(&survey, node, self.settings.grid_step_m);
                watch.advance(1);
                Ok(places.map(|(_, places)| places))
            })
            .collect();
        for ((node, within), places) in boxes.iter().zip(solved?) {
            let Some(places) = places else { continue };
            map.vertices_evaluated += places.evaluated;
            map.estimates[node.index()] = Some(self.estimate(&places, within));
        }
        Ok(map)
    }

    fn estimate(&self, places: &CellPosterior, within: &SearchBox) -> Estimate {
        let step_m = places.step_m;
        let cell = Cell::new([step_m, step_m, if within.is_level() { 0.0 } else { step_m }]);
        let mut estimate =
            Estimate::of_places(self.settings.estimate, &places.places, cell, places.mean(), places.likeliest);
        let state = FitState { is_reach_known: self.scene.is_reach_known, is_settled: self.found.is_settled };
        estimate.concern = state.concern(places.verdict.concern(places.edge_below));
        estimate
    }

    /// What was learned.
    pub(super) fn into_fit(self) -> PatternFit {
        let usual_dbi = self.scene.map.usual_dbi();
        PatternFit {
            law: self.found.law,
            ripple_sigma_db: self.found.ripple_sigma_db,
            rounds: self.found.rounds,
            converged: self.found.is_settled,
            nodes: self.found.nodes,
            named: self.found.namings,
            gains: self.scene.map,
            tables: PatternTables::new(),
            usual_dbi,
            knows_ways: self.scene.ways.is_some(),
        }
    }
}
