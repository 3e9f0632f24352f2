//! Answers of a node that wait for their instants.

use std::collections::BTreeMap;

use sextant_sim::{Port, Timer};

use super::poll::Request;

/// Most answers that wait.
const MOST: u16 = 32;

/// The answers of a node to polls, each of which waits for a random instant in the window of its poll. They use 32 timers.
#[derive(Clone, Debug)]
pub(crate) struct WaitingAnswers<T> {
    first_timer: u16,
    sending_share: f64,
    next: u16,
    waiting: BTreeMap<u16, T>,
}

impl<T> WaitingAnswers<T> {
    /// Uses the timers from `first_timer` on. Nodes begin to send in the first `sending_share` of a window: what waits for
    /// the channel then still comes in it.
    #[must_use]
    pub(crate) fn new(first_timer: u16, sending_share: f64) -> Self {
        Self { first_timer, sending_share, next: 0, waiting: BTreeMap::new() }
    }

    /// An answer waits for its instant in the window of `request`. `draw` is a random number in (0, 1). If more than 32
    /// wait, the oldest is dropped.
    pub(crate) fn wait(&mut self, request: &Request, answer: T, draw: f64, port: &mut Port<'_>) {
        let timer = self.first_timer + self.next;
        self.next = (self.next + 1) % MOST;
        self.waiting.insert(timer, answer);
        port.after(request.window.mul_f64(self.sending_share * draw), Timer(timer));
    }

    /// A timer is due. Returns the answer that waited for it, if one did.
    pub(crate) fn due(&mut self, timer: Timer) -> Option<T> {
        self.waiting.remove(&timer.0)
    }
}
