//! Layers of lanes, one above the other (thesis, section 3.6: the S path in space).

use sextant_channel::Position;

use super::settings::Layers;
use super::shaft::shaft;
use super::trip::{Goal, Trip};
use super::view::View;

/// The layer that is being swept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    /// Its height (m).
    z_m: f64,
    /// The height of the first layer (m).
    first_z_m: f64,
    /// Direction to the next layer: 1 for up, -1 for down.
    up: f64,
    /// Whether no layer is left.
    is_last: bool,
}

impl Layer {
    /// The first layer, at the height where the first node was heard.
    pub(super) fn first(z_m: f64) -> Self {
        Self { z_m, first_z_m: z_m, up: 1.0, is_last: false }
    }

    /// Whether there is no layer left.
    pub(super) fn is_last(&self) -> bool {
        self.is_last
    }

    /// Whether a robot at `here` is in another layer.
    pub(super) fn is_left(&self, here: Position, layers: &Layers) -> bool {
        (here.z_m - self.z_m).abs() >= 0.25 * layers.spacing_m
    }

    /// Makes the layer at the height of `here` the current one.
    pub(super) fn enter(&mut self, here: Position) {
        self.z_m = here.z_m;
    }

    /// A trip to the place where the climb to the next layer begins. Layers above the first one come first, then
    /// those below it. `None` if no layer is left.
    pub(super) fn leave(&mut self, view: &View<'_>, layers: &Layers) -> Option<Trip> {
        loop {
            let trip = self.next_layer(view, layers);
            if trip.is_some() || !self.turn_down() {
                return trip;
            }
        }
    }

    fn next_layer(&self, view: &View<'_>, layers: &Layers) -> Option<Trip> {
        let Self { z_m, up, .. } = *self;
        let next_m = layers.next_m(z_m, up)?;
        let visits = &view.knowledge.visits;
        let allowed = |place| view.rules.allow(place);
        let (place, climb_m) = shaft(visits, view.here(), z_m, (next_m - z_m).abs(), up, allowed)?;
        Trip::plan(view, place, Goal::Climb { to_z_m: z_m + up * climb_m })
    }

    /// Continues below the first layer. Returns `false` if this was done before, so that no layer is left.
    pub(super) fn turn_down(&mut self) -> bool {
        if self.up < 0.0 {
            self.is_last = true;
            return false;
        }
        *self = Self { up: -1.0, z_m: self.first_z_m, ..*self };
        true
    }
}
