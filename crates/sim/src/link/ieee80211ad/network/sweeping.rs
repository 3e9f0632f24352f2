//! Sweeping: a station sweeps its sectors, at each of its tilts, and gathers the answers.

use sextant_channel::Milliwatts;
use sextant_kernel::StationId;
use sextant_mac::dmg::{Access, InitiatorReport, SweepPurpose, TxSector};

use super::{Gathered, Network, read};
use crate::link::ieee80211ad::stack::Role;
use crate::purpose;
use crate::scene::Scene;
use crate::service::sweep::SweepKind;
use crate::service::upcall::Upcall;

impl Network {
    /// Begins the sweep of one tilt.
    pub(super) fn sweep_at(&mut self, station: StationId, tilt: u8, scene: &mut Scene) {
        let antenna = self.antennas.of(self.roll.kind(station));
        let per_sweep = antenna.sector_count() / antenna.sweeps();
        let stack = &mut self.stacks[station.index()];
        // One after the other, and from the last one back to the first.
        stack.first_sectors = stack.first_sectors.map(|first| first - stack.tilt * per_sweep + tilt * per_sweep);
        stack.tilt = tilt;
        let kind = self.sweeps.get(&station).expect("a sweep is under way").kind;
        let (purpose, access) = match kind {
            SweepKind::Gather if self.roll.robots + self.roll.sinks == 1 => (SweepPurpose::Gather, Access::AtOnce),
            SweepKind::Gather => (SweepPurpose::Gather, Access::Contend),
            SweepKind::Announce => (SweepPurpose::Announce, Access::Contend),
        };
        let now = scene.now;
        let (mut radio, initiator, _) = self.transceiver(station, Role::Initiator, scene);
        initiator.start(now, purpose, access, &mut radio);
    }

    /// The sweep of one tilt is over.
    pub(super) fn end_sweep(&mut self, station: StationId, report: InitiatorReport, scene: &mut Scene) {
        self.gather(station, scene);
        let packets = &mut self.packets[station.index()];
        packets.transmissions += u64::from(report.frames);
        let tilt = self.stacks[station.index()].tilt + 1;
        if tilt < self.antennas.of(self.roll.kind(station)).sweeps() {
            self.sweep_at(station, tilt, scene);
            return;
        }
        packets.sent += 1;
        packets.received += 1;
        let answers = self.sweeps.get(&station).map_or(0, |gathered| gathered.answers.len());
        self.deliveries[station.index()] += answers as u64;
        scene.upcalls.push(Upcall::Swept { station });
    }

    /// Keeps the answers to the sweep of this tilt: of each station, the answer with the best sector.
    fn gather(&mut self, station: StationId, scene: &Scene) {
        let loss = self.antennas.misalignment_loss();
        let has_sectors = !self.antennas.of(self.roll.kind(station)).is_omnidirectional();
        let Some(Gathered { answers, powers, .. }) = self.sweeps.get_mut(&station) else { return };
        let stack = &self.stacks[station.index()];
        for answer in stack.initiator.answers() {
            let Some(from) = answer.responder.station() else { continue };
            let draw =
                [u64::from(station.0) << 32 | u64::from(from.0), self.swept[station.index()], stack.tilt.into()];
            if loss > 0.0 && scene.seed.uniform(purpose::MISALIGNMENT, draw) < loss {
                continue;
            }
            let TxSector { antenna, sector } = answer.select;
            let Some(first) = stack.first_sectors.get(usize::from(antenna)) else { continue };
            let rssi = powers.get(&from).copied().unwrap_or(Milliwatts(0.0));
            let found = read(answer, has_sectors.then_some(first + sector), rssi, from);
            let best = answers.entry(from).or_insert(found);
            if found.snr > best.snr {
                *best = found;
            }
        }
        powers.clear();
    }
}
