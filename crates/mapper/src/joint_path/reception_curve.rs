//! The share of packets that arrive over a distance, estimated with a path.

use crate::numerics::{never_rising, whole};

/// Knots of the curve over the reach of the log, and over its whole length.
const PER_REACH: f64 = 10.0;
const KNOTS: usize = 20;
/// Finer steps of the table of logarithms.
const FINER: usize = 8;
/// Shares are at least and at most that: a packet may get through from far away, or be lost close by.
const LIMITS: [f64; 2] = [2e-3, 0.99];
/// Packets that each knot counts as having seen, at the share of the curve before.
const PRIOR_PACKETS: f64 = 2.0;

/// The share of packets that arrive, by distance: values at knots, straight lines of their logarithms between.
#[derive(Clone, Debug)]
pub(super) struct ReceptionCurve {
    step_m: f64,
    shares: Vec<f64>,
    /// Finer steps a metre.
    per_m: f64,
    /// Finer steps of the curve, and what holds beyond its end.
    table: Vec<CurveStep>,
    beyond: CurveStep,
}

/// A step of the table: values at its beginning and their slopes.
#[derive(Clone, Copy, Debug)]
struct CurveStep {
    /// Logarithms of the share that arrives, and of the share that does not.
    logs: [f64; 2],
    /// Their slopes (per m).
    slopes: [f64; 2],
    /// The share that arrives, and what a packet tells of the distance (per m²).
    share: f64,
    information: f64,
}

/// The curve at a distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveValue {
    /// Slopes of the logarithms of the share that arrives and of the share that does not (per m).
    pub(super) slopes: [f64; 2],
    /// What a packet tells of the distance: Fisher's information (per m²).
    pub(super) information: f64,
}

/// Packets received and sent over distances.
#[derive(Clone, Debug)]
pub(super) struct CurveCounts {
    received: Vec<f64>,
    sent: Vec<f64>,
}

impl ReceptionCurve {
    /// A curve that falls slowly over the distance `reach_m` over which nodes are heard.
    pub(super) fn wide(reach_m: f64) -> Self {
        let step_m = reach_m / PER_REACH;
        let share = |knot: usize| {
            let along = knot as f64 / PER_REACH;
            0.9 / (1.0 + libm::exp((along - 0.65) / 0.12))
        };
        Self::of(step_m, (0..KNOTS).map(share).collect())
    }

    fn of(step_m: f64, shares: Vec<f64>) -> Self {
        let shares: Vec<f64> = shares.into_iter().map(|share| share.clamp(LIMITS[0], LIMITS[1])).collect();
        let per_m = FINER as f64 / step_m;
        let last = (shares.len() - 1) * FINER;
        let share = |at: usize| {
            let (knot, rest) = (at / FINER, (at % FINER) as f64 / FINER as f64);
            let next = shares[(knot + 1).min(shares.len() - 1)];
            shares[knot] + rest * (next - shares[knot])
        };
        let logs = |share: f64| [libm::log(share), libm::log1p(-share)];
        let step = |at: usize| {
            let (near, far) = (share(at), share(at + 1));
            let slopes = [0, 1].map(|of| (logs(far)[of] - logs(near)[of]) * per_m);
            let information = near * slopes[0] * slopes[0] + (1.0 - near) * slopes[1] * slopes[1];
            CurveStep { logs: logs(near), slopes, share: near, information }
        };
        let end = share(last);
        let beyond = CurveStep { logs: logs(end), slopes: [0.0; 2], share: end, information: 0.0 };
        Self { step_m, per_m, table: (0..last).map(step).collect(), beyond, shares }
    }

    /// The same curve over distances that are shorter by this factor.
    pub(super) fn shrunk(&self, factor: f64) -> Self {
        Self::of(self.step_m / factor, self.shares.clone())
    }

    /// A distance beyond which the curve tells nothing: it is at its least (m).
    pub(super) fn end_m(&self) -> f64 {
        let last = self.shares.iter().rposition(|&share| share > 1.5 * LIMITS[0]).unwrap_or(0);
        self.step_m * (last + 1).min(self.shares.len() - 1) as f64
    }

    /// The step at a distance, and how far from its beginning the distance is (m).
    #[inline]
    fn step(&self, distance_m: f64) -> (&CurveStep, f64) {
        let along = distance_m * self.per_m;
        let below = whole(along);
        match self.table.get(below) {
            Some(step) => (step, distance_m - below as f64 / self.per_m),
            None => (&self.beyond, 0.0),
        }
    }

    /// The logarithm of the probability that so many packets of a link arrive, and so many do not.
    #[inline]
    pub(super) fn log_probability(&self, distance_m: f64, received: f64, missed: f64) -> f64 {
        let (step, after_m) = self.step(distance_m);
        let silent = step.logs[1] + after_m * step.slopes[1];
        // Most stops heard nothing of a node.
        if received > 0.0 {
            received * (step.logs[0] + after_m * step.slopes[0]) + missed * silent
        } else {
            missed * silent
        }
    }

    /// The share that arrives, at the beginning of the step of a distance.
    pub(super) fn share(&self, distance_m: f64) -> f64 {
        self.step(distance_m).0.share
    }

    /// How the curve changes at a distance.
    #[inline]
    pub(super) fn at(&self, distance_m: f64) -> CurveValue {
        let step = self.step(distance_m).0;
        CurveValue { slopes: step.slopes, information: step.information }
    }

    /// No counts yet.
    pub(super) fn counts(&self) -> CurveCounts {
        CurveCounts { received: vec![0.0; self.shares.len()], sent: vec![0.0; self.shares.len()] }
    }

    /// Counts packets over a distance.
    pub(super) fn count(&self, counts: &mut CurveCounts, distance_m: f64, received: f64, sent: f64) {
        let along = distance_m / self.step_m;
        let below = whole(along);
        let last = self.shares.len() - 1;
        if below >= last {
            return;
        }
        let rest = along - below as f64;
        for (knot, share) in [(below, 1.0 - rest), (below + 1, rest)] {
            counts.received[knot] += share * received;
            counts.sent[knot] += share * sent;
        }
    }

    /// The curve of these counts: it never rises, and is smoothed over neighbouring knots.
    pub(super) fn refitted(&self, counts: &CurveCounts) -> Self {
        let sent: Vec<f64> = counts.sent.iter().map(|sent| sent + PRIOR_PACKETS).collect();
        let means: Vec<f64> = (counts.received.iter().zip(&self.shares).zip(&sent))
            .map(|((received, share), sent)| (received + PRIOR_PACKETS * share) / sent)
            .collect();
        let falling = never_rising(&means, &sent);
        let smooth = |knot: usize| {
            let before = falling[knot.saturating_sub(1)];
            let after = falling[(knot + 1).min(falling.len() - 1)];
            0.25 * before + 0.5 * falling[knot] + 0.25 * after
        };
        Self::of(self.step_m, (0..falling.len()).map(smooth).collect())
    }
}

impl CurveCounts {
    /// The sum of both.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        for (own, other) in [(&mut self.received, &other.received), (&mut self.sent, &other.sent)] {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
        self
    }
}
