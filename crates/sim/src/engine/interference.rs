//! Interferers that turn on and off.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};

use super::bands::Band;
use crate::air::Burst;
use crate::event::Event;
use crate::network::Network;
use crate::scene::Scene;
use crate::world::interferer::Interferer;

/// A burst is cut into parts of at most this length, so that its power at a robot that drives is not of long ago.
const LONGEST_PART: Duration = Duration::from_millis(50);

/// The part of an interferer's noise that falls into one band.
#[derive(Debug)]
pub(super) struct Noise {
    interferer: Interferer,
    /// Number of the air of the band.
    air: usize,
    burst: Burst,
    /// When it will be off, while it is on.
    until: SimTime,
    /// The part on air.
    packet: u64,
}

/// The noises of all interferers in all bands.
pub(super) fn noises(interferers: &[Interferer], networks: &[Network], bands: &[Band]) -> Vec<Noise> {
    let mut noises = Vec::new();
    for (number, interferer) in (0_u32..).zip(interferers) {
        for (air, band) in bands.iter().enumerate() {
            let settings = networks[band.networks[0]].technology.settings();
            let Some(power) = settings.radio().power_of(interferer, band.spectrum.channel) else { continue };
            let source = StationId(u32::MAX - number);
            let burst = Burst { source, position: interferer.position(), power };
            noises.push(Noise { interferer: interferer.clone(), air, burst, until: SimTime::ZERO, packet: 0 });
        }
    }
    noises
}

impl Noise {
    /// Schedules the next time that it is on.
    pub(super) fn schedule(&mut self, number: u16, scene: &mut Scene) {
        let (start, end) = self.interferer.next_burst(scene.now);
        self.until = end;
        scene.at(start, Event::NoiseStarted(number));
    }

    /// A part of a burst begins.
    pub(super) fn start(&mut self, number: u16, scene: &mut Scene) {
        let now = scene.now;
        let end = self.until.min(now + LONGEST_PART);
        self.packet = scene.airs[self.air].begin_noise(now, &self.burst, end);
        scene.at(end, Event::NoiseEnded(number));
    }

    /// A part of a burst ends.
    pub(super) fn end(&mut self, number: u16, scene: &mut Scene) {
        scene.airs[self.air].end_noise(scene.now, self.packet);
        if scene.now < self.until {
            scene.at(scene.now, Event::NoiseStarted(number));
        } else {
            self.schedule(number, scene);
        }
    }
}
