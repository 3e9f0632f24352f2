//! What each sector of a sender reaches from its place: worked out once, and used for every frame of its sweeps.

use sextant_channel::{Dbm, Milliwatts, Position};
use sextant_kernel::StationId;

use super::budget::Budget;
use super::cells::Cells;
use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::{Aim, Signal};

/// Links and powers that are remembered at most (about 100 MB). When there are more, all are forgotten: they are worked
/// out again, with the same result.
const MOST: usize = 1 << 21;

/// What the sectors of all senders reach among the receivers that stand. Only for powers that are the same for all
/// packets of a link.
#[derive(Debug)]
pub(super) struct Footprints {
    /// The receivers whose stations stand, whether they listen or not.
    standing: Cells<Listener<Position>>,
    /// By sender.
    known: Vec<Footprint>,
    /// Links and powers that are remembered.
    held: usize,
    most: usize,
}

/// What the sectors of one sender reach from its place.
#[derive(Debug, Default)]
struct Footprint {
    /// From where, and with which power; `None` if nothing is known.
    of: Option<(Position, Dbm)>,
    /// The links to the receivers within the radius of communication, by receiver.
    links: Vec<Link>,
    /// By aim: all directions alike, then the sectors.
    beams: Vec<Beam>,
}

/// A link from the sender to a receiver that stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) listener: Listener<Position>,
    /// Power at the receiver without the gains of antennas.
    level: Dbm,
}

/// What one sector reaches.
#[derive(Debug, Default)]
struct Beam {
    is_known: bool,
    audible: Vec<Audible>,
}

/// A receiver at which a signal is not negligible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Audible {
    pub(super) receiver: ReceiverId,
    pub(super) station: StationId,
    pub(super) power: Milliwatts,
}

impl Footprints {
    /// Nothing is known yet. `standing` are all receivers whose stations stand.
    pub(super) fn new(standing: Cells<Listener<Position>>) -> Self {
        Self { standing, known: Vec::new(), held: 0, most: MOST }
    }

    /// The links from the sender of a signal to all standing receivers within the radius of communication, and those
    /// of them at which the signal is not negligible with its power. Both by receiver.
    pub(super) fn of(&mut self, signal: &Signal, reach_m: f64, budget: &mut Budget) -> (&[Link], &[Audible]) {
        let (sender, aim) = (signal.sender.index(), index(signal.emission.aim));
        if self.known.len() <= sender {
            self.known.resize_with(sender + 1, Footprint::default);
        }
        let of = Some((signal.position, signal.emission.power));
        let is_known = |footprint: &Footprint| footprint.of == of && footprint.knows(aim);
        if !is_known(&self.known[sender]) {
            if self.held > self.most {
                self.known.iter_mut().for_each(|footprint| *footprint = Footprint::default());
                self.held = 0;
            }
            let footprint = &mut self.known[sender];
            let before = footprint.size();
            if footprint.of != of {
                footprint.forget();
                footprint.of = of;
                find_links(&mut self.standing, signal, reach_m, budget, &mut footprint.links);
            }
            footprint.work_out(aim, signal, budget);
            self.held = (self.held + footprint.size()).saturating_sub(before);
        }
        let Footprint { links, beams, .. } = &self.known[sender];
        (links, &beams[aim].audible)
    }
}

/// The place of an aim among the beams of a sender.
fn index(aim: Aim) -> usize {
    match aim {
        Aim::Omnidirectional => 0,
        Aim::Sector(sector) => 1 + usize::from(sector),
    }
}

/// Replaces `links` with those to all standing receivers within the radius of communication, by receiver.
fn find_links(
    standing: &mut Cells<Listener<Position>>,
    signal: &Signal,
    reach_m: f64,
    budget: &mut Budget,
    links: &mut Vec<Link>,
) {
    links.clear();
    standing.near(signal.position, |cell| {
        let others = cell.iter().filter(|listener| listener.receiver != signal.sender);
        let near = others.filter(|listener| listener.place.distance_m(signal.position) <= reach_m);
        links.extend(near.filter_map(|&listener| {
            let level = budget.level(signal, &listener)?;
            Some(Link { listener, level })
        }));
    });
    links.sort_unstable_by_key(|link| link.listener.receiver);
}

impl Footprint {
    /// Links and powers that it holds.
    fn size(&self) -> usize {
        self.links.len() + self.beams.iter().map(|beam| beam.audible.len()).sum::<usize>()
    }

    fn knows(&self, aim: usize) -> bool {
        self.beams.get(aim).is_some_and(|beam| beam.is_known)
    }

    fn forget(&mut self) {
        for beam in &mut self.beams {
            beam.is_known = false;
            beam.audible.clear();
        }
        self.links.clear();
    }

    /// Works out one beam: that of `signal`.
    fn work_out(&mut self, aim: usize, signal: &Signal, budget: &mut Budget) {
        if self.beams.len() <= aim {
            self.beams.resize_with(aim + 1, Beam::default);
        }
        let Beam { is_known, audible } = &mut self.beams[aim];
        audible.extend(self.links.iter().filter_map(|&Link { listener, level }| {
            let Listener { receiver, station, .. } = listener;
            let power = budget.milliwatts(level, signal, &listener);
            (power.0 > 0.0).then_some(Audible { receiver, station, power })
        }));
        *is_known = true;
    }
}
