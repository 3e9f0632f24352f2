//! A robot that hops from place to place against receivers that always listen at those places: what they receive
//! differs only for frames at the ends of the robot's slots.

use std::time::Duration;

use sextant_channel::{ChannelConfig, CorrelationConfig, Position, ShadowingConfig};
use sextant_kernel::SimTime;
use sextant_sim::{PeriodicConfig, ReceptionModel, Setup, Simulation, Sink, TrafficConfig};

use crate::network;
use crate::on_air::Frames;

/// Places where the robot listens.
const PLACES: usize = 40;

/// How many frames of each kind the robot and the sink at its place received.
#[derive(Debug, Default, PartialEq, Eq)]
struct Received {
    both: u32,
    robot_only: u32,
    sink_only: u32,
    /// Of `sink_only`, frames that do not lie in the slot as a whole.
    sink_only_across_an_end: u32,
}

fn received(listen: Duration) -> Received {
    let places: Vec<_> = (0..PLACES).map(|i| Position::new((i % 8) as f64, (i / 8) as f64, 0.0)).collect();
    let nodes: Vec<_> =
        (0..200).map(|i| Position::new(f64::from(i % 20) * 0.5, f64::from(i / 20) * 0.7, 0.1)).collect();
    let traffic = TrafficConfig::Periodic(PeriodicConfig::each(60, 0.5, 0.5));
    // Without shadowing, a robot and a sink at its place have the same power.
    let shadowing = ShadowingConfig { sigma_db: Some(0.0), correlation: CorrelationConfig::PerPacket };
    let channel = ChannelConfig { shadowing: Some(shadowing), max_range_m: Some(4.0), ..ChannelConfig::default() };
    let setup = network::setup(&nodes, -40.0, channel, traffic, 3);
    let setup =
        network::with(setup, |network| network::receive_by(network, ReceptionModel::SinrThreshold { least: 2.0 }));
    let sink = |(i, &position): (usize, &Position)| Sink { name: format!("sink{i}"), position, networks: None };
    let mut robot = network::tour(places.clone(), 0.0, listen);
    robot.body.speed_m_per_s = 1e6;
    let setup = Setup { robots: vec![robot], sinks: places.iter().enumerate().map(sink).collect(), ..setup };
    // Its start, its end, and the collectors that received it (0 is the robot, 1 + i the sink at place i).
    let mut air = Frames::kept(|frame| {
        let heard: Vec<usize> = frame.heard.iter().map(|heard| heard.collector).collect();
        (frame.start, frame.start + frame.airtime, heard)
    });
    let survey = Simulation::new(setup).expect("good settings").run(&mut air);
    let mut counts = Received::default();
    for (i, stop) in survey.log().stops().iter().enumerate() {
        let (from, to) = (stop.time, stop.time + listen);
        let is_across = |start: SimTime, end: SimTime| start < from && end > from || start < to && end > to;
        for (start, end, heard) in air.0.iter().filter(|(start, end, _)| *end > from && *start < to) {
            let (by_robot, by_sink) = (heard.contains(&0) && *start >= from, heard.contains(&(1 + i)));
            counts.both += u32::from(by_robot && by_sink);
            // A sink may still follow a frame that began before the robot came.
            let is_late = |(start_before, end_before, _): &(SimTime, SimTime, Vec<usize>)| {
                *start_before < from && *end_before > *start
            };
            counts.robot_only += u32::from(by_robot && !by_sink && !air.0.iter().any(is_late));
            counts.sink_only += u32::from(by_sink && !by_robot);
            counts.sink_only_across_an_end += u32::from(by_sink && !by_robot && is_across(*start, *end));
        }
    }
    counts
}

#[test]
fn a_robot_receives_what_a_receiver_that_is_always_there_receives_but_for_frames_across_the_ends_of_slots() {
    for listen in [Duration::from_millis(100), Duration::from_millis(400)] {
        let counts = received(listen);
        assert!(counts.both > 500, "{listen:?}: {counts:?}");
        assert_eq!(counts.robot_only, 0, "{listen:?}: {counts:?}");
        assert_eq!(counts.sink_only, counts.sink_only_across_an_end, "{listen:?}: {counts:?}");
    }
}
