//! Who wakes up while somebody sends: these checks take events, all others are counted.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::RadioState;
use sextant_mac::sleep::Rest;

use super::Links;
use crate::air::{Aim, Emission, PlacedRadio};
use crate::event::sleeping::Event;
use crate::link::sleeping::reach::WakeOrder;
use crate::link::sleeping::stack::PlannedCheck;
use crate::link::sleeping::usage::Usage;
use crate::scene::Scene;
use crate::service::outcome::Deafness;

impl Links {
    /// The network starts to work at a station.
    pub(super) fn begin_station(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        if !stack.is_there {
            return;
        }
        let (state, deafness) = match stack.sleeper.rest() {
            Rest::Asleep => (RadioState::Sleep, Some(Deafness::Asleep)),
            Rest::Listening => (RadioState::Receive, None),
        };
        stack.usage.enter(state, scene.now);
        self.radios.tune(station, deafness, &mut stack.deafness, scene);
    }

    /// Counts the checks of a station that sleeps up to now; a part of the last one, if it is under way.
    pub(super) fn count_idle(&mut self, station: StationId, now: SimTime) {
        let (usage, next) = self.with_idle_checks(station, now);
        let stack = &mut self.stacks[station.index()];
        stack.usage = usage;
        stack.handled = stack.handled.max(next);
    }

    /// How the radio of a station was used up to now, with the checks in which nobody sent, and the first check that is not in it.
    pub(super) fn with_idle_checks(&self, station: StationId, now: SimTime) -> (Usage, u64) {
        let stack = &self.stacks[station.index()];
        let mut usage = stack.usage;
        if !stack.is_there || !stack.sleeper.is_asleep() {
            return (usage, stack.handled);
        }
        let next = stack.checks.next_from(now);
        let number = next.saturating_sub(stack.handled);
        if number == 0 {
            return (usage, stack.handled);
        }
        let elapsed = now.saturating_since(stack.checks.start_of(next - 1));
        if elapsed >= self.settings.check_length() {
            usage.add_checks(number, self.settings.check_spans());
        } else {
            usage.add_checks(number - 1, self.settings.check_spans());
            usage.add_part(self.settings.check_spans_within(elapsed));
        }
        (usage, next)
    }

    /// A frame of `from` begins now and ends at `end`: those that could hear it, and whose check it meets, wake up.
    pub(super) fn wake(&mut self, from: StationId, end: SimTime, scene: &mut Scene) {
        let (now, length) = (scene.now, self.settings.check_length());
        let order = match self.reached[from.index()].take() {
            Some(order) if !order.is_stale(now) => order,
            Some(order) => self.order(order.stations(), now),
            None => self.find_reached(from, scene),
        };
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        candidates.extend(order.waking(now.saturating_sub(length)..end));
        self.reached[from.index()] = Some(order);
        for &station in &candidates {
            let stack = &self.stacks[station.index()];
            if station == from || !stack.is_there || !stack.sleeper.is_asleep() {
                continue;
            }
            let check = stack.checks.next_from((now + std::time::Duration::from_nanos(1)).saturating_sub(length));
            let begins = stack.checks.start_of(check);
            if begins >= end || check < stack.handled {
                continue;
            }
            if begins > now {
                if stack.planned.is_none_or(|planned| planned.number != check) {
                    let key = self.schedule_at(station, begins, Event::CheckDue, scene);
                    let earlier = self.stacks[station.index()].planned.replace(PlannedCheck { number: check, key });
                    if let Some(earlier) = earlier {
                        scene.queue.cancel(earlier.key);
                    }
                }
            } else {
                scene.steps += 1;
                self.go_on_checking(station, check, scene);
            }
        }
        self.candidates = candidates;
    }

    /// A check of a station begins that was planned.
    pub(super) fn check(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let Some(planned) = stack.planned.take() else { return };
        if stack.is_there && stack.sleeper.is_asleep() && planned.number >= stack.handled {
            self.go_on_checking(station, planned.number, scene);
        }
    }

    /// A check of a station, which has begun, goes on with its radio on.
    fn go_on_checking(&mut self, station: StationId, check: u64, scene: &mut Scene) {
        let elapsed = scene.now.saturating_since(self.stacks[station.index()].checks.start_of(check));
        self.count_idle(station, scene.now);
        let stack = &mut self.stacks[station.index()];
        if stack.handled <= check {
            // It begins now.
            stack.handled = check + 1;
            stack.usage.checks += 1;
        }
        self.command(station, scene, |sleeper, port| sleeper.check(elapsed, port));
    }

    /// Those of `stations` that sleep, in the order of their wake-ups.
    fn order(&self, stations: impl Iterator<Item = StationId>, now: SimTime) -> WakeOrder {
        let sleeping = stations.filter(|station| self.stacks[station.index()].sleeper.rest() == Rest::Asleep);
        let checks = sleeping.map(|station| (station, &self.stacks[station.index()].checks));
        WakeOrder::new(checks, self.settings.interval, self.drift, now)
    }

    /// Those that could hear a station: all, if that is not known for good.
    fn find_reached(&self, from: StationId, scene: &mut Scene) -> WakeOrder {
        let air = &mut scene.airs[self.radios.air];
        let is_known = air.powers_last() && !self.senses_weak;
        let emission = Emission { power: self.stacks[from.index()].tx_power, aim: Aim::Omnidirectional };
        let (now, motions) = (scene.now, &scene.motions);
        let placed = |station: StationId| PlacedRadio {
            radio: self.radios.interface(station),
            place: motions[station.index()].at(now),
        };
        let hears = |station: &StationId| {
            self.stacks[station.index()].is_there
                && *station != from
                && (!is_known || air.undisturbed(now, emission, placed(from), placed(*station)).is_some())
        };
        let found: Vec<StationId> = scene.roll.stations().filter(hears).collect();
        self.order(found.into_iter(), now)
    }
}
