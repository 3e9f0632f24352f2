//! A scenario that has been read and checked.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_apps::ControllerConfig;
use sextant_apps::routing::Routing;
use sextant_channel::Anchor;
use sextant_kernel::text::counted;
use sextant_kernel::{Files, Seed, SettingError};
use sextant_sim::{Discovery, Network, NetworkId, RobotBody, RobotConfig, RoleConfig, Setup, SimulatedRegion, World};

use super::check::errors::Errors;
use super::check::maps::MapJob;
use super::check::maps::grids::check_grids;
use super::check::missions::distributed::NodeMapJob;
use super::check::missions::outside;
use super::check::missions::planned::{LEAST_PLACES, MissionMap, PlannedMission, TakenNames};
use super::check::networks::network::{ForeignChip, IncompleteChip};
use super::check::networks::surveyed::PacketsPerStop;
use super::check::plausible::check_numbers;
use super::check::{Parts, check};
use super::config::{MetricsConfig, RecordingConfig, ScenarioConfig};
use super::deserialize::deserialize;
use super::diagnosis;
use super::document::Document;
use super::error::ScenarioErrors;
use super::file::ScenarioFile;

/// A scenario that has been read and checked.
#[derive(Clone)]
pub struct Scenario {
    file: ScenarioFile,
    /// Settings that override those of the file, each `path.to.key=value`.
    set: Vec<String>,
    /// The seed that overrides that of the file.
    seed: Option<u64>,
    config: ScenarioConfig,
    named_files: Vec<NamedFile>,
    text: String,
    parts: Parts,
}

/// A file that a scenario names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Its path as written in the scenario.
    pub written: PathBuf,
    /// Its path on the disk.
    pub path: PathBuf,
}

impl ScenarioFile {
    /// The scenario with the settings `set` (each `path.to.key=value`) and with `seed` instead of its own, checked.
    ///
    /// # Errors
    /// If a setting is invalid or a file that it names cannot be read: all errors found.
    pub fn scenario(&self, set: &[String], seed: Option<u64>) -> Result<Scenario, ScenarioErrors> {
        Scenario::of(self.clone(), set.to_vec(), seed)
    }
}

impl Scenario {
    /// Reads the scenario at `path`, and checks it.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is invalid: all errors found.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ScenarioErrors> {
        Self::load_with(path, &[], None)
    }

    /// Reads the scenario at `path`, overrides it by the settings `set` (each `path.to.key=value`) and by `seed`, and checks
    /// it.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is invalid: all errors found.
    pub fn load_with(path: impl AsRef<Path>, set: &[String], seed: Option<u64>) -> Result<Self, ScenarioErrors> {
        ScenarioFile::read(path)?.given(set, seed)
    }

    /// Reads a scenario from its text, and checks it. Files that it names are relative to the working folder.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is invalid: all errors found.
    pub fn parse(text: &str) -> Result<Self, ScenarioErrors> {
        Self::parse_with(text, &[], None)
    }

    /// Reads a scenario from its text, overrides it by the settings `set` (each `path.to.key=value`) and by `seed`, and checks
    /// it. Files that it names are relative to the working folder.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is invalid: all errors found.
    pub fn parse_with(text: &str, set: &[String], seed: Option<u64>) -> Result<Self, ScenarioErrors> {
        ScenarioFile::of_text(text)?.given(set, seed)
    }

    /// The same scenario with other settings `set` (each `path.to.key=value`), and with `seed` if it is given.
    ///
    /// # Errors
    /// If a setting is invalid: all errors found.
    pub fn with_all(&self, set: &[String], seed: Option<u64>) -> Result<Self, ScenarioErrors> {
        let set: Vec<String> = self.set.iter().chain(set).cloned().collect();
        self.file.scenario(&set, seed.or(self.seed))
    }

    /// The same scenario with another value of the setting `key`, `channel.max_range_m` or `robots.0.speed_m_per_s` for
    /// example. `value` is written in TOML; quotes around a text are optional.
    ///
    /// # Errors
    /// If the key or the value is invalid: all errors found.
    pub fn with(&self, key: &str, value: impl fmt::Display) -> Result<Self, ScenarioErrors> {
        let (mut set, mut seed) = (self.set.clone(), self.seed);
        match value.to_string().parse() {
            // The seed is not part of the text of a scenario, so that runs with different seeds have the same one.
            Ok(other) if key == "seed" => seed = Some(other),
            _ => set.push(format!("{key}={value}")),
        }
        self.file.scenario(&set, seed)
    }

    /// The same scenario with a mission of the caller's own, which follows those of the scenario. It is not part of the text
    /// of the scenario: [`with`](Self::with) and [`with_all`](Self::with_all) leave it out again.
    ///
    /// # Errors
    /// `mission.name` if it is not plain or something else has that name; `network` if it is none of IEEE 802.15.4, does not
    /// have all nodes, or its nodes do not listen all the time; `robots` if there are none, or one is not of the scenario; `map` if no map has that name, or the world has less than three nodes.
    pub fn with_mission(mut self, mission: PlannedMission) -> Result<Self, SettingError> {
        self.check_mission(&mission)?;
        self.parts.applications.push(mission);
        Ok(self)
    }

    /// Checks a mission that is not written in the scenario against it.
    fn check_mission(&self, mission: &PlannedMission) -> Result<(), SettingError> {
        let refuse = |key: &str, found: String, allowed: &str| Err(SettingError::new(key, found, allowed));
        let maps = || {
            let of_nodes = self.distributed().map(|map| map.name.as_str());
            self.maps().iter().map(|map| map.name.as_str()).chain(of_nodes)
        };
        let mut errors = Errors::default();
        let (distributed, missions) = (self.distributed(), self.missions());
        TakenNames { maps: self.maps(), distributed, missions }.check(&mission.name, "mission", &mut errors);
        if let Some(error) = errors.found.pop() {
            return Err(error);
        }
        let networks = self.networks();
        if networks.get(mission.network.index()).is_none_or(|network| network.technology.ieee802154().is_none()) {
            let found = format!("number {}", mission.network.index());
            return refuse("network", found, "the number of a network of IEEE 802.15.4");
        }
        let network = &networks[mission.network.index()];
        let outside = outside(network, self.world().nodes.len());
        if outside > 0 {
            let found = format!("one without {}", counted(outside, "node"));
            return refuse("network", found, "the number of a network of all nodes");
        }
        if network.technology.ieee802154().is_some_and(|radios| !radios.hear_at_any_time()) {
            let found = "one whose nodes do not listen all the time".to_owned();
            return refuse("network", found, "the number of a network whose nodes hear each other at any time");
        }
        let robots = self.bodies().len();
        if mission.robots.is_empty() || mission.robots.iter().any(|&robot| robot >= robots) {
            let found = format!("{:?}", mission.robots);
            return refuse("robots", found, &format!("numbers of robots, of which the scenario has {robots}"));
        }
        let nodes = self.world().nodes.len();
        match &mission.map {
            _ if nodes < LEAST_PLACES => {
                refuse("map", format!("a map of {}", counted(nodes, "node")), "three nodes or more")
            }
            MissionMap::Computed(name) if !maps().any(|map| map == name) => {
                refuse("map", format!("`{name}`"), "the name of a map of the scenario")
            }
            MissionMap::File { places, .. } if places.len() != nodes => refuse(
                "map",
                format!("{} places", places.len()),
                &format!("a place, or none, for each of {nodes} nodes"),
            ),
            MissionMap::Physical | MissionMap::Computed(_) | MissionMap::File { .. } => Ok(()),
        }
    }

    /// The scenario of `file` with these settings instead of its own, checked.
    fn of(file: ScenarioFile, set: Vec<String>, seed: Option<u64>) -> Result<Self, ScenarioErrors> {
        let mut document = file.overridden(&set, seed)?;
        let text = std::mem::take(&mut document.text);
        let files = Files::of_folder(file.folder());
        let whole = deserialize(&document).map_err(ScenarioErrors::from).and_then(|mut config: ScenarioConfig| {
            let named_files = named_files(&mut config, &document, file.folder());
            named_files.iter().try_for_each(|named| file.check_named(&named.path))?;
            let mut errors = Errors::default();
            check_numbers(&document, &mut errors);
            errors.placed(&document)?;
            let parts = check(&mut config, &files, &mut errors);
            errors.placed(&document)?;
            Ok((config, named_files, parts.expect("what has no errors has all its parts")))
        });
        let (config, named_files, parts) = whole.map_err(|first| {
            let check = |document: &Document, mut config: ScenarioConfig| {
                let named_files = named_files(&mut config, document, file.folder());
                let may_be_read = named_files.iter().all(|named| file.check_named(&named.path).is_ok());
                let mut errors = Errors::default();
                check_numbers(document, &mut errors);
                if may_be_read && errors.found.is_empty() {
                    check(&mut config, &files, &mut errors);
                }
                errors.found
            };
            diagnosis::errors_of(document, &check).unwrap_or(first)
        })?;
        Ok(Self { file, set, seed, config, named_files, text, parts })
    }

    /// The file, or the text, that it was read from.
    #[must_use]
    pub fn file(&self) -> &ScenarioFile {
        &self.file
    }

    /// The settings that override that file, each `path.to.key=value`, and the seed if one does.
    #[must_use]
    pub fn overrides(&self) -> (&[String], Option<u64>) {
        (&self.set, self.seed)
    }

    /// The scenario as written, with all layers merged.
    #[must_use]
    pub fn config(&self) -> &ScenarioConfig {
        &self.config
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.config.name
    }

    /// The random seed.
    #[must_use]
    pub fn seed(&self) -> Seed {
        Seed(self.config.seed)
    }

    /// The text of the file or, if it extends another one or settings override it, of the merged settings. A seed that
    /// overrides it is not in it.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Name of the file, without its folder.
    #[must_use]
    pub fn file_name(&self) -> String {
        self.file.path().file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The files that its settings name: tables of nodes and meshes of obstacles. They are not part of its
    /// [`text`](Self::text).
    #[must_use]
    pub fn named_files(&self) -> &[NamedFile] {
        &self.named_files
    }

    /// Checks whether the grids of its maps fit the memory that they are allowed, wherever robots may stop. A sweep does not
    /// ask this, because its other cells are run in any case.
    ///
    /// # Errors
    /// If a grid does not fit.
    pub fn check_grids(&self) -> Result<(), ScenarioErrors> {
        let mut errors = Errors::default();
        let maps = self.maps().iter().map(|map| (map, self.networks_of(map)));
        check_grids(maps, &self.parts.setup, &self.config.robots, &mut errors);
        if errors.found.is_empty() { Ok(()) } else { errors.placed(&self.file.overridden(&self.set, self.seed)?) }
    }

    /// All files that it is read from: those that it extends, its own, and those that it names.
    pub fn sources(&self) -> impl Iterator<Item = &Path> {
        self.file.layers().chain(self.named_files.iter().map(|file| file.path.as_path()))
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.parts.setup.world
    }

    /// How many packets a node sends while a robot listens, in the first network that robots survey.
    #[must_use]
    pub fn packets_per_stop(&self) -> PacketsPerStop {
        self.parts.packets_per_stop
    }

    /// The networks whose logs a map uses: one, or several for a joint map.
    #[must_use]
    pub fn networks_of(&self, map: &MapJob) -> Vec<NetworkId> {
        let surveyed = self.surveyed();
        let is_called = |id: &NetworkId, name: &str| self.networks()[id.index()].name.as_deref() == Some(name);
        let called = |name: &str| surveyed.iter().copied().find(|id| is_called(id, name)).unwrap_or(surveyed[0]);
        let joint = map.mapper.networks();
        if joint.is_empty() {
            vec![map.network.as_deref().map_or(surveyed[0], called)]
        } else {
            joint.into_iter().map(called).collect()
        }
    }

    /// The robots that take part in the survey, in their order: all but the agents.
    pub fn robots_of_survey(&self) -> impl Iterator<Item = &RobotConfig<ControllerConfig>> {
        self.config.robots.iter().filter(|robot| robot.role != RoleConfig::Agent)
    }

    /// What is left out of the counts at the start.
    #[must_use]
    pub fn warm_up(&self) -> Duration {
        self.parts.warm_up
    }

    /// The named chips whose energy is counted, though they have not the band of the radios.
    #[must_use]
    pub fn foreign_chips(&self) -> &[ForeignChip] {
        &self.parts.foreign_chips
    }

    /// The chips whose energy is counted, though they have no number for something.
    #[must_use]
    pub fn incomplete_chips(&self) -> &[IncompleteChip] {
        &self.parts.incomplete_chips
    }

    /// Which part of the nodes' traffic is simulated.
    #[must_use]
    pub fn region(&self) -> SimulatedRegion {
        self.parts.region
    }

    /// All its networks.
    #[must_use]
    pub fn networks(&self) -> &[Network] {
        &self.parts.setup.networks
    }

    /// The networks that robots survey, in their order: at least one.
    #[must_use]
    pub fn surveyed(&self) -> Vec<NetworkId> {
        self.parts.setup.surveyed()
    }

    /// The maps to compute.
    #[must_use]
    pub fn maps(&self) -> &[MapJob] {
        &self.parts.maps
    }

    /// The nodes that know their position, by node, with the places that they believe in: wrong ones of those that lie.
    #[must_use]
    pub fn anchors(&self) -> &[Anchor] {
        &self.parts.anchors
    }

    /// How the nodes discover their neighbours.
    #[must_use]
    pub fn discovery(&self) -> &Discovery {
        &self.parts.discovery
    }

    /// The map that the nodes compute themselves, if they do.
    #[must_use]
    pub fn distributed(&self) -> Option<&NodeMapJob> {
        self.parts.distributed.as_ref()
    }

    /// How packets go over several hops, if they do.
    #[must_use]
    pub fn routing(&self) -> Option<&Routing> {
        self.parts.routing.as_ref()
    }

    /// What robots and nodes do on maps of the nodes.
    #[must_use]
    pub fn missions(&self) -> &[PlannedMission] {
        &self.parts.applications
    }

    /// The bodies of all robots.
    #[must_use]
    pub fn bodies(&self) -> &[RobotBody] {
        &self.parts.bodies
    }

    /// How maps are compared with the truth.
    #[must_use]
    pub fn metrics(&self) -> &MetricsConfig {
        &self.config.metrics
    }

    /// What is recorded in addition to what a mapper needs.
    #[must_use]
    pub fn recording(&self) -> &RecordingConfig {
        &self.config.recording
    }

    /// The setup of a simulation; each call returns robots at their start.
    #[must_use]
    pub fn setup(&self) -> Setup {
        self.parts.setup.clone()
    }

    /// A short description: `496 nodes, 3 obstacles, 1 robot, 1 map`.
    #[must_use]
    pub fn outline(&self) -> String {
        let world = self.world();
        let applications = Some(self.missions().len()).filter(|&count| count > 0);
        let applications = applications.map(|count| counted(count, "application"));
        let storeys = Some(self.config.world.storeys.len()).filter(|&count| count > 0);
        let walls = Some(world.walls.len()).filter(|&count| count > 0).map(|count| counted(count, "wall"));
        [counted(world.nodes.len(), "node"), counted(world.obstacles_alone(), "obstacle")]
            .into_iter()
            .chain(walls)
            .chain(storeys.map(|count| counted(count, "storey")))
            .chain([
                counted(self.config.robots.len(), "robot"),
                counted(self.config.sinks.len(), "sink"),
                counted(self.maps().len() + usize::from(self.distributed().is_some()), "map"),
            ])
            .chain(applications)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// The files that the settings name, whose paths become relative to the folder of the scenario.
fn named_files(config: &mut ScenarioConfig, document: &Document, folder: &Path) -> Vec<NamedFile> {
    let named = |(key, file): (String, &mut PathBuf)| {
        let written = file.clone();
        document.rebase(&key, file, folder);
        NamedFile { written, path: folder.join(file) }
    };
    config.files_mut().into_iter().map(named).collect()
}
