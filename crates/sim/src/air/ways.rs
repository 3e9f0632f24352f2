//! The ways of signals between stations, with their reflections.

use std::collections::BTreeMap;

use sextant_channel::{Channel, Position, Ray};
use sextant_kernel::StationId;

/// The ways between pairs of stations, remembered while both are in their places.
#[derive(Debug, Default)]
pub(super) struct Ways(BTreeMap<(StationId, StationId), Known>);

#[derive(Debug)]
struct Known {
    places: [Position; 2],
    rays: Vec<Ray>,
}

impl Ways {
    /// The ways from `a` at `pa` to `b` at `pb`; none beyond the hard radius.
    pub(super) fn between(
        &mut self,
        channel: &Channel,
        (a, pa): (StationId, Position),
        (b, pb): (StationId, Position),
    ) -> &[Ray] {
        let known = self.0.entry((a, b)).or_insert_with(|| Known { places: [pa, pa], rays: Vec::new() });
        if known.places != [pa, pb] || known.rays.is_empty() {
            channel.rays(pa, pb, &mut known.rays);
            known.places = [pa, pb];
        }
        &known.rays
    }
}
