//! The one timer of a machine.

use sextant_kernel::SimTime;

use super::port::{Event, Radio};

/// When the timer is due. What is due later than the pending timer waits for it: the machine then finds that it is too
/// early and sets it anew. So a backoff that is frozen and resumed many times does not cancel its timer each time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Alarm {
    due: Option<SimTime>,
}

impl Alarm {
    /// The timer is due at `due` or before.
    pub(super) fn set(&mut self, now: SimTime, due: SimTime, event: Event, radio: &mut impl Radio) {
        if self.due.is_some_and(|pending| pending <= due) {
            return;
        }
        self.clear(radio);
        radio.after(due - now, event);
        self.due = Some(due);
    }

    pub(super) const fn is_set(self) -> bool {
        self.due.is_some()
    }

    /// The timer is no longer needed.
    pub(super) fn clear(&mut self, radio: &mut impl Radio) {
        if self.due.take().is_some() {
            radio.cancel_timer();
        }
    }

    /// An event came; if it is that of the timer, the timer is no longer pending.
    pub(super) fn note(&mut self, event: Event) {
        if matches!(event, Event::TransmitReady | Event::WaitExpired) {
            assert!(self.due.take().is_some(), "{event:?} comes from a timer that is not set");
        }
    }
}
