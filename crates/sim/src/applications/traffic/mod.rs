//! Traffic: when the nodes have frames to send.

mod config;
mod plan;
mod rest;
mod trace;

use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{Files, NodeId, Seed, SettingError, SimTime};

use crate::purpose;
use trace::Trace;

pub use config::{
    GroupConfig, OnceConfig, PeriodicConfig, PoissonConfig, SaturatedConfig, SilentConfig, TraceConfig, TrafficConfig,
};
pub use plan::TrafficPlan;

/// The traffic of a node: its frames, and when these are due.
#[derive(Clone, Debug, PartialEq)]
pub struct Traffic {
    /// The key of its table in a scenario.
    key: String,
    mpdu_octets: u8,
    acknowledged: bool,
    to: Option<String>,
    schedule: Schedule,
}

#[derive(Clone, Debug, PartialEq)]
enum Schedule {
    Periodic { interval: Duration, jitter: f64 },
    Poisson { mean_interval_s: f64 },
    Saturated { spread_s: f64 },
    Once { at: SimTime },
    Trace(Arc<Trace>),
    Silent,
}

/// When a node has its next frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// A frame of this size (octets) at this time.
    At(SimTime, u8),
    /// A frame of this size (octets) as soon as the last one has ended.
    AfterTheLast(u8),
    /// Never.
    Never,
}

/// The traffic of a kind that names no file.
impl TryFrom<TrafficConfig> for Traffic {
    type Error = SettingError;

    fn try_from(config: TrafficConfig) -> Result<Self, SettingError> {
        config.traffic(&[], &Files::default(), "traffic")
    }
}

impl Traffic {
    /// No frames.
    pub(super) fn silent() -> Self {
        Self {
            key: "traffic.silent".to_owned(),
            mpdu_octets: 0,
            acknowledged: false,
            to: None,
            schedule: Schedule::Silent,
        }
    }

    /// Length of each frame, or of the largest one, header and frame check sequence included (octets).
    #[must_use]
    pub fn mpdu_octets(&self) -> u8 {
        self.mpdu_octets
    }

    /// Whether frames go to one robot or sink and request an acknowledgement.
    #[must_use]
    pub fn is_acknowledged(&self) -> bool {
        self.acknowledged
    }

    /// Name of the robot or sink to which frames go, if it is told.
    #[must_use]
    pub fn to(&self) -> Option<&str> {
        self.to.as_deref()
    }

    /// Mean number of frames per second; `None` if it is not the same all the time, or depends on the channel.
    #[must_use]
    pub fn rate_per_s(&self) -> Option<f64> {
        match &self.schedule {
            Schedule::Periodic { interval, .. } => Some(1.0 / interval.as_secs_f64()),
            Schedule::Poisson { mean_interval_s } => Some(1.0 / mean_interval_s),
            Schedule::Silent => Some(0.0),
            Schedule::Saturated { .. } | Schedule::Once { .. } | Schedule::Trace(_) => None,
        }
    }

    /// Number of frames in the table of the traffic, and of those that are due at `end` or later; `None` without a table.
    #[must_use]
    pub fn listed(&self, end: SimTime) -> Option<[usize; 2]> {
        let Schedule::Trace(trace) = &self.schedule else { return None };
        Some([trace.frames().count(), trace.frames().filter(|due| *due >= end).count()])
    }

    /// Whether nodes send nothing.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        matches!(self.schedule, Schedule::Silent)
    }

    /// Whether each node always has a frame to send.
    #[must_use]
    pub fn is_saturated(&self) -> bool {
        matches!(self.schedule, Schedule::Saturated { .. })
    }

    /// Whether the instants of [`Traffic::next`] are those of the node's own clock: what happens to all nodes at once, or
    /// stands in a table, is in true time, and a Poisson process has the same law on any clock.
    pub(crate) fn follows_clock(&self) -> bool {
        matches!(self.schedule, Schedule::Periodic { .. })
    }

    /// The key of its table in a scenario.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.key
    }

    /// When `node` has its frame number `count` (from zero), of which the last one was offered at `last`.
    ///
    /// Periodic frame k is due at (k + phase + jitter u) intervals. The phase is drawn once per node, u in (-1, 1)
    /// once per frame. Jitter does not accumulate, so each window of (1 + 2 jitter) intervals has at least one frame.
    /// The gaps of Poisson arrivals are exponential, and each has the address of the arrival before it. A gap that passes
    /// the end of a period is drawn again from there, which changes no probability, because the process has no memory. So
    /// the arrivals of each period are known without those before it.
    #[must_use]
    pub fn next(&self, seed: Seed, node: NodeId, count: u64, last: SimTime) -> Next {
        let draw = |what| seed.uniform(purpose::TRAFFIC, [node.0.into(), what, count]);
        match &self.schedule {
            Schedule::Silent => Next::Never,
            Schedule::Saturated { spread_s } if count == 0 => {
                Next::At(SimTime::ZERO + Duration::from_secs_f64(spread_s * draw(3)), self.mpdu_octets)
            }
            Schedule::Saturated { .. } => Next::AfterTheLast(self.mpdu_octets),
            Schedule::Once { at } if count == 0 => Next::At(*at, self.mpdu_octets),
            Schedule::Once { .. } => Next::Never,
            Schedule::Trace(trace) => {
                trace.frame(node, count).map_or(Next::Never, |(at, octets)| Next::At(at, octets))
            }
            &Schedule::Poisson { mean_interval_s } => {
                Next::At(poisson_arrival(seed, node, mean_interval_s, last), self.mpdu_octets)
            }
            Schedule::Periodic { interval, jitter } => {
                let phase = seed.uniform(purpose::TRAFFIC, [node.0.into(), 0, 0]);
                let shift = 2.0 * draw(1) - 1.0;
                let Ok(periods) = u32::try_from(count) else { return Next::Never };
                // The start is later by the jitter, so that the first frame is not before zero.
                let offset = interval.mul_f64(phase + jitter * (1.0 + shift));
                Next::At(SimTime::ZERO + *interval * periods + offset, self.mpdu_octets)
            }
        }
    }
}

/// The periods of Poisson arrivals are so many mean intervals long.
const PERIOD_INTERVALS: f64 = 64.0;

/// Length of the periods of Poisson arrivals.
fn poisson_period(mean_interval_s: f64) -> Duration {
    Duration::from_secs_f64(PERIOD_INTERVALS * mean_interval_s).max(Duration::from_nanos(1))
}

/// When the period that holds `time` begins.
fn period_start(period: Duration, time: SimTime) -> SimTime {
    let since = time.saturating_since(SimTime::ZERO).as_nanos();
    let past = since % period.as_nanos();
    time.saturating_sub(Duration::from_nanos(u64::try_from(past).unwrap_or(u64::MAX)))
}

/// The first Poisson arrival after `last`.
fn poisson_arrival(seed: Seed, node: NodeId, mean_interval_s: f64, last: SimTime) -> SimTime {
    let period = poisson_period(mean_interval_s);
    let mut from = last;
    loop {
        let end = period_start(period, from) + period;
        let luck = seed.uniform(purpose::TRAFFIC, [node.0.into(), 2, from.as_nanos()]);
        let arrival = from + Duration::from_secs_f64(-mean_interval_s * libm::log(luck));
        if arrival < end {
            return arrival;
        }
        from = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIODIC: PeriodicConfig = PeriodicConfig::each(20, 1.0, 0.1);

    fn traffic(config: TrafficConfig) -> Traffic {
        Traffic::try_from(config).expect("good settings")
    }

    /// When the first `frames` frames of a node are due (s).
    fn dues(traffic: &Traffic, seed: u64, node: u32, frames: u64) -> Vec<f64> {
        let mut last = SimTime::ZERO;
        let due = |count| match traffic.next(Seed(seed), NodeId(node), count, last) {
            Next::At(at, _) => {
                last = at;
                at.as_secs_f64()
            }
            other => panic!("{other:?}"),
        };
        (0..frames).map(due).collect()
    }

    #[test]
    fn each_window_of_an_interval_and_twice_the_jitter_has_a_frame() {
        let traffic = traffic(TrafficConfig::Periodic(PERIODIC));
        for node in 0..50 {
            for pair in dues(&traffic, 3, node, 200).windows(2) {
                let gap_s = pair[1] - pair[0];
                assert!((0.8..=1.2).contains(&gap_s), "{gap_s}");
            }
        }
    }

    #[test]
    fn poisson_arrivals_have_the_rate_and_the_spread_of_a_poisson_process() {
        let config = PoissonConfig { mpdu_octets: 20, rate_per_s: 4.0, acknowledged: false, to: None };
        let traffic = traffic(TrafficConfig::Poisson(config));
        const FRAMES: u64 = 20_000;
        let dues = dues(&traffic, 5, 2, FRAMES);
        let gaps: Vec<f64> = dues.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let n = gaps.len() as f64;
        let mean = gaps.iter().sum::<f64>() / n;
        let square = gaps.iter().map(|gap| gap * gap).sum::<f64>() / n;
        // Mean 1/4 s and mean square 2/16 s^2, whose deviations are 1/4 and sqrt(20)/16; five standard errors each.
        assert!((mean - 0.25).abs() < 5.0 * 0.25 / n.sqrt(), "{mean}");
        assert!((square - 0.125).abs() < 5.0 * 20_f64.sqrt() / 16.0 / n.sqrt(), "{square}");
    }

    #[test]
    fn saturated_nodes_have_the_next_frame_after_the_last_one() {
        let next = |start_spread_s, node, count| {
            let config = SaturatedConfig { mpdu_octets: 100, acknowledged: true, to: None, start_spread_s };
            traffic(TrafficConfig::Saturated(config)).next(Seed(1), NodeId(node), count, SimTime::ZERO)
        };
        assert_eq!((next(0.0, 0, 0), next(0.0, 0, 1)), (Next::At(SimTime::ZERO, 100), Next::AfterTheLast(100)));
        // The starts are spread over the interval, off any grid of microseconds.
        let starts: Vec<u64> = (0..100)
            .map(|node| match next(0.01, node, 0) {
                Next::At(start, 100) => start.as_nanos(),
                other => panic!("{other:?}"),
            })
            .collect();
        assert!(starts.iter().all(|&start| start <= 10_000_000), "{starts:?}");
        assert!(starts.iter().any(|&start| start > 9_000_000), "{starts:?}");
        let on_grid = starts.iter().filter(|&&start| start % 16_000 == starts[0] % 16_000).count();
        assert_eq!(on_grid, 1, "{starts:?}");
    }

    #[test]
    fn invalid_traffic_is_rejected() {
        let key = |config: TrafficConfig| Traffic::try_from(config).map_err(|error| error.key).err();
        let periodic = |config: PeriodicConfig| key(TrafficConfig::Periodic(config));
        assert_eq!(periodic(PERIODIC), None);
        assert_eq!(periodic(PeriodicConfig { mpdu_octets: 10, ..PERIODIC }).as_deref(), Some("periodic.mpdu_octets"));
        assert_eq!(
            periodic(PeriodicConfig { interval_s: f64::NAN, ..PERIODIC }).as_deref(),
            Some("periodic.interval_s")
        );
        assert_eq!(periodic(PeriodicConfig { jitter: 0.6, ..PERIODIC }).as_deref(), Some("periodic.jitter"));
        assert_eq!(periodic(PeriodicConfig { to: Some("sink".into()), ..PERIODIC }).as_deref(), Some("periodic.to"));
        for start_spread_s in [-1.0, f64::NAN, f64::INFINITY] {
            let config = SaturatedConfig { mpdu_octets: 20, acknowledged: false, to: None, start_spread_s };
            assert_eq!(key(TrafficConfig::Saturated(config)).as_deref(), Some("saturated.start_spread_s"));
        }
        let poisson = PoissonConfig { mpdu_octets: 20, rate_per_s: 0.0, acknowledged: false, to: None };
        assert_eq!(key(TrafficConfig::Poisson(poisson)).as_deref(), Some("poisson.rate_per_s"));
    }
}
