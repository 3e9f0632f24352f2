//! The radio and the timer of a station, as its protocol machine sees them.

use std::time::Duration;

use sextant_kernel::StationId;
use sextant_mac::RadioState;
use sextant_mac::sleep::{Event as Step, Radio, Sent, Sleeper};

use super::Links;
use crate::air::Sense;
use crate::event::sleeping::Event;
use crate::scene::Scene;
use crate::service::outcome::Deafness;

/// The radio and the timer of a station.
pub(super) struct Port<'a> {
    links: &'a mut Links,
    scene: &'a mut Scene,
    station: StationId,
}

impl Links {
    /// Asks the protocol machine of a station for something. If it is called away from its sleep, the checks so far are counted.
    pub(super) fn command<T>(
        &mut self,
        station: StationId,
        scene: &mut Scene,
        command: impl FnOnce(&mut Sleeper, &mut Port<'_>) -> T,
    ) -> T {
        // While it works, nobody looks at it: a station does not wake itself.
        let mut sleeper = self.stacks[station.index()].sleeper;
        if sleeper.is_asleep() {
            self.count_idle(station, scene.now);
        }
        let answer = command(&mut sleeper, &mut Port { links: self, scene, station });
        let stack = &mut self.stacks[station.index()];
        stack.sleeper = sleeper;
        if sleeper.is_asleep() {
            // Checks that came while it did something else are left out.
            stack.handled = stack.handled.max(stack.checks.next_from(scene.now));
        }
        answer
    }
}

impl Radio for Port<'_> {
    fn after(&mut self, span: Duration, event: Step) {
        self.stop();
        let key = self.links.schedule(self.station, span, Event::Station(event), self.scene);
        self.links.stacks[self.station.index()].timer = Some(key);
    }

    fn stop(&mut self) {
        if let Some(timer) = self.links.stacks[self.station.index()].timer.take() {
            self.scene.queue.cancel(timer);
        }
    }

    fn enter(&mut self, state: RadioState) {
        let stack = &mut self.links.stacks[self.station.index()];
        stack.usage.enter(state, self.scene.now);
        let deafness = match state {
            RadioState::Receive => None,
            RadioState::Sleep | RadioState::Idle => Some(Deafness::Asleep),
            // It wakes up.
            RadioState::Turnaround if stack.deafness == Some(Deafness::Asleep) => Some(Deafness::Asleep),
            RadioState::Turnaround | RadioState::Transmit => Some(Deafness::Transmitting),
        };
        self.links.radios.tune(self.station, deafness, &mut stack.deafness, self.scene);
    }

    fn is_busy(&mut self) -> bool {
        let radios = &self.links.radios;
        let sense = Sense {
            radio: radios.interface(self.station),
            place: self.scene.place(self.station),
            from: self.scene.now.saturating_sub(radios.phy().cca()),
            to: self.scene.now,
            threshold: self.links.stacks[self.station.index()].cca_threshold,
        };
        self.scene.airs[radios.air].is_busy(&sense)
    }

    fn followed_for(&mut self) -> Option<Duration> {
        let (now, receiver) = (self.scene.now, self.links.radios.receiver(self.station));
        // A signal that begins now is followed, too.
        let end = now + Duration::from_nanos(1);
        let until = self.scene.airs[self.links.radios.air].followed_until(now, receiver, end)?;
        Some(until.saturating_since(now)).filter(|span| !span.is_zero())
    }

    fn begin(&mut self, sent: Sent) -> Duration {
        self.links.begin_frame(self.station, sent, self.scene)
    }
}
