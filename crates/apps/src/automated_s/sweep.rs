//! Sweeps: lane after lane one way, then what is left to do.

use sextant_channel::Position;
use sextant_sim::{Ending, Situation};

use super::settings::{AfterLanes, Until};
use super::survey::{AutomatedS, EMPTY_LANES, Task};
use super::trip::Goal;

/// Lanes in a row that hear nobody, and end a sweep that begins out of reach of the network.
const EMPTY_LANES_OUTSIDE: u32 = 8;
/// Share of the lane spacing by which a further sweep runs beside the one before: the golden section, so that all
/// lanes of many sweeps lie apart.
const AGAIN: f64 = 0.381_966;

impl AutomatedS {
    /// Whether all is done: packets, and the sweep if it is wanted to its end.
    pub(super) fn is_complete(&self) -> bool {
        let is_swept = if self.settings.layers.is_some() { self.layer.is_last } else { self.sweeps > 0 };
        (is_swept || self.settings.until == Until::Heard) && self.knowledge.heard_all(self.settings.packets_per_node)
    }

    /// A sweep is over: what is left to do.
    pub(super) fn end_sweep(&mut self, situation: &Situation<'_>) {
        self.sweeps += 1;
        self.empty_lanes = 0;
        self.cuts.clear();
        let is_first = self.sweeps == 1;
        if self.is_complete() {
            self.task = Task::Finish(Ending::Complete);
        } else if let Some(layers) = self.settings.layers {
            self.end_sweep_of_layer(situation, &layers);
        } else if self.area.is_some() {
            if !(is_first && self.set_out(situation, self.start, Goal::OtherSide)) {
                self.end_area(situation);
            }
        } else if self.settings.after_lanes == AfterLanes::Check && !(is_first && self.misses_nodes()) {
            self.check(situation);
        } else if !(is_first && self.set_out(situation, self.start, Goal::OtherSide)) {
            self.begin_sweep(situation.position);
        }
    }

    /// Sweeps the other way from here. A sweep over lanes that were driven before runs between them.
    pub(super) fn begin_sweep(&mut self, here: Position) {
        self.sweep = -self.sweep;
        self.sweep_began = self.knowledge.stops();
        let is_outside = self.sweeps > 1;
        self.empty_lanes_to_end = if is_outside { EMPTY_LANES_OUTSIDE } else { EMPTY_LANES };
        let aside = if self.sweep < 0.0 { AGAIN } else { 1.0 - AGAIN };
        let ahead_m = if is_outside { aside * self.settings.lane_spacing_m } else { 0.0 };
        self.task = Task::Shift { from: here - Position::new(self.sweep * ahead_m, 0.0, 0.0) };
    }

    /// The area is swept: its gaps are left.
    fn end_area(&mut self, situation: &Situation<'_>) {
        if self.settings.after_lanes == AfterLanes::Check {
            self.check(situation);
        } else {
            self.task = Task::Finish(Ending::Complete);
        }
    }

    /// How a survey ends that has no place left to go to but did not hear all packets: whoever has an area is done
    /// with it.
    pub(super) fn ending_with_misses(&self) -> Ending {
        if self.area.is_some() { Ending::Complete } else { Ending::Stuck }
    }
}
