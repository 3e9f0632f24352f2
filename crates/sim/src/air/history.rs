//! The last signals on air, to know whose signal disturbed whose.

use std::collections::VecDeque;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::StationId;

use super::listener::Listener;
use super::receiver_id::ReceiverId;
use super::signal::{Outline, Signal};
use super::{Air, Transmission};

/// No frame of any technology lasts longer: 133 octets at 20 kbit/s take 53 ms.
const LONGEST_FRAME: Duration = Duration::from_millis(60);

/// The signals that may have overlapped with one that is on air.
#[derive(Debug, Default)]
pub(super) struct History {
    signals: VecDeque<Signal>,
}

impl History {
    /// A signal begins.
    pub(super) fn add(&mut self, signal: Signal) {
        let forgotten = signal.start.saturating_sub(LONGEST_FRAME);
        while self.signals.front().is_some_and(|old| old.end < forgotten) {
            self.signals.pop_front();
        }
        self.signals.push_back(signal);
    }
}

impl Air {
    /// Keeps the last signals from now on: called before the start.
    pub(crate) fn keep_history(&mut self) {
        self.history = Some(History::default());
    }

    /// The station whose signal was the strongest one at a receiver during a transmission that ends now, among those that
    /// overlapped with it. `None` if there was none, or no history is kept.
    pub(crate) fn strongest_interferer(
        &mut self,
        transmission: &Transmission,
        receiver: ReceiverId,
        station: StationId,
        place: Position,
    ) -> Option<StationId> {
        let Outline { packet, start, end, .. } = transmission.signal;
        let others = self.history.as_ref()?.signals.iter();
        let others = others.filter(|other| other.packet != packet && other.sender != receiver);
        let medium = &mut self.medium;
        let heard = others.filter(|other| other.start < end && other.end > start).filter_map(|other| {
            let power = medium.power_at(other, &Listener { receiver, station, place })?;
            (power.0 > 0.0).then_some((power.0, other.source))
        });
        // Of equal powers, the first one.
        heard.reduce(|best, other| if other.0 > best.0 { other } else { best }).map(|(_, source)| source)
    }
}
