//! Layers of lanes one above the other (thesis, section 3.6: the S path in space).

use sextant_channel::Position;
use sextant_sim::{Ending, RobotCommand, Situation};

use super::lane::Lane;
use super::settings::{AfterLanes, Layers};
use super::survey::{AutomatedS, EMPTY_LANES, Move, Task};
use super::trip::Goal;

/// The layer that is being swept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    /// Its height [m].
    z_m: f64,
    /// The height of the first one [m].
    first_z_m: f64,
    /// Where the next one lies: 1 above, -1 below.
    up: f64,
    /// Whether there is none left.
    pub(super) is_last: bool,
}

impl Layer {
    /// The first layer, at the height where somebody was heard.
    pub(super) fn first(z_m: f64) -> Self {
        Self { z_m, first_z_m: z_m, up: 1.0, is_last: false }
    }
}

impl AutomatedS {
    /// A sweep of a layer is over: its other side, or the next layer. The first sweep leads to the nearer border, because
    /// the robot enters a layer near to where it left the one before.
    pub(super) fn end_sweep_of_layer(&mut self, situation: &Situation<'_>, layers: &Layers) {
        let is_half_done = self.sweeps == 1;
        if !(is_half_done && self.set_out(situation, self.start, Goal::OtherSide)) {
            self.leave_layer(situation, layers);
        }
    }

    /// Sweeps the other side of a layer from where its first lane began: first the part of that lane behind the start.
    pub(super) fn begin_other_side_of_layer(&mut self, here: Position) {
        self.sweep = -self.sweep;
        self.sweep_began = self.knowledge.stops();
        self.empty_lanes_to_end = EMPTY_LANES;
        self.lane = Lane::SOUTHWARD;
        self.begin_lane(here);
    }

    /// Sets out for the next layer: upwards, then, from the first one, downwards.
    fn leave_layer(&mut self, situation: &Situation<'_>, layers: &Layers) {
        let here = situation.position;
        loop {
            let Layer { z_m, up, .. } = self.layer;
            if let Some(next_m) = layers.next_m(z_m, up) {
                let shaft = self.knowledge.shaft(here, z_m, (next_m - z_m).abs(), up, |place| self.allows(place));
                if let Some((place, climb_m)) = shaft
                    && self.set_out(situation, place, Goal::Climb { to_z_m: z_m + up * climb_m })
                {
                    return;
                }
            }
            if !self.turn_down() {
                self.end_layers(situation);
                return;
            }
        }
    }

    /// All layers are swept: what is left to do.
    fn end_layers(&mut self, situation: &Situation<'_>) {
        if self.is_complete() {
            self.task = Task::Finish(Ending::Complete);
        } else if self.settings.after_lanes == AfterLanes::Check {
            self.check(situation);
        } else {
            self.task = Task::Finish(self.ending_with_misses());
        }
    }

    /// Up or down to the layer at `to_z_m`, with stops on the way.
    pub(super) fn climb(&mut self, situation: &Situation<'_>, to_z_m: f64, last_move: Move) -> Option<RobotCommand> {
        let here = situation.position;
        let left_m = to_z_m - here.z_m;
        if last_move == Move::Blocked || left_m.abs() <= 0.01 * self.settings.step_m {
            self.enter_layer(situation);
            return None;
        }
        Some(RobotCommand::Drive(Position { z_m: here.z_m + self.stride(left_m.abs()).copysign(left_m), ..here }))
    }

    /// Begins the layer here, unless nobody is heard, or there was no way: then there is none.
    fn enter_layer(&mut self, situation: &Situation<'_>) {
        let here = situation.position;
        let Some(layers) = self.settings.layers else { return };
        let has_climbed = (here.z_m - self.layer.z_m).abs() >= 0.25 * layers.spacing_m;
        if has_climbed && self.knowledge.hears_somebody() {
            self.layer.z_m = here.z_m;
            self.start = here;
            self.sweeps = 0;
            self.sweep_began = self.knowledge.stops();
            self.empty_lanes_to_end = EMPTY_LANES;
            self.lane = Lane::FIRST;
            self.begin_lane(here);
        } else if self.turn_down() {
            self.leave_layer(situation, &layers);
        } else {
            self.end_layers(situation);
        }
    }

    /// Goes on below the first layer; `false` if that was done, and there is no layer left.
    fn turn_down(&mut self) -> bool {
        let Layer { first_z_m, up, .. } = self.layer;
        if up < 0.0 {
            self.layer.is_last = true;
            return false;
        }
        self.layer = Layer { up: -1.0, z_m: first_z_m, ..self.layer };
        true
    }
}
