//! When which messages are sent: windows of equal length, one after the other, which all stations know in advance.
//!
//! In a network with sectors anchors join in three windows: PLACE, REPORT, BEACON; without sectors in one, BEACON, unless
//! beacons pass on the places of others. The initial anchors join first. Each iteration has a window for COORDINATES, and then those in which new anchors join.

use std::time::Duration;

use sextant_kernel::SimTime;

/// What is sent in a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BeaconWindow {
    Place,
    Report,
    Beacon,
    Coordinates,
    /// Nothing: all is over.
    End,
}

/// The windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Schedule {
    /// Start of the first window.
    pub(super) start: SimTime,
    /// Length of a window.
    pub(super) window: Duration,
    /// Whether anchors tell their place before their beacons: to learn the directions of their sectors, or to pass on the
    /// places of others.
    pub(super) asks: bool,
    /// Most iterations.
    pub(super) iterations: u32,
}

const JOINING: [BeaconWindow; 3] = [BeaconWindow::Place, BeaconWindow::Report, BeaconWindow::Beacon];

impl Schedule {
    fn joining(&self) -> &'static [BeaconWindow] {
        if self.asks { &JOINING } else { &JOINING[2..] }
    }

    /// What is sent in window number `number`, and in which iteration; 0 is the joining of the initial anchors.
    pub(super) fn at(&self, number: u32) -> (u32, BeaconWindow) {
        let joining = self.joining();
        let first = u32::try_from(joining.len()).expect("at most 3 windows");
        let of = |index: u32| joining[usize::try_from(index).expect("at most 3 windows")];
        if number < first {
            return (0, of(number));
        }
        let (iteration, window) = ((number - first) / (first + 1) + 1, (number - first) % (first + 1));
        if iteration > self.iterations {
            return (self.iterations, BeaconWindow::End);
        }
        (iteration, if window == 0 { BeaconWindow::Coordinates } else { of(window - 1) })
    }

    /// Start of window number `number`.
    pub(super) fn start_of(&self, number: u32) -> SimTime {
        self.start + self.window * number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schedule(asks: bool) -> Schedule {
        Schedule { start: SimTime::ZERO, window: Duration::from_secs(2), asks, iterations: 2 }
    }

    #[test]
    fn anchors_join_before_the_first_iteration_and_in_each() {
        use BeaconWindow::{Beacon, Coordinates, End, Place, Report};
        let windows = |schedule: Schedule, count: u32| (0..count).map(move |number| schedule.at(number));
        let with_sectors: Vec<_> = windows(schedule(true), 12).collect();
        let joining = |iteration| [(iteration, Place), (iteration, Report), (iteration, Beacon)];
        let mut expected = joining(0).to_vec();
        for iteration in 1..=2 {
            expected.push((iteration, Coordinates));
            expected.extend(joining(iteration));
        }
        expected.push((2, End));
        assert_eq!(with_sectors, expected);
        let without: Vec<_> = windows(schedule(false), 6).collect();
        assert_eq!(without, [(0, Beacon), (1, Coordinates), (1, Beacon), (2, Coordinates), (2, Beacon), (2, End)]);
        assert_eq!(schedule(true).start_of(3), SimTime::ZERO + Duration::from_secs(6));
    }
}
