//! Packets that come in fragments.

use sextant_kernel::StationId;
use sextant_mac::routing::fragment::{Fragment, Taken};
use sextant_sim::Port;

use super::router::{REASSEMBLY, Router};

impl Router {
    /// A fragment was received: its packet, if it is complete.
    pub(super) fn take_fragment(
        &mut self,
        from: StationId,
        fragment: &Fragment<'_>,
        port: &mut Port<'_>,
    ) -> Option<Vec<u8>> {
        let now = port.now();
        // A packet may be over at this very instant, before its timer is handled.
        self.expire_partial_packets(port);
        let taken = self.reassembly.as_mut()?.take(from, fragment, now);
        match taken {
            Taken::Complete(packet) => return Some(packet),
            Taken::Incomplete => self.schedule_expiry(port),
            Taken::Copy => {}
            // A packet without room counts once, by its first fragment.
            Taken::NoRoom if fragment.offset == 0 => self.count(port, |counts| counts.reassembly_failures += 1),
            Taken::NoRoom => {}
        }
        None
    }

    /// Gives up packets that are not complete in time.
    pub(super) fn expire_partial_packets(&mut self, port: &mut Port<'_>) {
        let given_up = self.reassembly.as_mut().map_or(0, |reassembly| reassembly.expire(port.now()));
        self.count(port, |counts| counts.reassembly_failures += given_up);
    }

    /// The timer of packets that are not complete is due.
    pub(super) fn reassembly_is_over(&mut self, port: &mut Port<'_>) {
        self.expiry_due = None;
        self.expire_partial_packets(port);
        self.schedule_expiry(port);
    }

    fn schedule_expiry(&mut self, port: &mut Port<'_>) {
        let due = self.reassembly.as_ref().and_then(|reassembly| reassembly.due());
        if let Some(due) = due.filter(|_| self.expiry_due.is_none()) {
            self.expiry_due = Some(port.after(due.saturating_since(port.now()), REASSEMBLY));
        }
    }
}
