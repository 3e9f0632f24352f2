//! What nodes read when they sample fields.

use std::time::Duration;

use sextant_kernel::{NodeId, Seed, SimTime};

use crate::purpose;
use crate::world::World;
use crate::world::field::Field;
use crate::world::sensors::FieldSensor;

/// The address of a sensor's offset, where samples have their time.
const OFFSET: u64 = u64::MAX;
/// The address of a node's phase, where readings have their field.
const PHASE: u64 = u64::MAX;

/// How nodes sample fields.
pub(super) struct Readings {
    sensor: FieldSensor,
    nodes: Vec<NodeId>,
    errors: Vec<Errors>,
    /// The latest sample of each field, by node.
    latest: Vec<Option<f64>>,
    seed: Seed,
}

/// Standard deviations of the errors of samples, in the unit of the field.
#[derive(Clone, Copy, Debug)]
struct Errors {
    offset: f64,
    noise: f64,
}

impl Readings {
    pub(super) fn new(sensor: FieldSensor, world: &World, nodes: Vec<NodeId>, seed: Seed) -> Self {
        let latest = vec![None; world.nodes.len() * world.fields.len()];
        let errors = world.fields.iter().map(|field| Errors::of(&sensor, mean_square(field, world))).collect();
        Self { sensor, nodes, errors, latest, seed }
    }

    /// The nodes that sample.
    pub(super) fn nodes(&self) -> impl Iterator<Item = NodeId> {
        self.nodes.iter().copied()
    }

    /// When a node takes its first sample: at its phase of the interval.
    pub(super) fn first(&self, node: NodeId) -> SimTime {
        let phase = self.seed.uniform(purpose::SENSING, [node.0.into(), PHASE, 0]);
        SimTime::ZERO + self.sensor.interval.mul_f64(phase)
    }

    /// Time between two samples of a node.
    pub(super) fn interval(&self) -> Duration {
        self.sensor.interval
    }

    /// What a node reads at `time` where the field number `field` has `value`: value + offset of the sensor (thesis,
    /// section 7.4, sensor model) + noise of the sample.
    pub(super) fn read(&mut self, node: NodeId, field: usize, value: f64, time: SimTime) -> f64 {
        let Errors { offset, noise } = self.errors[field];
        let normal = |what| self.seed.normal(purpose::SENSING, [node.0.into(), field as u64, what]);
        let drawn = |sigma: f64, what| if sigma > 0.0 { sigma * normal(what) } else { 0.0 };
        let sample = value + drawn(offset, OFFSET) + drawn(noise, time.as_nanos());
        let slot = self.slot(node, field);
        self.latest[slot] = Some(sample);
        sample
    }

    /// The latest sample of the field number `field` by a node, if there was any.
    pub(super) fn latest(&self, node: NodeId, field: usize) -> Option<f64> {
        let is_known = field < self.errors.len();
        self.latest.get(self.slot(node, field)).copied().filter(|_| is_known)?
    }

    fn slot(&self, node: NodeId, field: usize) -> usize {
        node.index() * self.errors.len() + field
    }
}

impl Errors {
    /// `sigma² = mean(D²) / 10^(SNR / 10)`, the mean over the nodes of the squared field D.
    fn of(sensor: &FieldSensor, mean_square: f64) -> Self {
        let sigma =
            |snr_db: Option<f64>| snr_db.map_or(0.0, |snr_db| (mean_square / libm::pow(10.0, snr_db / 10.0)).sqrt());
        Self { offset: sigma(sensor.offset_snr_db), noise: sigma(sensor.noise_snr_db) }
    }
}

/// The mean over all nodes of the squared value of a field, with all its sources there.
fn mean_square(field: &Field, world: &World) -> f64 {
    let squares = world.nodes.iter().map(|node| field.full_value(node.position).powi(2));
    squares.sum::<f64>() / world.nodes.len().max(1) as f64
}
