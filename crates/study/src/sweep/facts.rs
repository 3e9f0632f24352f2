//! What a sweep keeps of each of its scenarios.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use sextant_kernel::{LARGEST_FILE, read_at_most};
use sha2::{Digest, Sha256};

use sextant::apps::routing::TreeConfig;
use sextant::summary::measures::{Feature, Subjects};
use sextant_kernel::text::hexadecimal;
use sextant_scenario::{
    NamedFile, ReplacedSetting, Scenario, ScenarioError, ScenarioErrors, ScenarioFile, Setting, SurveyIdentity,
};

use super::column::Column;

/// Cells that are checked before it is asked whether one is invalid.
const BLOCK: usize = 1024;

/// What is kept of the scenario of a cell.
#[derive(Clone, Debug)]
pub(super) struct CellFacts {
    pub(super) survey: SurveyIdentity,
    pub(super) seed: u64,
    pub(super) subjects: Subjects,
    /// The value of each setting that other cells set, in the order of the keys.
    pub(super) others: Vec<String>,
    /// Hash of its settings, however they are written.
    pub(super) settings: [u8; 32],
    /// Settings that have no effect, by their numbers among those of all cells and its own.
    pub(super) replaced: Vec<ReplacedSetting>,
    /// Hash of its text.
    text: [u8; 32],
    /// The files that it names.
    pub(super) files: Vec<NamedFile>,
}

/// Checks the `cells`, on all cores. The sweep varies the `keys`.
///
/// # Errors
/// All errors of the first cell that is invalid.
pub(super) fn of_cells(
    file: &ScenarioFile,
    set: &[String],
    seed: Option<u64>,
    keys: &[Column],
    cells: &[Vec<Setting>],
) -> Result<Vec<CellFacts>, ScenarioErrors> {
    let mut facts = Vec::with_capacity(cells.len());
    for block in cells.chunks(BLOCK) {
        let of = |cell: &Vec<Setting>| {
            let flags = flags(set, cell);
            of(&file.scenario(&flags, seed)?, &unset(keys, cell), file.replaced(&flags)?)
        };
        let found: Vec<_> = block.par_iter().map(of).collect();
        for cell in found {
            facts.push(cell?);
        }
    }
    Ok(facts)
}

/// The `keys` that a cell does not set.
fn unset<'k>(keys: &'k [Column], cell: &[Setting]) -> Vec<&'k str> {
    let names = keys.iter().map(|key| key.name.as_str());
    names.filter(|name| cell.iter().all(|setting| setting.key != *name)).collect()
}

fn of(scenario: &Scenario, unset: &[&str], replaced: Vec<ReplacedSetting>) -> Result<CellFacts, ScenarioErrors> {
    let by_nodes: Vec<String> = scenario.distributed().map(|map| map.name.clone()).into_iter().collect();
    let maps = scenario.maps().iter().map(|named| named.name.clone());
    let searches = scenario.missions().iter().filter(|application| application.goal().is_targets());
    let keep_links = scenario.missions().iter().filter(|application| application.goal().is_link());
    Ok(CellFacts {
        survey: scenario.survey_identity(),
        seed: scenario.seed().0,
        others: if unset.is_empty() { Vec::new() } else { scenario.effective_values(unset.iter().copied()) },
        settings: scenario.settings_identity(),
        replaced,
        subjects: Subjects {
            networks: networks(scenario),
            maps: by_nodes.iter().cloned().chain(maps).collect(),
            by_nodes,
            features: features(scenario),
            applications: scenario.missions().iter().map(|application| application.name.clone()).collect(),
            searches: searches.map(|application| application.name.clone()).collect(),
            keep_links: keep_links.map(|application| application.name.clone()).collect(),
        },
        text: Sha256::digest(scenario.text()).into(),
        files: scenario.named_files().to_vec(),
    })
}

/// The names of its networks, if it has several.
fn networks(scenario: &Scenario) -> Vec<String> {
    let names = scenario.networks().iter().filter_map(|network| network.name.clone());
    if has_single_network(scenario) { Vec::new() } else { names.collect() }
}

fn has_single_network(scenario: &Scenario) -> bool {
    scenario.networks().len() < 2
}

/// What its runs have besides maps and applications.
fn features(scenario: &Scenario) -> BTreeSet<Feature> {
    let routing = scenario.config().routing.as_ref();
    let technology = scenario.networks().first().map(|network| &network.technology);
    let has = |feature: &Feature| match feature {
        Feature::Routing => scenario.routing().is_some(),
        Feature::WayDown => routing.is_some_and(|routing| !routing.to.is_sink()),
        Feature::Rpl => routing.is_some_and(|routing| matches!(routing.tree, TreeConfig::Rpl(_))),
        Feature::Fragments => routing.is_some_and(|routing| routing.fragments.is_some()),
        Feature::Slots => technology.is_some_and(|technology| technology.has_slots()),
        Feature::NegotiatedCells => technology.is_some_and(|technology| technology.has_negotiated_cells()),
        Feature::Batteries => scenario.config().battery.is_some(),
        Feature::SingleNetwork => has_single_network(scenario),
        Feature::Sleep => technology.is_some_and(|technology| technology.sleeping().is_some()),
    };
    Feature::ALL.into_iter().filter(has).collect()
}

/// Hashes of the contents of files, each of which is read once.
#[derive(Default)]
pub(super) struct Contents(BTreeMap<PathBuf, [u8; 32]>);

impl Contents {
    /// The hash of a scenario and of the files that it names.
    pub(super) fn sha256(&mut self, cell: &CellFacts) -> Result<String, ScenarioError> {
        let mut digest = Sha256::new();
        digest.update(cell.text);
        for file in &cell.files {
            digest.update(self.of(&file.path)?);
        }
        Ok(hexadecimal(&digest.finalize()))
    }

    fn of(&mut self, file: &Path) -> Result<[u8; 32], ScenarioError> {
        if let Some(&hash) = self.0.get(file) {
            return Ok(hash);
        }
        let bytes = read_at_most(file, LARGEST_FILE).map_err(|error| ScenarioError::unreadable(file, &error))?;
        let hash = Sha256::digest(bytes).into();
        self.0.insert(file.to_owned(), hash);
        Ok(hash)
    }
}

/// The settings of all cells, then those of a cell.
pub(super) fn flags(set: &[String], settings: &[Setting]) -> Vec<String> {
    set.iter().cloned().chain(settings.iter().map(Setting::line)).collect()
}
