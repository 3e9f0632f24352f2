//! What is likely a mistake, although it can be simulated.

use std::collections::BTreeSet;
use std::fmt;

use sextant_apps::routing::{RoutingConfig, RplMode, TreeConfig};
use sextant_kernel::NodeId;
use sextant_kernel::text::{counted, listed};
use sextant_mac::EnergyConfig;
use sextant_mac::sleep::Check;
use sextant_scenario::{ForeignChip, IncompleteChip, Scenario};
use sextant_sim::{RobotTask, Setup, Technology};

use super::idle_obstacles::{APART, Audience};
use super::network::Reach;
use super::way::{Way, is_planned};

/// A loss at 1 m below this (dB) is none of a radio wave from its antenna: that of free space is 31 dB at 868 MHz.
const LEAST_LOSS_DB: f64 = 20.0;

/// With fewer retries a frame may well fail though its link is good, if its node sends more often than this (1/s).
const FEW_RETRIES: u8 = 5;
const RARE_PER_S: f64 = 0.05;

/// Powers at 1 m above this (dBm) are those of no small radio: 30 dBm at the antenna is -10 dBm there at 2.4 GHz.
const STRONG_DBM: f64 = -10.0;

/// Something that is likely a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The key that it is about.
    pub key: String,
    /// What follows from it, and what to do.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}", self.key, self.message)
    }
}

/// What is likely a mistake in `scenario`, although it can be simulated.
#[must_use]
pub fn warnings(scenario: &Scenario) -> Vec<Warning> {
    let setup = scenario.setup();
    let reaches = Reach::all(&setup);
    let planned: Vec<_> = setup
        .robots
        .iter()
        .filter(|robot| is_planned(scenario, robot))
        .filter_map(|robot| Way::driven(robot, true, &reaches))
        .collect();
    let mut warnings = Warnings { scenario, setup: &setup, found: Vec::new() };
    reaches.iter().for_each(|reach| warnings.loss_at_a_metre(reach));
    reaches.iter().for_each(|reach| warnings.programs(reach));
    reaches.iter().for_each(|reach| warnings.slotframes(reach));
    reaches.iter().for_each(|reach| warnings.deaf_checks(reach));
    reaches.iter().for_each(|reach| warnings.futile_cells(reach));
    reaches.iter().for_each(|reach| warnings.late_packets(reach));
    warnings.chips();
    warnings.route_tables();
    warnings.idle_keys_of_routing();
    reaches.iter().for_each(|reach| warnings.idle_keys_of_mac(reach));
    warnings.unheard_interferers(&reaches);
    warnings.late_deaths();
    reaches.iter().for_each(|reach| warnings.tries_of_rpl(reach));
    warnings.short_stops(&reaches);
    planned.iter().for_each(|way| warnings.way(way));
    warnings.out_of_reach(&planned);
    warnings.sinks(&reaches);
    reaches.iter().for_each(|reach| warnings.endless_cuts(reach));
    reaches.iter().for_each(|reach| warnings.sunk_stations(reach));
    reaches.iter().for_each(|reach| warnings.changes(reach));
    warnings.obstacles(&reaches, &planned);
    warnings.found
}

pub(super) struct Warnings<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) setup: &'a Setup,
    found: Vec<Warning>,
}

impl Warnings<'_> {
    pub(super) fn warn(&mut self, key: impl Into<String>, message: impl Into<String>) {
        // The robots of a team have one table.
        let warning = Warning { key: key.into(), message: message.into() };
        if !self.found.contains(&warning) {
            self.found.push(warning);
        }
    }

    /// Powers at 1 m that no small radio has.
    fn loss_at_a_metre(&mut self, reach: &Reach<'_>) {
        let loss_db = reach.law().path_loss().loss(1.0).0;
        let power_dbm = reach.network.technology.tx_power().0;
        if loss_db < LEAST_LOSS_DB && power_dbm - loss_db > STRONG_DBM {
            let table = reach.table();
            let at_antenna_dbm = power_dbm - loss_db + 40.0;
            self.warn(
                format!("{table}channel.path_loss.log_distance.reference_loss_db"),
                format!(
                    "the loss over 1 m is {loss_db:.1} dB, so {power_dbm} dBm is the power at 1 m, as of about \
                     {at_antenna_dbm:.0} dBm at an antenna at 2.4 GHz; remove the key for the loss of free space"
                ),
            );
        }
    }

    /// Networks whose radios do nothing without programs.
    fn programs(&mut self, reach: &Reach<'_>) {
        if reach.network.technology.is_programmed() {
            let table = reach.table();
            self.warn(
                format!("{table}mac.program"),
                "no program comes with a scenario, so the nodes are silent; run it by the library or in Python with programs \
                 of the nodes",
            );
        }
    }

    /// Slotframes that hop over a part of the channels alone, and clocks that nothing sets again.
    fn slotframes(&mut self, reach: &Reach<'_>) {
        let Technology::Tsch(links) = &reach.network.technology else { return };
        let table = reach.table();
        let channels = links.tsch.hopping.channels().len();
        for (key, length) in links.tsch.slotframes() {
            let visited = links.tsch.hopping.channels_visited(length);
            if visited < channels {
                self.warn(
                    format!("{table}mac.tsch.schedule.{key}"),
                    format!(
                        "a cell in {length} slots comes on {visited} of the {channels} channels; a length that has no \
                         factor in common with {channels} hops over all of them"
                    ),
                );
            }
        }
        if links.radio.has_drift() && links.tsch.beacon_interval.is_none() {
            self.warn(
                format!("{table}mac.tsch.beacons"),
                "absent, and clocks drift: without beacons, a node that loses the network never finds it again",
            );
        }
    }

    /// Checks of the channel that miss frames which could be received.
    fn deaf_checks(&mut self, reach: &Reach<'_>) {
        let technology = &reach.network.technology;
        let looks = technology.sleeping().is_some_and(|links| matches!(links.sleep.check(), Check::Looks(_)));
        let (threshold, sensitivity) = (technology.carrier_sense_threshold(), technology.sensitivity());
        if looks && threshold > sensitivity {
            let table = reach.table();
            self.warn(
                format!("{table}radio.cca_threshold_dbm"),
                format!(
                    "checks with two looks find the channel busy from {} dBm on, so that frames between {} dBm and \
                     that wake nobody; set it to `sensitivity_dbm` if all that can be received is to wake",
                    threshold.0, sensitivity.0
                ),
            );
        }
    }

    /// Chips whose energy is counted, but that have not the band of the radios, or no number for something.
    fn chips(&mut self) {
        for ForeignChip { key, chip, bands, phy } in self.scenario.foreign_chips() {
            self.warn(
                key,
                format!(
                    "`{}` is a chip for {bands}, and the radios have `phy = \"{}\"`; remove the key to count the energy of \
                     `{}`, or give currents of your own",
                    chip.name(),
                    phy.name(),
                    EnergyConfig::usual(*phy).name(),
                ),
            );
        }
        for IncompleteChip { key, chip, gap } in self.scenario.incomplete_chips() {
            self.warn(key, format!("`{}` {gap}; give currents of your own in `[{key}.custom]`", chip.name()));
        }
    }

    /// Tables of ways down that are too small for the sink.
    fn route_tables(&mut self) {
        let Some(TreeConfig::Rpl(rpl)) = self.scenario.config().routing.as_ref().map(|routing| &routing.tree) else {
            return;
        };
        let nodes = self.setup.world.nodes.len();
        if rpl.mode == RplMode::Storing && self.setup.sinks.len() == 1 && usize::from(rpl.route_table) < nodes {
            self.warn(
                "routing.tree.rpl.route_table",
                format!(
                    "the sink has room for ways to {} of {}; packets to the others are dropped; give it at least {nodes}",
                    rpl.route_table,
                    counted(nodes, "node"),
                ),
            );
        }
    }

    /// Few tries of a hop, each counted by itself, with which RPL takes a few collisions for a bad link.
    fn tries_of_rpl(&mut self, reach: &Reach<'_>) {
        let Some(RoutingConfig { tree: TreeConfig::Rpl(_), resends, .. }) = self.scenario.config().routing else {
            return;
        };
        let Technology::Ieee802154(links) = &reach.network.technology else { return };
        let retries = links.mac.csma().max_retries();
        if retries < FEW_RETRIES && reach.rate_per_s().is_none_or(|rate_per_s| rate_per_s > RARE_PER_S) {
            let table = reach.table();
            self.warn(
                format!("{table}mac.csma_unslotted.max_retries"),
                format!(
                    "{retries}, with `routing.resends` = {resends}: a frame that fails counts as 12 transmissions, so a few collisions make \
                     RPL give up good links, and few packets may arrive; Contiki-NG has 7, with `routing.resends` = 0"
                ),
            );
        }
    }

    /// Planar cuts whose gains are taken for all elevations.
    fn endless_cuts(&mut self, reach: &Reach<'_>) {
        let Some(antennas) = reach.network.technology.antennas() else { return };
        let table = reach.table();
        for (who, antenna) in [("nodes", antennas.nodes()), ("robots", antennas.robots())] {
            if let Some(elevation_deg) = antenna.endless_cut_deg() {
                self.warn(
                    format!("{table}antenna.{who}.code_book.vertical_width_deg"),
                    format!(
                        "absent, so the gains that were measured at elevation {elevation_deg} hold at all elevations; \
                         give the half-power width of the beams in elevation, and `outside_gain_dbi` for what is beyond"
                    ),
                );
            }
        }
    }

    /// Stations that are not above the ground, so that it reflects nothing to them.
    fn sunk_stations(&mut self, reach: &Reach<'_>) {
        let Some(ground_m) = reach.law().ground_z_m() else { return };
        let nodes = reach.nodes.iter().map(|(_, place)| place.z_m);
        let robots = self.setup.robots.iter().filter(|robot| robot.body.networks.contains(&reach.id));
        let sinks = self.setup.sinks.iter().filter(|sink| sink.is_in(reach.id));
        let heights_m: Vec<f64> = nodes
            .chain(robots.map(|robot| robot.body.start.z_m))
            .chain(sinks.map(|sink| sink.position.z_m))
            .collect();
        let sunk = heights_m.iter().filter(|&&z_m| z_m <= ground_m).count();
        if sunk == 0 || !self.setup.world.motions.is_empty() {
            return;
        }
        let lowest_m = heights_m.iter().copied().fold(f64::INFINITY, f64::min);
        let table = reach.table();
        self.warn(
            format!("{table}channel.reflections.ground_z_m"),
            format!(
                "{sunk} of {} are not above the ground at {ground_m} m, which reflects nothing to them; put it below the lowest one, \
                 at {lowest_m} m",
                counted(heights_m.len(), "station"),
            ),
        );
    }

    /// Stops at which a node may well send nothing.
    fn short_stops(&mut self, reaches: &[Reach<'_>]) {
        for robot in self.setup.robots.iter().filter(|robot| matches!(robot.task, RobotTask::Survey(_))) {
            let listen_s = robot.body.listen.as_secs_f64();
            let surveyed = reaches.iter().filter(|reach| robot.body.networks.contains(&reach.id));
            let interval_s = surveyed
                .filter_map(|reach| reach.rate_per_s())
                .filter(|rate_per_s| *rate_per_s > 0.0)
                .map(|rate_per_s| 1.0 / rate_per_s)
                .fold(0.0, f64::max);
            if interval_s > listen_s * (1.0 + 1e-9) {
                let table = self.table_of(&robot.body.name);
                self.warn(
                    format!("{table}.listen_s"),
                    format!(
                        "it listens for {listen_s} s, and a node sends every {interval_s} s on average: at a stop it may \
                         miss nodes in reach; listen for at least {interval_s} s"
                    ),
                );
            }
        }
    }

    fn table_of(&self, robot: &str) -> String {
        let config = self.scenario.config();
        let number = config.robots.iter().position(|config| config.name == robot).unwrap_or(0);
        config.table_of_robot(number)
    }

    /// Robots that never move.
    fn way(&mut self, way: &Way<'_>) {
        if way.length_m() < 1e-9 && way.stops().len() < 2 {
            let table = self.table_of(&way.body().name);
            self.warn(format!("{table}.controller"), "the robot never moves: its path has no length");
        }
    }

    /// Nodes that no robot can hear, if all ways are known to their ends.
    fn out_of_reach(&mut self, planned: &[Way<'_>]) {
        let surveys = self.setup.robots.iter().filter(|robot| robot.is_surveying()).count();
        if planned.is_empty() || planned.len() < surveys || planned.iter().any(Way::is_cut) {
            return;
        }
        let mut deaf = planned[0].out_of_reach();
        for way in &planned[1..] {
            let others: BTreeSet<NodeId> = way.out_of_reach().into_iter().collect();
            deaf.retain(|node| others.contains(node));
        }
        if deaf.is_empty() {
            return;
        }
        let names: Vec<_> = deaf.iter().map(|node| self.setup.world.nodes[node.index()].name.as_str()).collect();
        let table = self.table_of(&planned[0].body().name);
        self.warn(
            format!("{table}.controller"),
            format!(
                "from {} of {} less than 1 % of the packets arrive at each planned stop: {}; plan stops nearer to them",
                deaf.len(),
                counted(self.setup.world.nodes.len(), "node"),
                listed(&names),
            ),
        );
    }

    /// Sinks that hear no node.
    fn sinks(&mut self, reaches: &[Reach<'_>]) {
        if !self.setup.world.motions.is_empty() {
            return;
        }
        for (i, sink) in self.setup.sinks.iter().enumerate() {
            let is_in = |reach: &&Reach<'_>| sink.is_in(reach.id);
            if reaches.iter().filter(is_in).any(Reach::is_measured) {
                continue;
            }
            let mut heard = reaches.iter().filter(is_in).flat_map(|reach| {
                reach.in_reach(sink.position).map(|(_, from)| reach.probability(*from, sink.position))
            });
            if !heard.any(|probability| probability >= 0.01) {
                self.warn(
                    format!("sinks[{i}].position_m"),
                    format!("the sink `{}` hears each node at less than 1 %; move it, or raise the power", sink.name),
                );
            }
        }
    }

    /// Obstacles that change neither signals nor ways of robots.
    fn obstacles(&mut self, reaches: &[Reach<'_>], planned: &[Way<'_>]) {
        if !self.setup.world.motions.is_empty() {
            return;
        }
        let idle = Audience { scenario: self.scenario, setup: self.setup, reaches, planned }.idle_obstacles();
        let walls = &self.setup.world.walls;
        let pieces = self.setup.world.obstacles_alone();
        // Of a wall, some piece is often out of the way: what is above a door, for example.
        let is_idle = |i: usize| idle.iter().any(|&(other, _)| other == i);
        let wall = walls.iter().position(|pieces| pieces.clone().all(is_idle));
        let idle: Vec<_> = idle.iter().filter(|(i, _)| *i < pieces).collect();
        let Some(&&(i, why)) = idle.first() else {
            if let Some(wall) = wall {
                let name = self.scenario.config().world.walls[wall].name.as_ref();
                let name = name.map_or(String::new(), |name| format!(" `{name}`"));
                self.warn(format!("world.walls[{wall}]"), format!("the wall{name} blocks nothing: {APART}"));
            }
            return;
        };
        let others = match idle.len() {
            1 => String::new(),
            count => format!(" (and {} more)", counted(count - 1, "obstacle")),
        };
        let obstacle = &self.setup.world.obstacles.obstacles()[i];
        let name = obstacle.name().map_or(String::new(), |name| format!(" `{name}`"));
        self.warn(format!("world.obstacles[{i}]"), format!("the obstacle{name} blocks nothing: {why}{others}"));
    }
}
