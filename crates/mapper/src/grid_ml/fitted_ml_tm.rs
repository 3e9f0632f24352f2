//! ML-TM under a profile estimated from the log.

use sextant_channel::ReceptionLog;
use sextant_kernel::{SettingError, Watch};

use super::ml_tm::uses_under;
use crate::error::MapError;
use crate::estimator::{Estimator, NodeOfLog};
use crate::grid_ml::fitted::{Fit, Fitted, GridSize, WideSearch};
use crate::grid_ml::ml_tm::{MlTm, MlTmConfig};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::reach::{HeardNode, heard_nodes};
use crate::log_facts::search_box::{Limits, SearchBox};
use crate::log_facts::sectors::SectorSettings;
use crate::parts::PartEstimator;
use crate::posterior::FitState;
use crate::profile::{FittedConfig, ProfileConfig, TrapezoidConfig};
use crate::surface::Surface;
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// ML-TM under a profile that is first estimated from the log, for logs whose channel is unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedMlTm {
    fitted: Fitted,
    /// The algorithm. Its profile is replaced by the fitted one.
    ml_tm: MlTm,
    z_range_m: Option<[f64; 2]>,
}

impl FittedMlTm {
    /// The algorithm with the settings of `config`, whose profile is replaced by one fitted as `fitted` says.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn new(config: MlTmConfig, fitted: FittedConfig) -> Result<Self, SettingError> {
        let fitted = Fitted::try_from(fitted).map_err(|error| error.within("profile.fitted"))?;
        let z_range_m = config.z_range_m;
        // Any profile is good enough to check the other settings.
        let reach_m = if config.grid_step_m > 0.0 { config.grid_step_m } else { 1.0 };
        let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.5, 0.0, reach_m));
        Ok(Self { fitted, ml_tm: MlTm::try_from(MlTmConfig { profile, ..config })?, z_range_m })
    }

    /// The algorithm with a grid of this step (m).
    pub(crate) fn with_grid_step_m(&self, grid_step_m: f64) -> Self {
        Self { ml_tm: self.ml_tm.with_grid_step_m(grid_step_m), ..self.clone() }
    }

    /// The profile of `log`; `None` if no node was heard.
    ///
    /// # Errors
    /// [`MapError::Log`] if a sector of the log is not among those of the settings; [`MapError::Interrupted`].
    pub fn fit(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<Option<Fit>, MapError> {
        let (log, step_m) = (self.ml_tm.counted(log), self.ml_tm.grid_step_m());
        self.fitted.fit_with(&log, self.z_range_m, step_m, self.ml_tm.sectors(), watch)
    }

    /// The algorithm under a fitted profile. Give it the part of the log that is [evidence](Fit::evidence).
    #[must_use]
    pub fn with_fit(&self, fit: &Fit) -> MlTm {
        let step_m = self.ml_tm.grid_step_m().min(fit.curve.range_m());
        self.ml_tm.with_profile(fit.profile(step_m)).with_heights(fit.heights)
    }

    /// The algorithm under a profile that means nothing, for logs to which none can be fitted.
    pub(crate) fn unfitted(&self) -> &MlTm {
        &self.ml_tm
    }

    /// The map of the nodes in `log`, and the profile that it was made with.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`]; [`MapError::Interrupted`].
    pub fn map(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<(TopologyMap, Option<Fit>), MapError> {
        match self.fit(log, watch)? {
            Some(fit) => {
                let map = self.map_with(&self.with_fit(&fit), &fit, log, watch)?;
                Ok((map, Some(fit)))
            }
            None => Ok((self.ml_tm.map(log, watch)?, None)),
        }
    }

    /// The map by `ml_tm`, which has the profile of `fit`. Each node is within reach of the stops that heard it.
    fn map_with(
        &self,
        ml_tm: &MlTm,
        fit: &Fit,
        log: &ReceptionLog,
        watch: &dyn Watch,
    ) -> Result<TopologyMap, MapError> {
        let evidence = fit.evidence(log);
        let limits = Limits::new(log, fit.reach_m, fit.heights);
        let boxes: Vec<_> = heard_nodes(&evidence).into_iter().map(|heard| (heard, limits.of(&heard))).collect();
        let mut size = GridSize::default();
        size.add(&boxes, evidence.receptions().len(), fit, ml_tm.grid_step_m());
        let grid = GridKind::of(&evidence, size, evidence.stops().len());
        map_evidence(ml_tm, fit, grid, &evidence, &boxes, watch)
    }

    /// How sectors are used.
    pub(super) fn sectors(&self) -> &SectorSettings {
        self.ml_tm.sectors()
    }

    /// The settings that say how a profile is fitted, and those of the map.
    pub(super) fn stages(&self) -> (&Fitted, &MlTm, Option<[f64; 2]>) {
        (&self.fitted, &self.ml_tm, self.z_range_m)
    }

    /// The same for an `algorithm` that needs sectors in the log.
    pub(crate) fn map_sectors(
        &self,
        log: &ReceptionLog,
        algorithm: &'static str,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<Fit>), MapError> {
        self.ml_tm.demand_sectors(log, algorithm)?;
        match self.fit(log, watch)? {
            Some(fit) => Ok((self.map_with(&self.with_fit(&fit), &fit, log, watch)?, Some(fit))),
            None => Ok((self.ml_tm.map(log, watch)?, None)),
        }
    }
}

/// How the likelihood of a node is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GridKind {
    /// On the grid of the settings, which all nodes share.
    Shared,
    /// On a grid of its own that adapts itself, because the shared one would take too long.
    Own,
}

impl GridKind {
    /// That of a log with the sectors of `log`, where so many stops are evidence and grids have this size.
    pub(super) fn of(log: &ReceptionLog, size: GridSize, stops: usize) -> Self {
        if log.sectors().is_none() && size.takes_too_long(stops) { Self::Own } else { Self::Shared }
    }
}

/// The map of the nodes of `evidence` in their `boxes`, by `ml_tm`, which has the profile of `fit`.
pub(super) fn map_evidence(
    ml_tm: &MlTm,
    fit: &Fit,
    grid: GridKind,
    evidence: &ReceptionLog,
    boxes: &[(HeardNode, SearchBox)],
    watch: &dyn Watch,
) -> Result<TopologyMap, MapError> {
    let mut map = match grid {
        GridKind::Own => {
            let (step_m, kind) = (ml_tm.grid_step_m(), ml_tm.estimate_kind());
            let log = &*ml_tm.counted(evidence);
            let estimates = WideSearch { log, fit, step_m, kind }.estimates(boxes, watch)?;
            TopologyMap {
                estimates,
                grid_step_m: Some(step_m),
                ..TopologyMap::of_places(MlTm::NAME, Vec::new(), CoordinateFrame::World)
            }
        }
        GridKind::Shared => {
            let within: Vec<_> = boxes.iter().map(|(heard, within)| (heard.node, *within)).collect();
            ml_tm.map_within(evidence, Some(&within), watch)?
        }
    };
    map.heights = Some(fit.heights);
    let state = FitState { is_reach_known: fit.is_reach_known, is_settled: fit.is_settled() };
    for estimate in map.estimates.iter_mut().flatten() {
        estimate.concern = state.concern(estimate.concern);
    }
    Ok(map)
}

impl Estimator for FittedMlTm {
    fn name(&self) -> &'static str {
        MlTm::NAME
    }

    fn axes(&self) -> Axes {
        Axes::Survey
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        uses_under(None)
    }

    fn surface(
        &self,
        learned: Option<&EstimatorFindings>,
        NodeOfLog { log, node }: NodeOfLog<'_>,
        watch: &dyn Watch,
    ) -> Option<Result<Surface, MapError>> {
        let fit: &Fit = learned?.get()?;
        Some(self.with_fit(fit).surface(&fit.evidence(log), node, watch))
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map(knowledge.log, watch).map(|(map, fit)| (map, fit.map(EstimatorFindings::new)))
    }
}
