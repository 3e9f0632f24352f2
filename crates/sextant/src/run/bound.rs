//! A lower bound on the error of any map of a simulated survey.

use sextant_channel::{Channel, Position};
use sextant_kernel::{Interrupted, Watch};
use sextant_mapper::{TrueModel, at_least_one};
use sextant_sim::{OdometryConfig, Packets, Survey};

use crate::scenario::Scenario;

/// The posterior bound (m), computed from which slots heard a node, with the true channel and obstacles. Losses by
/// collision are taken to be independent of the distance. `None` if receptions at different stops are not independent,
/// robots listen for different times or do not know where they are, a node must hear a beacon before it sends, or nothing
/// was heard.
pub(super) fn posterior_bound_m(
    scenario: &Scenario,
    survey: &Survey,
    truth: &[Position],
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let id = scenario.surveyed()[0];
    let network = &scenario.networks()[id.index()];
    let packets_per_stop = scenario.packets_per_stop();
    // Nodes that hear a beacon or a sweep first are not heard independently of that.
    let beacons_come_first = network.technology.has_coordinator() || network.technology.antennas().is_some();
    let is_independent = !network.channel.shadowing().is_spatial();
    let places_are_known = scenario.robots_of_survey().all(|robot| robot.odometry == OdometryConfig::default());
    if !(is_independent && packets_per_stop.is_alike && places_are_known) || beacons_come_first {
        return Ok(None);
    }
    let obstacles = scenario.world().obstacles.clone();
    let channel = Channel::new(network.channel, obstacles, scenario.seed());
    let (tx, sensitivity) = (network.technology.tx_power(), network.technology.sensitivity());
    let of_nodes = &survey.networks[id.index()].packets[..truth.len()];
    let packets: Packets = of_nodes.iter().copied().sum();
    let delivery = packets.received as f64 / (packets.received + packets.lost_collision).max(1) as f64;
    let law = channel.law();
    let stops = survey.log().stops();
    let probability = |stop: u32, place: Position| {
        let stop = stops[stop as usize].position;
        let distance_m = place.distance_m(stop);
        if distance_m > law.max_range_m() {
            return 0.0;
        }
        let obstacle_loss = channel.obstacle_loss(place, stop);
        let q = law.reception_probability(tx, sensitivity, distance_m, obstacle_loss);
        at_least_one(delivery * q, packets_per_stop.mean)
    };
    let low = truth.iter().map(|place| place.z_m).fold(f64::INFINITY, f64::min);
    let high = truth.iter().map(|place| place.z_m).fold(f64::NEG_INFINITY, f64::max);
    let model = TrueModel { probability, near: truth, reach_m: law.reach_m(tx, sensitivity), z_range_m: [low, high] };
    // The probability is that of a slot: at least one packet is received.
    sextant_mapper::posterior_bound_m(&survey.log().at_least_one(), &model, watch)
}
