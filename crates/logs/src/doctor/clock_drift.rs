//! Whether the clock of the packets runs at another rate than that of the path, or was set in between: its delay in the two
//! halves of the log, each estimated alone.
//!
//! One delay for all would be wrong in both halves, and taking it off would leave the rest.

use sextant_kernel::SimTime;

use super::clock::{ClockOffset, NOTABLE_M, Sense, estimate};
use super::finding::Finding;
use super::samples::Samples;
use crate::path::robot_path::Path;

/// The delays of the halves differ clearly if they do by so many times the uncertainty of their difference.
const CLEAR: f64 = 4.0;
/// Every second node, and the others, tell the same if their delays differ by so many times their uncertainty.
const AGREES: f64 = 2.0;
/// So few nodes tell no drift by themselves.
const LEAST_NODES: usize = 3;

/// How late the clock of the packets is in the first and in the second half of the time of the paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClockDrift {
    halves: [ClockOffset; 2],
}

impl ClockDrift {
    /// The halves of a log whose delays clearly differ. `None` too if they cannot be told: without strengths, from few packets,
    /// if another delay explains as much, or if the nodes do not agree: a clock is one of all of them, and what stands around a few
    /// is not.
    pub(crate) fn of(samples: &Samples, paths: &[&Path]) -> Option<Self> {
        // Only strengths tell it, and an estimate takes its time.
        if !samples.have_strengths() {
            return None;
        }
        let drift = Self::halves(samples, paths)?;
        if !(drift.change_s().abs() > CLEAR * drift.error_s() && drift.change_m() > 2.0 * NOTABLE_M) {
            return None;
        }
        let agrees = |first: usize| {
            let of_some = Self::halves(&samples.of_every_second(first), paths)?;
            let towards_s = of_some.change_s() * drift.change_s().signum();
            (towards_s > AGREES * of_some.error_s() && towards_s > 0.5 * drift.change_s().abs()).then_some(())
        };
        agrees(0).and_then(|()| agrees(1)).map(|()| drift)
    }

    /// The delays of the halves, if strengths tell both.
    fn halves(samples: &Samples, paths: &[&Path]) -> Option<Self> {
        let with_strengths = samples.nodes().filter(|packets| packets.iter().any(|packet| packet.rssi_dbm.is_some()));
        if with_strengths.count() < LEAST_NODES {
            return None;
        }
        let start = paths.iter().map(|path| path.span().0).min()?;
        let end = paths.iter().map(|path| path.span().1).max()?;
        let middle = start + end.saturating_since(start) / 2;
        let half = |is_of_half: fn(SimTime, SimTime) -> bool| {
            let (offset, sense) = estimate(&samples.filtered(|time| is_of_half(time, middle)), paths)?;
            (sense == Sense::Strengths && offset.rival_s.is_none()).then_some(offset)
        };
        Some(Self { halves: [half(|time, middle| time < middle)?, half(|time, middle| time >= middle)?] })
    }

    /// By how much the packets are later in the second half (s).
    fn change_s(&self) -> f64 {
        self.halves[1].delay_s - self.halves[0].delay_s
    }

    /// The uncertainty of that (s).
    fn error_s(&self) -> f64 {
        libm::hypot(self.halves[0].error_s, self.halves[1].error_s)
    }

    /// How far the robot drives meanwhile (m).
    fn change_m(&self) -> f64 {
        self.change_s().abs() * self.halves[0].speed_m_per_s
    }

    /// What the user should know of it.
    pub(crate) fn finding(&self) -> Finding {
        let [first, second] = self.halves.map(|half| format!("{:.2} ± {:.2} s", half.delay_s, 2.0 * half.error_s));
        let [first_s, second_s] = self.halves.map(|half| half.delay_s);
        let speed_m_per_s = self.halves[0].speed_m_per_s;
        let most_s = first_s.abs().max(second_s.abs());
        Finding {
            check: "clock-drift",
            odd: format!(
                "the times of the packets seem to be {first} late by the clock of the path in the first half of the log, and \
                 {second} in the second: one of the clocks drifts or was set, or the path drifts"
            ),
            cost: format!(
                "at {speed_m_per_s:.2} m/s the robot is taken to be {:.1} m and more from where it heard them, and no single \
                 delay corrects it",
                most_s * speed_m_per_s
            ),
            remedy: "give packets and poses the times of one clock, or map the parts of the log alone, each with \
                     `packet_delay=auto`; odometry may look so if it drifts (`estimate_path`)"
                .to_owned(),
        }
    }
}
