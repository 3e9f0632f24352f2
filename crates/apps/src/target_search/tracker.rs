//! What a robot knows of one target: detections, the filtered way, and where the target will be.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::{NodeId, Seed, SimTime};
use sextant_sim::TargetId;

use super::config::PredictionConfig;
use super::doubt::{CONFIRMING, Doubt, Group, best_track};
use super::particle_filter::{ParticleFilter, ParticleFilterSettings, SeenBy};
use super::robust_kalman::{RobustKalman, RobustKalmanSettings};
use super::settings::{Detarsk, Filter};
use super::sightings::{NodeSightings, Sighting, Sightings, SightingsSettings};
use super::target_state::{Fix, TargetState};
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
    /// What sinks told, where detections are doubted: when and where how many nodes detected the target.
    told: Vec<(SimTime, Position, u8)>,
    bounds: Bounds,
    /// When the track begins that is believed, where detections are doubted.
    since: Option<SimTime>,
    /// The newest detection that was known before the latest update, and whether that brought a newer one.
    known: Option<SimTime>,
    has_news: bool,
    forecast: Option<Outlook>,
    fallbacks: u32,
}

/// The detections that are believed.
struct Believed<'a> {
    sightings: Cow<'a, Sightings>,
    /// When they begin.
    since: Option<SimTime>,
    /// What sinks told, at sample times.
    told: Vec<(SimTime, Fix)>,
}

/// The states of a target at sample times, and how often the filter drew all its particles again.
type FilteredWay = (Vec<(SimTime, TargetState)>, u32);

/// Where a target will be.
#[derive(Clone, Debug)]
enum Outlook {
    Straight { last: SimTime, state: TargetState, max_speed_m_per_s: f64 },
    Curves(Box<Trajectory>),
}

impl Believed<'_> {
    /// All measured places, in order of time.
    fn fixes(&self) -> Vec<(SimTime, Fix)> {
        let mut fixes = self.sightings.fixes();
        fixes.extend(&self.told);
        fixes.sort_by_key(|&(time, _)| time);
        fixes
    }
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
            told: Vec::new(),
            since: None,
            known: None,
            has_news: false,
            bounds,
            forecast: None,
            fallbacks: 0,
        }
    }

    /// A node reported when it detected the target.
    pub(super) fn learn(&mut self, node: NodeId, place: Position, sightings: &[Sighting], until: SimTime) {
        self.sightings.add(&NodeSightings { node, place, since: SimTime::ZERO, until, sightings });
    }

    /// A sink told when and where a target was detected by this number of nodes.
    pub(super) fn learn_told(&mut self, time: SimTime, place: Position, nodes: u8) {
        if !self.told.contains(&(time, place, nodes)) {
            self.told.push((time, place, nodes));
        }
    }

    /// When the track begins that is believed, where detections are doubted.
    pub(super) fn since(&self) -> Option<SimTime> {
        self.since
    }

    /// The last sample time at which a node is known to have detected the target.
    pub(super) fn latest(&self) -> SimTime {
        self.sightings.latest().map_or(self.first.0, |latest| latest.max(self.first.0))
    }

    /// Whether the latest update brought a newer detection than was known before.
    pub(super) fn has_news(&self) -> bool {
        self.has_news
    }

    /// The place of the newest detection (m).
    pub(super) fn newest_place(&self) -> Position {
        self.sightings.fixes().last().map_or(self.first.1, |(_, fix)| fix.place)
    }

    /// How often the particle filter drew all its particles again, in the last update.
    pub(super) fn fallbacks(&self) -> u32 {
        self.fallbacks
    }

    /// Works out the way of the target from all that is known. One metre is `scale` long on the map.
    pub(super) fn update(&mut self, scale: f64) {
        let latest = self.latest();
        self.has_news = self.known.replace(latest).is_none_or(|known| latest > known);
        let believed = match self.method.doubt {
            Some(doubt) => self.believe(&doubt, scale),
            None => Believed { sightings: Cow::Borrowed(&self.sightings), since: None, told: Vec::new() },
        };
        let since = believed.since;
        let (way, fallbacks) = match self.method.filter {
            Filter::RobustKalman(settings) => (self.robust_way(&believed, settings, scale), 0),
            Filter::Particles(settings) => self.particle_way(&believed, settings, scale),
        };
        (self.since, self.fallbacks) = (since, fallbacks);
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

    /// The detections along the track that the target is most likely to have gone.
    fn believe(&self, doubt: &Doubt, scale: f64) -> Believed<'_> {
        let reach_m = doubt.reach_m(scale);
        let sighted = self.sightings.groups(0.5 * reach_m);
        let mut groups: Vec<(Group, Option<BTreeSet<NodeId>>)> = Vec::new();
        for (time, place, nodes) in sighted {
            groups.push((Group { time, place, score: doubt.score(nodes.len()) }, Some(nodes)));
        }
        // What a sink tells is of a second, and not of a sample time.
        let samples = (CONFIRMING.as_secs_f64() / self.sample.as_secs_f64()).max(1.0);
        for &(time, place, nodes) in &self.told {
            let score = samples * doubt.told_score(nodes);
            groups.push((Group { time: self.sightings.sample_time(time), place, score }, None));
        }
        groups.sort_by_key(|(group, _)| group.time);
        let heads: Vec<Group> = groups.iter().map(|&(group, _)| group).collect();
        let track = best_track(&heads, scale * self.method.max_speed_m_per_s, reach_m);
        let since = track.first().map(|&first| heads[first].time);
        let (mut kept, mut told) = (Vec::new(), Vec::new());
        for i in track {
            let Group { time, place, .. } = heads[i];
            match groups[i].1.take() {
                Some(nodes) => kept.push((time, nodes)),
                None => told.push((time, Fix { place, variance_m2: 0.25 * reach_m * reach_m })),
            }
        }
        Believed { sightings: Cow::Owned(self.sightings.only(&kept)), since, told }
    }

    /// The states at the sample times from the first to the last detection, by the robust Kalman filter.
    fn robust_way(
        &self,
        believed: &Believed<'_>,
        settings: RobustKalmanSettings,
        scale: f64,
    ) -> Vec<(SimTime, TargetState)> {
        let mut fixes = believed.fixes().into_iter().peekable();
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
        way
    }

    /// The same by the particle filter, and how often it drew all particles again.
    fn particle_way(&self, believed: &Believed<'_>, settings: ParticleFilterSettings, scale: f64) -> FilteredWay {
        let fixes = believed.fixes();
        let (Some(&(mut time, first)), Some(&(end, _))) = (fixes.first(), fixes.last()) else {
            return (Vec::new(), self.fallbacks);
        };
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
            let detecting: Vec<_> = believed.sightings.detecting_at(time).collect();
            let silent: Vec<_> = believed.sightings.silent_at(time).collect();
            let seen_by = SeenBy { detecting: &detecting, silent: &silent };
            filter.advance(self.sample, Some(&seen_by).filter(|_| !detecting.is_empty()));
            way.push((time, filter.state()));
        }
        (way, filter.resets())
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
