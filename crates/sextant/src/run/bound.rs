//! A lower bound on the error of any map of a simulated survey.

use std::borrow::Cow;
use std::sync::OnceLock;

use sextant_channel::{Bounds, Channel, Position};
use sextant_kernel::{Interrupted, Watch};
use sextant_mapper::{KnowledgeKind, TrueModel, TrueRanges, range_bound_m};
use sextant_sim::{OdometryConfig, Packets, Survey};

use sextant_scenario::{MapJob, Scenario};

/// The bound of a survey, or why there is none.
pub type SurveyBound = Result<f64, NoBound>;

/// The bound of a survey, which is computed when the first map asks for it: it takes longer than many maps.
#[derive(Clone, Debug, Default)]
pub struct LazyBound(OnceLock<SurveyBound>);

impl LazyBound {
    /// The bound of `survey`, which is always the same.
    fn of(&self, scenario: &Scenario, survey: &Survey, watch: &dyn Watch) -> Result<SurveyBound, Interrupted> {
        if let Some(known) = self.0.get() {
            return Ok(known.clone());
        }
        let places: Vec<Position> = scenario.world().nodes.iter().map(|node| node.position).collect();
        let bound = posterior_bound(scenario, survey, &places, watch)?;
        Ok(self.0.get_or_init(|| bound).clone())
    }
}

/// Why maps of a survey have no bound.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoBound {
    /// The shadowing at stops depends on that at others.
    #[error("shadowing is shared by neighbouring stops, so that receptions are not independent")]
    SharedShadowing,
    /// Links fade, or have bursts of loss, for longer than a frame.
    #[error("links fade for longer than a frame, so that receptions are not independent")]
    SharedFading,
    /// Robots listen for different times.
    #[error("robots listen for different times")]
    ListeningTimes,
    /// Robots do not know where they are.
    #[error("robots do not know exactly where they are")]
    Odometry,
    /// Nodes hear a beacon or a sweep before they send.
    #[error("nodes are only heard where they have heard a beacon or a sweep first")]
    BeaconsFirst,
    /// No node was heard, or there is no map.
    #[error("no node was heard")]
    NothingHeard,
    /// The receptions tell less than where nodes are anyway.
    #[error(
        "receptions or ranges tell less ({bound_m:.0} m) than that the nodes are in their area ({spread_m:.0} m)"
    )]
    Wide {
        /// The mean distance of a node from its posterior mean (m).
        bound_m: f64,
        /// The same of a node anywhere in the area of the nodes (m).
        spread_m: f64,
    },
    /// The map is of another network than the first that robots survey, or of several.
    #[error("it is of the first network that robots survey, and this map uses another")]
    OtherNetwork,
    /// The map uses knowledge that the bound does not have.
    #[error("it does not know what this map uses: {0}")]
    MoreKnowledge(String),
}

/// The bound of the map `named`: that of the survey, if the map uses nothing that this does not know. `None` if a map of its kind has
/// none.
///
/// # Errors
/// If `watch` stops the work.
pub(super) fn of_map(
    scenario: &Scenario,
    named: &MapJob,
    survey: &Survey,
    bound: &LazyBound,
    watch: &dyn Watch,
) -> Result<Option<SurveyBound>, Interrupted> {
    let uses = named.mapper.uses();
    if uses.contains(&KnowledgeKind::RobotRanges) && !uses.contains(&KnowledgeKind::RobotReceptions) {
        return Ok(Some(of_ranges(scenario, named, survey)));
    }
    if !uses.contains(&KnowledgeKind::RobotReceptions) {
        return Ok(None);
    }
    if scenario.networks_of(named) != scenario.surveyed()[..1] {
        return Ok(Some(Err(NoBound::OtherNetwork)));
    }
    let is_known = |kind: &KnowledgeKind| match kind {
        KnowledgeKind::RobotReceptions
        | KnowledgeKind::RobotPath
        | KnowledgeKind::PathLoss
        | KnowledgeKind::Obstacles => true,
        KnowledgeKind::RobotRssi
        | KnowledgeKind::RobotRanges
        | KnowledgeKind::Neighbours
        | KnowledgeKind::NeighbourRssi
        | KnowledgeKind::AnchorReceptions
        | KnowledgeKind::AnchorRssi
        | KnowledgeKind::Anchors => false,
    };
    let mut more: Vec<&str> = uses.iter().filter(|kind| !is_known(kind)).map(|kind| kind.name()).collect();
    if named.mapper.counts_packets() && matches!(survey.log().at_least_one(), Cow::Owned(_)) {
        more.push("numbers of packets");
    }
    if more.is_empty() {
        bound.of(scenario, survey, watch).map(Some)
    } else {
        Ok(Some(Err(NoBound::MoreKnowledge(more.join(", ")))))
    }
}

/// Whether all robots know where they are.
fn places_are_known(scenario: &Scenario) -> bool {
    let mut robots = scenario.robots_of_survey();
    robots.all(|robot| robot.odometry == OdometryConfig::default() && robot.frame.is_world())
}

/// The bound of a map by ranges: with their true law, and the true obstacles.
fn of_ranges(scenario: &Scenario, named: &MapJob, survey: &Survey) -> SurveyBound {
    let id = scenario.surveyed()[0];
    if scenario.networks_of(named) != [id] {
        return Err(NoBound::OtherNetwork);
    }
    if !places_are_known(scenario) {
        return Err(NoBound::Odometry);
    }
    let network = &scenario.networks()[id.index()];
    let device = network.ranging.ok_or(NoBound::NothingHeard)?;
    let channel = Channel::new(network.channel, scenario.world().obstacles.clone(), scenario.seed());
    let places: Vec<Position> = scenario.world().nodes.iter().map(|node| node.position).collect();
    let height_m = places.first().map_or(0.0, |place| place.z_m);
    let model = TrueRanges {
        device: &device,
        is_blocked: &|from, to| channel.obstacle_loss(from, to).0 > 0.0,
        places: &places,
        heights_are_known: places.iter().all(|place| place.z_m.to_bits() == height_m.to_bits()),
    };
    let spread_m = spread_m(&places);
    match range_bound_m(survey.log(), &model) {
        None => Err(NoBound::NothingHeard),
        Some(bound_m) if bound_m > spread_m => Err(NoBound::Wide { bound_m, spread_m }),
        Some(bound_m) => Ok(bound_m),
    }
}

/// The mean distance from the middle of a place anywhere in the box around `places` (m), as the root of the mean square.
fn spread_m(places: &[Position]) -> f64 {
    let size = Bounds::of(places.iter().copied()).map_or(Position::ORIGIN, |bounds| bounds.max - bounds.min);
    ((size.x_m * size.x_m + size.y_m * size.y_m + size.z_m * size.z_m) / 12.0).sqrt()
}

/// The posterior bound (m), computed from which slots heard a node, with the true channel and obstacles. Losses by
/// collision are taken to be independent of the distance.
fn posterior_bound(
    scenario: &Scenario,
    survey: &Survey,
    truth: &[Position],
    watch: &dyn Watch,
) -> Result<SurveyBound, Interrupted> {
    let id = scenario.surveyed()[0];
    let network = &scenario.networks()[id.index()];
    let packets_per_stop = scenario.packets_per_stop();
    // Nodes that hear a beacon or a sweep first are not heard independently of that.
    let beacons_come_first = network.technology.has_coordinator() || network.technology.antennas().is_some();
    let is_independent = !network.channel.shadowing().is_spatial();
    let law = &network.channel;
    let changes = law.fading().is_some() || law.bursts().is_some() || network.link_trace.is_some();
    for (is_met, why) in [
        (is_independent, NoBound::SharedShadowing),
        (!changes, NoBound::SharedFading),
        (packets_per_stop.is_alike, NoBound::ListeningTimes),
        (places_are_known(scenario), NoBound::Odometry),
        (!beacons_come_first, NoBound::BeaconsFirst),
    ] {
        if !is_met {
            return Ok(Err(why));
        }
    }
    let obstacles = scenario.world().obstacles.clone();
    let channel = Channel::new(network.channel, obstacles, scenario.seed());
    let (tx, sensitivity) = (network.technology.tx_power(), network.technology.sensitivity());
    let of_nodes = &survey.networks[id.index()].packets[..truth.len()];
    let packets: Packets = of_nodes.iter().copied().sum();
    let delivery = packets.received as f64 / (packets.received + packets.lost_collision).max(1) as f64;
    let low = truth.iter().map(|place| place.z_m).fold(f64::INFINITY, f64::min);
    let high = truth.iter().map(|place| place.z_m).fold(f64::NEG_INFINITY, f64::max);
    let model = TrueModel {
        channel: &channel,
        tx,
        sensitivity,
        delivery,
        packets_per_stop: packets_per_stop.mean,
        near: truth,
        z_range_m: [low, high],
    };
    // The probability is that of a slot: at least one packet is received.
    let bound_m = sextant_mapper::posterior_bound_m(&survey.log().at_least_one(), &model, watch)?;
    let spread_m = spread_m(truth);
    Ok(match bound_m {
        None => Err(NoBound::NothingHeard),
        Some(bound_m) if bound_m > spread_m => Err(NoBound::Wide { bound_m, spread_m }),
        Some(bound_m) => Ok(bound_m),
    })
}
