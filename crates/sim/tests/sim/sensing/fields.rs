//! Samples of scalar fields.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{
    Application, Field, FieldConfig, FieldId, FieldSensorConfig, GaussianConfig, Observer, Port, Sensed, Sensors,
    SensorsConfig, Timer, World,
};

use super::{run, watched};
use crate::network;

const GAS: FieldId = FieldId(0);

fn gas() -> Field {
    let source = GaussianConfig {
        center_m: Position::new(5.0, 5.0, 0.0),
        peak: 10.0,
        sigma_m: 4.0,
        appears_s: 0.0,
        removed_s: None,
        fades: None,
    };
    let other = GaussianConfig { center_m: Position::new(30.0, 5.0, 0.0), appears_s: 12.0, ..source };
    Field::try_from(&FieldConfig { name: "gas".into(), gaussians: vec![source, other] }).expect("good settings")
}

/// A square of nodes that sample the field.
fn world(side: u32, sensor: FieldSensorConfig) -> World {
    let place = |i: u32| Position::new(f64::from(i % side), f64::from(i / side), 0.0);
    let places: Vec<Position> = (0..side * side).map(place).collect();
    let sensors = SensorsConfig { targets: None, fields: Some(sensor) };
    let sensors = Sensors::try_from(sensors).expect("good settings");
    World { nodes: network::nodes(&places), fields: vec![gas()], sensors, ..World::default() }
}

const EXACT: FieldSensorConfig = FieldSensorConfig { interval_s: 2.0, offset_snr_db: None, noise_snr_db: None };

/// The errors of all samples of `world`, by node.
fn errors(world: World, duration_s: f64, seed: u64) -> Vec<Vec<f64>> {
    let (nodes, field) = (world.nodes.clone(), world.fields[0].clone());
    let (ended, _) = watched(world, duration_s, seed);
    let error = |node: usize, time: SimTime, sensed: Sensed| match sensed {
        Sensed::Sampled { field: GAS, value } => value - field.value(nodes[node].position, time),
        other => panic!("{other:?}"),
    };
    let of_node = |(node, watcher): (usize, &super::Watcher)| {
        watcher.sensed.iter().map(|&(time, sensed)| error(node, time, sensed)).collect()
    };
    ended.applications.iter().enumerate().map(of_node).collect()
}

#[test]
fn perfect_sensors_read_the_field_once_an_interval_each_at_its_phase() {
    let errors = errors(world(6, EXACT), 20.0, 1);
    assert!(errors.iter().all(|errors| errors.len() == 10 && errors.iter().all(|error| error.abs() < 1e-15)));
    let (ended, _) = watched(world(6, EXACT), 20.0, 1);
    let firsts: std::collections::BTreeSet<_> = ended.applications.iter().map(|w| w.sensed[0].0).collect();
    assert_eq!(firsts.len(), 36, "no two nodes sample at the same instant");
    for watcher in &ended.applications {
        assert!(watcher.sensed.windows(2).all(|pair| pair[1].0 - pair[0].0 == Duration::from_secs(2)));
    }
}

#[test]
fn offsets_and_noise_have_the_power_of_their_ratios() {
    let world = || world(30, EXACT);
    let nodes = world().nodes;
    let field = gas();
    let mean_square =
        nodes.iter().map(|node| field.full_value(node.position).powi(2)).sum::<f64>() / nodes.len() as f64;
    for snr_db in [10.0, 20.0, 30.0] {
        let sigma = (mean_square / 10_f64.powf(snr_db / 10.0)).sqrt();
        let with = |sensor| World {
            sensors: Sensors::try_from(SensorsConfig { targets: None, fields: Some(sensor) }).unwrap(),
            ..world()
        };
        let offsets = errors(with(FieldSensorConfig { offset_snr_db: Some(snr_db), ..EXACT }), 10.0, 7);
        assert!(offsets.iter().all(|errors| errors.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 1e-12)));
        let noise = errors(with(FieldSensorConfig { noise_snr_db: Some(snr_db), ..EXACT }), 10.0, 7);
        assert!(noise.iter().all(|errors| errors.windows(2).all(|pair| (pair[1] - pair[0]).abs() > 0.0)));
        let firsts: Vec<f64> = offsets.iter().map(|errors| errors[0]).collect();
        let all: Vec<f64> = noise.into_iter().flatten().collect();
        for errors in [firsts, all] {
            let n = errors.len() as f64;
            let mean = errors.iter().sum::<f64>() / n;
            let square = errors.iter().map(|error| error * error).sum::<f64>() / n;
            // Five standard errors each: a false alarm in 1.7 million.
            assert!(mean.abs() < 5.0 * sigma / n.sqrt(), "mean {mean} with {snr_db} dB");
            assert!((square / sigma.powi(2) - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "power {square} with {snr_db} dB");
        }
    }
}

/// The first node removes the sources near it after 5 s.
#[derive(Default)]
struct Remover {
    removed: Option<usize>,
    samples: Vec<(SimTime, f64)>,
}

impl Application for Remover {
    fn senses(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if port.station().index() == 0 {
            port.after(Duration::from_secs(5), Timer(0));
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        self.removed = Some(port.remove_sources(8.0));
        assert_eq!(port.remove_sources(8.0), 0);
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        let Sensed::Sampled { value, .. } = *sensed else { panic!("{sensed:?}") };
        self.samples.push((port.now(), value));
    }
}

#[derive(Default)]
struct Removals(Vec<(FieldId, usize, SimTime)>);

impl Observer for Removals {
    fn source_removed(&mut self, field: FieldId, source: usize, time: SimTime) {
        self.0.push((field, source, time));
    }
}

#[test]
fn an_application_removes_the_sources_that_it_can_reach() {
    let mut removals = Removals::default();
    let applications = (0..4).map(|_| Remover::default()).collect();
    let ended = run(world(2, EXACT), applications, 10.0, 1, &mut removals);
    let at = SimTime::ZERO + Duration::from_secs(5);
    assert_eq!((ended.applications[0].removed, removals.0), (Some(1), vec![(GAS, 0, at)]));
    for application in &ended.applications {
        assert!(application.samples.iter().all(|&(time, value)| (value > 1.0) == (time < at)));
    }
}
