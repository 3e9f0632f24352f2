//! The ways of signals between stations, with their reflections.

use std::collections::BTreeMap;

use sextant_channel::{Channel, Position, Ray};
use sextant_kernel::StationId;

/// The ways between pairs of stations, remembered while both are in their places.
#[derive(Debug, Default)]
pub(super) struct Ways(BTreeMap<(StationId, StationId), KnownWay>);

/// An end of a link: a station at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) station: StationId,
    pub(super) place: Position,
}

#[derive(Debug)]
struct KnownWay {
    places: [Position; 2],
    rays: Vec<Ray>,
}

impl Ways {
    /// The ways from one end to another; none beyond the hard radius.
    pub(super) fn between(&mut self, channel: &Channel, from: End, to: End) -> &[Ray] {
        let places = [from.place, to.place];
        let unknown = || KnownWay { places: [from.place, from.place], rays: Vec::new() };
        let known = self.0.entry((from.station, to.station)).or_insert_with(unknown);
        if known.places != places || known.rays.is_empty() {
            channel.rays(from.place, to.place, &mut known.rays);
            known.places = places;
        }
        &known.rays
    }
}
