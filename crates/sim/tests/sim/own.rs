//! Nodes, robots and sinks that all have applications of their own.

mod capture;
mod polling;
mod space;

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::Seed;
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{Network, NetworkId, Robot, RobotBody, RobotTask, Setup, SilentConfig, Sink, TrafficConfig, World};

use crate::network;

const NETWORK: NetworkId = NetworkId(0);

/// A world whose nodes, of one network with a range of 10 m, send nothing by themselves, a robot that starts at each of
/// `robots` and drives at 1 m/s, and sinks.
fn setup(world: World, robots: &[[f64; 3]], sinks: &[[f64; 3]], duration_s: f64, seed: u64) -> Setup {
    let traffic = network::plan(TrafficConfig::Silent(SilentConfig {}), world.nodes.len());
    let csma = CsmaConfig { rx_on_when_idle: true, queue_frames: 4, ..CsmaConfig::default() };
    let link = network::link(10.0, csma);
    let body = |(i, &start): (usize, &[f64; 3])| RobotBody {
        speed_m_per_s: 1.0,
        ..network::body(&format!("robot-{i}"), start.into())
    };
    let sink = |(i, &position): (usize, &[f64; 3])| Sink {
        name: format!("sink-{i}"),
        position: Position::from(position),
        networks: None,
    };
    Setup {
        robots: robots.iter().enumerate().map(body).map(|body| Robot { body, task: RobotTask::Own }).collect(),
        sinks: sinks.iter().enumerate().map(sink).collect(),
        duration: Some(Duration::from_secs_f64(duration_s)),
        ..Setup::of(world, Network { traffic, ..link }, Seed(seed))
    }
}
