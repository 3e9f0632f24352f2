//! Which receivers a sender that stands is near: worked out once, and used for all of its frames.

use sextant_channel::{Milliwatts, Position};

use super::ReceptionRules;
use super::budget::Budget;
use super::cells::Cells;
use super::footprint::Audible;
use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::Signal;

/// Powers that are remembered at most (about 50 MB). When there are more, all are forgotten: they are worked out again, with
/// the same result.
const MOST: usize = 1 << 21;

/// The receivers within reach of one sender, and the power of its signals there.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    is_known: bool,
    /// All within the radius of communication, by receiver.
    pub(super) all: Vec<Audible>,
    /// Those of them at which its signals are above the sensitivity.
    pub(super) near: Vec<Audible>,
}

/// The surroundings of all senders. Only where all stations stand, and powers are the same for all packets of a link.
#[derive(Debug)]
pub(super) struct AllSurroundings {
    standing: Cells<Listener<Position>>,
    /// By sender.
    known: Vec<Surroundings>,
    /// Powers that are remembered.
    held: usize,
    most: usize,
}

impl Surroundings {
    /// Power of the sender's signals at a receiver; `None` beyond the radius of communication.
    #[inline]
    pub(super) fn power_at(&self, receiver: ReceiverId) -> Option<Milliwatts> {
        // Where all receivers are within reach, one has the place of its number, or, after the sender, the one before.
        let is_it = |place: usize| self.all.get(place).filter(|audible| audible.receiver == receiver);
        let expected = receiver.index();
        if let Some(audible) = is_it(expected).or_else(|| is_it(expected.wrapping_sub(1))) {
            return Some(audible.power);
        }
        let place = self.all.binary_search_by_key(&receiver, |audible| audible.receiver).ok()?;
        Some(self.all[place].power)
    }
}

impl AllSurroundings {
    /// Nothing is known yet. `standing` are all receivers.
    pub(super) fn new(standing: Cells<Listener<Position>>) -> Self {
        Self { standing, known: Vec::new(), held: 0, most: MOST }
    }

    /// Limits the number of powers that are remembered.
    #[cfg(test)]
    pub(super) fn remember_at_most(&mut self, most: usize) {
        self.most = most;
    }

    /// The surroundings of the sender of a signal; `rules` are those of a receiver.
    pub(super) fn of<'a>(
        &mut self,
        signal: &Signal,
        rules: impl Fn(ReceiverId) -> &'a ReceptionRules,
        budget: &mut Budget,
    ) -> &Surroundings {
        let sender = signal.sender.index();
        if self.known.len() <= sender {
            self.known.resize_with(sender + 1, Surroundings::default);
        }
        if !self.known[sender].is_known {
            if self.held > self.most {
                self.known.iter_mut().for_each(|surroundings| *surroundings = Surroundings::default());
                self.held = 0;
            }
            let found = work_out(&mut self.standing, signal, rules, budget);
            self.held += found.all.len() + found.near.len();
            self.known[sender] = found;
        }
        &self.known[sender]
    }
}

fn work_out<'a>(
    standing: &mut Cells<Listener<Position>>,
    signal: &Signal,
    rules: impl Fn(ReceiverId) -> &'a ReceptionRules,
    budget: &mut Budget,
) -> Surroundings {
    let mut all: Vec<Audible> = Vec::new();
    standing.near(signal.position, |cell| {
        let others = cell.iter().filter(|listener| listener.receiver != signal.sender);
        all.extend(others.filter_map(|listener| {
            let &Listener { receiver, station, .. } = listener;
            budget.power_at(signal, listener).map(|power| Audible { receiver, station, power })
        }));
    });
    all.sort_unstable_by_key(|audible| audible.receiver);
    let is_near = |audible: &&Audible| audible.power.0 > 0.0 && audible.power >= rules(audible.receiver).sensitivity;
    let near = all.iter().filter(is_near).copied().collect();
    Surroundings { is_known: true, all, near }
}
