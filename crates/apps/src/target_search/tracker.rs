//! What a robot knows of one target: detections, the filtered way, and where the target will be.

use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::{NodeId, Seed, SimTime};
use sextant_sim::TargetId;

use super::config::PredictionConfig;
use super::particle_filter::{ParticleFilter, ParticleFilterSettings, SeenBy};
use super::robust_kalman::{RobustKalman, RobustKalmanSettings};
use super::settings::{Detarsk, Filter};
use super::sightings::{NodeSightings, Sighting, Sightings, SightingsSettings};
use super::target_state::TargetState;
use super::trajectory::{CurveForm, Trajectory, TrajectorySettings, TurnTimes};

/// What a robot knows of one target.
#[derive(Clone, Debug)]
pub(super) struct Tracker {
    method: Detarsk,
    seed: Seed,
    target: TargetId,
    /// Time between two sample times.
    sample: Duration,
    /// When and where it was detected first.
    first: (SimTime, Position),
    sightings: Sightings,
    bounds: Bounds,
    forecast: Option<Outlook>,
    fallbacks: u32,
}

/// Where a target will be.
#[derive(Clone, Debug)]
enum Outlook {
    Straight { last: SimTime, state: TargetState, max_speed_m_per_s: f64 },
    Curves(Box<Trajectory>),
}

impl Tracker {
    /// A target that was detected first at this time and place. `bounds` are those of the map.
    pub(super) fn new(
        method: &Detarsk,
        target: TargetId,
        seed: Seed,
        sample: Duration,
        first: (SimTime, Position),
        bounds: Bounds,
    ) -> Self {
        let settings = SightingsSettings { period: sample, ..SightingsSettings::default() };
        Self {
            method: method.clone(),
            seed,
            target,
            sample,
            first,
            sightings: Sightings::new(settings),
            bounds,
            forecast: None,
            fallbacks: 0,
        }
    }

    /// A node reported when it detected the target.
    pub(super) fn learn(&mut self, node: NodeId, place: Position, sightings: &[Sighting], until: SimTime) {
        self.sightings.add(&NodeSightings { node, place, since: SimTime::ZERO, until, sightings });
    }

    /// The last sample time at which a node is known to have detected the target.
    pub(super) fn latest(&self) -> SimTime {
        self.sightings.latest().map_or(self.first.0, |latest| latest.max(self.first.0))
    }

    /// Times that the robust filter had to fall back, in the last update.
    pub(super) fn fallbacks(&self) -> u32 {
        self.fallbacks
    }

    /// Works out the way of the target from all that is known. One metre is `scale` long on the map.
    pub(super) fn update(&mut self, scale: f64) {
        let way = match self.method.filter {
            Filter::RobustKalman(settings) => self.robust_way(settings, scale),
            Filter::Particles(settings) => self.particle_way(settings, scale),
        };
        let Some(&(last, state)) = way.last() else { return };
        let max_speed_m_per_s = scale * self.method.max_speed_m_per_s;
        let curves = |settings: TrajectorySettings| {
            let places: Vec<_> = way.iter().map(|&(time, state)| (time, state.place)).collect();
            Outlook::Curves(Box::new(Trajectory::new(settings, &places, state)))
        };
        let thesis = TrajectorySettings::as_in_thesis(max_speed_m_per_s, self.bounds);
        self.forecast = Some(match self.method.prediction {
            PredictionConfig::Straight => Outlook::Straight { last, state, max_speed_m_per_s },
            PredictionConfig::Waves => curves(TrajectorySettings {
                turn_times: TurnTimes::Extremes(scale),
                ..TrajectorySettings::new(max_speed_m_per_s, self.bounds)
            }),
            PredictionConfig::Integral => curves(thesis),
            PredictionConfig::Product => curves(TrajectorySettings { form: CurveForm::Product, ..thesis }),
        });
    }

    /// The states at the sample times from the first to the last detection, by the robust Kalman filter.
    fn robust_way(&mut self, settings: RobustKalmanSettings, scale: f64) -> Vec<(SimTime, TargetState)> {
        let mut fixes = self.sightings.fixes().into_iter().peekable();
        let Some((mut time, first)) = fixes.next() else { return Vec::new() };
        let settings = RobustKalmanSettings {
            acceleration_sigma_m_per_s2: scale * settings.acceleration_sigma_m_per_s2,
            position_sigma_m: first.variance_m2.sqrt(),
            max_speed_m_per_s: scale * settings.max_speed_m_per_s,
            ..settings
        };
        let mut filter = RobustKalman::new(settings, first.place);
        let mut way = vec![(time, filter.state())];
        while let Some(&(next, _)) = fixes.peek() {
            time += self.sample;
            let fix = if next <= time { fixes.next().map(|(_, fix)| fix) } else { None };
            filter.advance(self.sample, fix);
            way.push((time, filter.state()));
        }
        self.fallbacks = filter.fallbacks();
        way
    }

    /// The same by the particle filter.
    fn particle_way(&mut self, settings: ParticleFilterSettings, scale: f64) -> Vec<(SimTime, TargetState)> {
        let fixes = self.sightings.fixes();
        let (Some(&(mut time, first)), Some(&(end, _))) = (fixes.first(), fixes.last()) else { return Vec::new() };
        let settings = ParticleFilterSettings {
            sensing_radius_m: scale * settings.sensing_radius_m,
            max_speed_m_per_s: scale * settings.max_speed_m_per_s,
            acceleration_sigma_m_per_s2: scale * settings.acceleration_sigma_m_per_s2,
            ..settings
        };
        let mut filter = ParticleFilter::new(settings, self.seed, self.target.0.into(), first.place);
        let mut way = vec![(time, filter.state())];
        while time < end {
            time += self.sample;
            let detecting: Vec<_> = self.sightings.detecting_at(time).collect();
            let silent: Vec<_> = self.sightings.silent_at(time).collect();
            let seen_by = SeenBy { detecting: &detecting, silent: &silent };
            filter.advance(self.sample, Some(&seen_by).filter(|_| !detecting.is_empty()));
            way.push((time, filter.state()));
        }
        self.fallbacks = filter.resets();
        way
    }

    /// Where the target is predicted to be at `time` (m).
    pub(super) fn predict(&self, time: SimTime) -> Position {
        match &self.forecast {
            None => self.first.1,
            Some(Outlook::Curves(trajectory)) => trajectory.at(time).place,
            Some(Outlook::Straight { last, state, max_speed_m_per_s }) => {
                let span_s = time.saturating_since(*last).as_secs_f64();
                let speed = state.velocity_m_per_s.length_m();
                let slow = if speed > *max_speed_m_per_s { max_speed_m_per_s / speed } else { 1.0 };
                let place = state.place + state.velocity_m_per_s * (slow * span_s);
                let Bounds { min, max } = self.bounds;
                Position::new(place.x_m.clamp(min.x_m, max.x_m), place.y_m.clamp(min.y_m, max.y_m), place.z_m)
            }
        }
    }
}
