//! A bootstrap particle filter (Gordon, Salmond and Smith 1993) for a target that is seen by sensors that say only
//! whether it is within their radius.
//!
//! Each particle is a target that moves at constant velocity and turns at random times. A particle is as likely as the
//! number of sensors says that it agrees with: those that detect the target have it within their radius, those that do
//! not have it outside. Particles are drawn again by systematic resampling (Kitagawa 1996) where few of them carry most
//! of the weight, and about the sensors that detect the target where none agrees with them.

use std::f64::consts::TAU;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{Seed, SettingError};

use super::target_state::{AxisCovariance, TargetState};
use crate::purpose;

/// Largest number of turns of a particle in one step.
const MOST_TURNS: u64 = 255;

/// Settings of a [`ParticleFilter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParticleFilterSettings {
    /// Number of particles.
    pub particles: u32,
    /// Radius within which a node detects the target (m), on the map.
    pub sensing_radius_m: f64,
    /// Likelihood of a sensor that says the opposite, 0 to 1, not included: for the errors of the map.
    pub contradiction: f64,
    /// Largest speed of the target (m/s). Velocities after a turn are uniform up to it.
    pub max_speed_m_per_s: f64,
    /// Mean number of turns per second.
    pub turns_per_s: f64,
    /// Standard deviation of the acceleration along an axis (m/s²), constant during a step.
    pub acceleration_sigma_m_per_s2: f64,
}

impl Default for ParticleFilterSettings {
    fn default() -> Self {
        Self {
            particles: 1000,
            sensing_radius_m: 1.5,
            contradiction: 0.05,
            max_speed_m_per_s: 1.5,
            turns_per_s: 0.1,
            acceleration_sigma_m_per_s2: 0.2,
        }
    }
}

impl ParticleFilterSettings {
    /// These settings, if they are valid.
    ///
    /// # Errors
    /// If a value is invalid. The keys are those of the fields.
    pub(crate) fn validated(self) -> Result<Self, SettingError> {
        if !(1..=1_000_000).contains(&self.particles) {
            return Err(SettingError::new("particles", self.particles, "1 to 1000000"));
        }
        SettingError::positive("sensing_radius_m", self.sensing_radius_m)?;
        if !(self.contradiction > 0.0 && self.contradiction < 1.0) {
            return Err(SettingError::new("contradiction", self.contradiction, "above 0 and below 1"));
        }
        SettingError::positive("max_speed_m_per_s", self.max_speed_m_per_s)?;
        SettingError::not_negative("turns_per_s", self.turns_per_s)?;
        SettingError::not_negative("acceleration_sigma_m_per_s2", self.acceleration_sigma_m_per_s2)?;
        Ok(self)
    }
}

/// The sensors that are known to see the target at one instant, and those that are known not to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenBy<'a> {
    /// Places of the nodes that detect it (m).
    pub detecting: &'a [Position],
    /// Places of the nodes that do not (m).
    pub silent: &'a [Position],
}

#[derive(Clone, Copy, Debug)]
struct Particle {
    place: Position,
    velocity: Position,
    weight: f64,
}

/// What a random number decides.
#[derive(Clone, Copy)]
enum Draw {
    TurnTime,
    Velocity,
    Place,
    Acceleration,
    Resampling,
}

/// The filter, after a step.
#[derive(Clone, Debug)]
pub(crate) struct ParticleFilter {
    settings: ParticleFilterSettings,
    seed: Seed,
    stream: u64,
    step: u64,
    particles: Vec<Particle>,
    resets: u32,
}

impl ParticleFilter {
    /// The filter after the first place of the target, which is within the radius of detection of it; its velocity is
    /// unknown. `stream` selects the random draws of this filter.
    #[must_use]
    pub(crate) fn new(settings: ParticleFilterSettings, seed: Seed, stream: u64, first: Position) -> Self {
        let mut filter = Self { settings, seed, stream, step: 0, particles: Vec::new(), resets: 0 };
        let weight = 1.0 / f64::from(settings.particles);
        filter.particles =
            (0..settings.particles).map(|index| Particle { weight, ..filter.drawn_about(index, first) }).collect();
        filter
    }

    /// Goes on by `step`, and uses what sensors say at its end, if anything is known of it.
    pub(crate) fn advance(&mut self, step: Duration, seen_by: Option<&SeenBy<'_>>) {
        self.step += 1;
        self.propagate(step);
        if let Some(seen_by) = seen_by {
            self.find_again(seen_by.detecting);
            self.weigh(seen_by);
            self.resample();
        }
    }

    /// Mean of the particles, and their covariance, averaged over the axes.
    #[must_use]
    pub(crate) fn state(&self) -> TargetState {
        let mean = |value: &dyn Fn(&Particle) -> Position| {
            self.particles.iter().fold(Position::ORIGIN, |sum, particle| sum + value(particle) * particle.weight)
        };
        let (place, velocity_m_per_s) = (mean(&|particle| particle.place), mean(&|particle| particle.velocity));
        let mut covariance = AxisCovariance { place_m2: 0.0, cross_m2_per_s: 0.0, velocity_m2_per_s2: 0.0 };
        for particle in &self.particles {
            let (p, v) = (particle.place - place, particle.velocity - velocity_m_per_s);
            let share = particle.weight / 2.0;
            covariance.place_m2 += share * p.dot(p);
            covariance.cross_m2_per_s += share * p.dot(v);
            covariance.velocity_m2_per_s2 += share * v.dot(v);
        }
        TargetState { place, velocity_m_per_s, covariance }
    }

    /// The state after another `span`, with the turns that the particles make until then.
    #[cfg(test)]
    fn predict(&self, span: Duration) -> TargetState {
        let mut ahead = self.clone();
        ahead.step += 1;
        ahead.propagate(span);
        ahead.state()
    }

    /// How often no particle agreed with the sensors that detected the target, so that all were drawn again.
    #[must_use]
    pub(crate) fn resets(&self) -> u32 {
        self.resets
    }

    /// Moves each particle by `span`.
    fn propagate(&mut self, span: Duration) {
        let (span_s, rate) = (span.as_secs_f64(), self.settings.turns_per_s);
        for index in 0..self.particles.len() {
            let Particle { mut place, mut velocity, weight } = self.particles[index];
            let mut left_s = span_s;
            for turn in 0..MOST_TURNS {
                let until_turn_s = -libm::log(self.uniform(index, turn, Draw::TurnTime, 0)) / rate;
                // With no turns the time until the first one is infinite.
                if until_turn_s >= left_s {
                    break;
                }
                place = place + velocity * until_turn_s;
                velocity = self.in_disc(index, turn, Draw::Velocity) * self.settings.max_speed_m_per_s;
                left_s -= until_turn_s;
            }
            let acceleration = self.acceleration(index);
            place = place + velocity * left_s + acceleration * (0.5 * span_s * span_s);
            velocity = velocity + acceleration * span_s;
            let speed = velocity.length_m();
            if speed > self.settings.max_speed_m_per_s {
                velocity = velocity * (self.settings.max_speed_m_per_s / speed);
            }
            self.particles[index] = Particle { place, velocity, weight };
        }
    }

    /// Draws all particles again about the nodes that detect the target, if no particle is within the radius of each
    /// of them (sensor resetting, Lenser and Veloso 2000).
    fn find_again(&mut self, detecting: &[Position]) {
        let radius_m = self.settings.sensing_radius_m;
        let agrees = |particle: &Particle| detecting.iter().all(|node| node.distance_m(particle.place) <= radius_m);
        if detecting.is_empty() || self.particles.iter().any(agrees) {
            return;
        }
        let sum = detecting.iter().fold(Position::ORIGIN, |sum, &node| sum + node);
        let mut middle = sum * (1.0 / detecting.len() as f64);
        middle.z_m = self.particles[0].place.z_m;
        self.resets += 1;
        let weight = 1.0 / self.particles.len() as f64;
        self.particles =
            (0..self.settings.particles).map(|i| Particle { weight, ..self.drawn_about(i, middle) }).collect();
    }

    /// Multiplies the weights by the likelihoods of what the sensors say.
    fn weigh(&mut self, seen_by: &SeenBy<'_>) {
        let ParticleFilterSettings { sensing_radius_m, contradiction, .. } = self.settings;
        let log_contradiction = libm::log(contradiction);
        let against = |place: Position| {
            let is_far = |node: &&Position| node.distance_m(place) > sensing_radius_m;
            let missed = seen_by.detecting.iter().filter(is_far).count();
            missed + seen_by.silent.iter().filter(|node| !is_far(node)).count()
        };
        let counts: Vec<usize> = self.particles.iter().map(|particle| against(particle.place)).collect();
        let fewest = counts.iter().copied().min().unwrap_or(0);
        let mut sum = 0.0;
        for (particle, count) in self.particles.iter_mut().zip(counts) {
            particle.weight *= libm::exp(log_contradiction * (count - fewest) as f64);
            sum += particle.weight;
        }
        for particle in &mut self.particles {
            particle.weight /= sum;
        }
    }

    /// Draws the particles again in proportion to their weights, if their effective number is below half.
    fn resample(&mut self) {
        let count = self.particles.len() as f64;
        let effective = 1.0 / self.particles.iter().map(|particle| particle.weight.powi(2)).sum::<f64>();
        if effective >= 0.5 * count {
            return;
        }
        let mut pointer = self.uniform(0, 0, Draw::Resampling, 0) / count;
        let mut drawn = Vec::with_capacity(self.particles.len());
        let mut sum = 0.0;
        for particle in &self.particles {
            sum += particle.weight;
            while pointer < sum && drawn.len() < self.particles.len() {
                drawn.push(Particle { weight: 1.0 / count, ..*particle });
                pointer += 1.0 / count;
            }
        }
        // The sum of the weights may be a little less than 1.
        let last = Particle { weight: 1.0 / count, ..self.particles[self.particles.len() - 1] };
        drawn.resize(self.particles.len(), last);
        self.particles = drawn;
    }

    /// A particle within the radius of detection of `middle`, with any velocity. Its weight is still open.
    fn drawn_about(&self, index: u32, middle: Position) -> Particle {
        let index = index as usize;
        Particle {
            place: middle + self.in_disc(index, 0, Draw::Place) * self.settings.sensing_radius_m,
            velocity: self.in_disc(index, MOST_TURNS, Draw::Velocity) * self.settings.max_speed_m_per_s,
            weight: 0.0,
        }
    }

    /// A point uniform in the unit disc.
    fn in_disc(&self, index: usize, turn: u64, draw: Draw) -> Position {
        let [share, azimuth] = [0, 1].map(|part| self.uniform(index, turn, draw, part));
        let azimuth_rad = TAU * azimuth;
        Position::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0) * share.sqrt()
    }

    fn acceleration(&self, index: usize) -> Position {
        let normal = |axis| self.seed.normal(purpose::SEARCH, self.address(index, 0, Draw::Acceleration, axis));
        Position::new(normal(0), normal(1), 0.0) * self.settings.acceleration_sigma_m_per_s2
    }

    fn uniform(&self, index: usize, turn: u64, draw: Draw, part: u64) -> f64 {
        self.seed.uniform(purpose::SEARCH, self.address(index, turn, draw, part))
    }

    /// The address of a random number: who draws, in which step, which particle, turn and what for.
    fn address(&self, index: usize, turn: u64, draw: Draw, part: u64) -> [u64; 3] {
        [self.stream, self.step, (index as u64) << 16 | turn << 8 | (draw as u64) << 2 | part]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, y_m: f64) -> Position {
        Position::new(x_m, y_m, 0.0)
    }

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn the_mean_is_that_of_the_region_that_the_sensors_allow() {
        // In the discs of two nodes, outside that of a third: a lens with a bite, integrated on a fine grid.
        let settings = ParticleFilterSettings {
            particles: 40_000,
            sensing_radius_m: 2.0,
            contradiction: 1e-12,
            ..ParticleFilterSettings::default()
        };
        let (detecting, silent) = ([at(0.0, 0.0), at(1.5, 0.0)], [at(0.5, 2.0)]);
        let is_allowed = |place: Position| {
            detecting.iter().all(|node| node.distance_m(place) <= 2.0)
                && silent.iter().all(|node| node.distance_m(place) > 2.0)
        };
        let grid = (-300..300).flat_map(|i| (-300..300).map(move |j| (0.01 * f64::from(i), 0.01 * f64::from(j))));
        let allowed: Vec<_> =
            grid.map(|(x, y)| at(x + 0.005, y + 0.005)).filter(|&place| is_allowed(place)).collect();
        let count = allowed.len() as f64;
        let mean = allowed.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / count);
        let variance = allowed.iter().map(|&place| (place - mean).dot(place - mean)).sum::<f64>() / (2.0 * count);
        let mut filter = ParticleFilter::new(settings, Seed(5), 0, at(0.0, 0.0));
        filter.advance(Duration::ZERO, Some(&SeenBy { detecting: &detecting, silent: &silent }));
        let state = filter.state();
        // About 10 000 particles are in the region: five standard errors.
        let tolerance_m = 5.0 * (2.0 * variance / 1e4).sqrt();
        assert!(state.place.distance_m(mean) < tolerance_m, "{} for {mean}", state.place);
        assert!((state.covariance.place_m2 / variance - 1.0).abs() < 0.06, "{:?} for {variance}", state.covariance);
        assert_eq!(filter.resets(), 0);
    }

    #[test]
    fn first_places_and_velocities_fill_their_discs() {
        let settings = ParticleFilterSettings { particles: 20_000, ..ParticleFilterSettings::default() };
        let state = ParticleFilter::new(settings, Seed(1), 3, Position::new(4.0, 2.0, 1.0)).state();
        assert!(state.place.distance_m(Position::new(4.0, 2.0, 1.0)) < 0.03, "{}", state.place);
        // Variance along an axis of a disc of radius r: r²/4.
        assert!((state.covariance.place_m2 * 4.0 / 2.25 - 1.0).abs() < 0.03, "{:?}", state.covariance);
        assert!((state.covariance.velocity_m2_per_s2 * 4.0 / 2.25 - 1.0).abs() < 0.03);
        assert!(state.velocity_m_per_s.z_m.abs() <= 0.0);
    }

    /// The distance between a target that walks through a lattice of nodes at 1.2 m/s and the state after `steps`.
    fn followed(seed: Seed, steps: u32) -> (f64, ParticleFilter) {
        let settings = ParticleFilterSettings { sensing_radius_m: 2.0, ..ParticleFilterSettings::default() };
        let target = |step: u32| at(1.0 + 1.2 * f64::from(step), 10.0 + 2.0 * (0.3 * f64::from(step)).sin());
        let nodes: Vec<_> = (0..40).flat_map(|x| (0..20).map(move |y| at(f64::from(x), f64::from(y)))).collect();
        let mut filter = ParticleFilter::new(settings, seed, 0, target(0));
        let mut worst_m: f64 = 0.0;
        for step in 1..=steps {
            let (detecting, silent): (Vec<_>, Vec<_>) =
                nodes.iter().partition(|node| node.distance_m(target(step)) <= 2.0);
            filter.advance(SECOND, Some(&SeenBy { detecting: &detecting, silent: &silent }));
            worst_m = worst_m.max(filter.state().place.distance_m(target(step)));
        }
        (worst_m, filter)
    }

    #[test]
    fn a_target_that_walks_through_the_nodes_is_followed() {
        let (worst_m, filter) = followed(Seed(2), 28);
        assert!(worst_m < 0.8, "{worst_m}");
        let velocity = filter.state().velocity_m_per_s;
        assert!((velocity.x_m - 1.2).abs() < 0.4, "{velocity}");
    }

    #[test]
    fn the_same_seed_gives_the_same_particles() {
        let state = |seed| followed(Seed(seed), 10).1.state();
        assert_eq!(state(2), state(2));
        assert_ne!(state(2), state(3));
    }

    #[test]
    fn a_target_that_was_lost_is_found_again() {
        let mut filter = ParticleFilter::new(ParticleFilterSettings::default(), Seed(8), 0, at(0.0, 0.0));
        filter.advance(SECOND, Some(&SeenBy { detecting: &[at(30.0, 5.0)], silent: &[] }));
        assert_eq!(filter.resets(), 1);
        assert!(filter.state().place.distance_m(at(30.0, 5.0)) < 0.3);
    }

    #[test]
    fn resampling_keeps_each_particle_in_proportion_to_its_weight() {
        let settings = ParticleFilterSettings { particles: 1000, ..ParticleFilterSettings::default() };
        let mut filter = ParticleFilter::new(settings, Seed(3), 0, at(0.0, 0.0));
        // One particle in ten has a weight of 80 in 10 000.
        for (index, particle) in filter.particles.iter_mut().enumerate() {
            particle.place = at(index as f64, 0.0);
            particle.weight = if index % 10 == 0 { 0.8 / 100.0 } else { 0.2 / 900.0 };
        }
        filter.resample();
        for index in 0..1000 {
            let copies = filter.particles.iter().filter(|particle| (particle.place.x_m - index as f64).abs() < 0.5);
            let (copies, expected) = (copies.count() as f64, if index % 10 == 0 { 8.0 } else { 2.0 / 9.0 });
            assert!((copies - expected).abs() < 1.0, "{copies} of {index} for {expected}");
        }
    }

    #[test]
    fn the_mean_velocity_fades_at_the_rate_of_the_turns() {
        let settings = ParticleFilterSettings {
            particles: 20_000,
            turns_per_s: 0.2,
            acceleration_sigma_m_per_s2: 0.0,
            ..ParticleFilterSettings::default()
        };
        let mut filter = ParticleFilter::new(settings, Seed(6), 0, at(0.0, 0.0));
        for particle in &mut filter.particles {
            (particle.place, particle.velocity) = (at(0.0, 0.0), at(1.0, 0.0));
        }
        let state = filter.predict(Duration::from_secs(6));
        // The place is the integral of exp(-λt).
        let fading = (-1.2_f64).exp();
        assert!((state.velocity_m_per_s.x_m - fading).abs() < 0.03, "{}", state.velocity_m_per_s);
        assert!((state.place.x_m - (1.0 - fading) / 0.2).abs() < 0.12, "{}", state.place);
        let straight = ParticleFilterSettings { turns_per_s: 0.0, ..settings };
        let filter = ParticleFilter { settings: straight, ..filter };
        assert!(filter.predict(Duration::from_secs(6)).place.distance_m(at(6.0, 0.0)) < 1e-9);
    }

    #[test]
    fn invalid_settings_are_rejected() {
        let settings = ParticleFilterSettings::default();
        assert!(settings.validated().is_ok());
        for invalid in [
            ParticleFilterSettings { particles: 0, ..settings },
            ParticleFilterSettings { contradiction: 0.0, ..settings },
            ParticleFilterSettings { sensing_radius_m: f64::NAN, ..settings },
        ] {
            assert!(invalid.validated().is_err(), "{invalid:?}");
        }
    }
}
