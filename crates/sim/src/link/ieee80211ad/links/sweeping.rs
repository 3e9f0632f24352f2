//! Sweeping: a station sweeps its sectors, at each of its tilts, and gathers the answers, or broadcasts a payload.

use sextant_channel::{Milliwatts, SectorSnr};
use sextant_kernel::StationId;
use sextant_mac::dmg::{Access, InitiatorReport, SectorMeasurement, SweepPurpose};

use super::{Gathered, Links, read};
use crate::link::ieee80211ad::stack::{RadioTask, Role};
use crate::purpose;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::sweep::SweepKind;
use crate::service::upcall::Upcall;

impl Links {
    /// Lets a station go on with what it has to send, if neither of its machines is busy: with what its responder made it
    /// put off, then the sweep that its application asked for, then the broadcasts that wait.
    pub(super) fn proceed(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        if stack.initiator.is_busy() || stack.responder.is_busy() {
            return;
        }
        if stack.task.is_none() {
            let sweep = stack.next_sweep.take().map(RadioTask::Sweep);
            stack.task = sweep.or_else(|| stack.waiting.pop_front().map(RadioTask::Broadcast));
            if stack.task.is_some() {
                if let Some(tracks) = &mut stack.tracks {
                    tracks.task.begin(scene.now);
                }
                self.set_tilt(station, 0);
            }
        }
        if let Some(task) = self.stacks[station.index()].task {
            self.start(station, task, scene);
        }
    }

    /// The responder of a station has heard something: a sweep to answer goes before what the station has to send.
    pub(super) fn give_way(&mut self, station: StationId, scene: &mut Scene) {
        if self.stacks[station.index()].responder.is_busy() {
            let (mut radio, initiator, _) = self.transceiver(station, Role::Initiator, scene);
            initiator.withdraw(&mut radio);
        } else {
            self.proceed(station, scene);
        }
    }

    /// The next sweep is that of tilt number `tilt`. One comes after the other, and after the last one the first.
    fn set_tilt(&mut self, station: StationId, tilt: u8) {
        let antenna = self.antennas.of(self.roll.kind(station));
        let per_sweep = antenna.sector_count() / antenna.sweeps();
        let stack = &mut self.stacks[station.index()];
        stack.numbers.first = tilt * per_sweep;
        stack.tilt = tilt;
    }

    /// Begins the sweep of one tilt.
    fn start(&mut self, station: StationId, task: RadioTask, scene: &mut Scene) {
        // Whoever alone speaks first needs no contention.
        let is_alone = self.roll.robots + self.roll.sinks == 1 && !self.has_broadcasts;
        let (purpose, access) = match task {
            RadioTask::Sweep(SweepKind::Gather) if is_alone => (SweepPurpose::Gather, Access::AtOnce),
            RadioTask::Sweep(SweepKind::Gather) => (SweepPurpose::Gather, Access::Contend),
            RadioTask::Sweep(SweepKind::Announce) => (SweepPurpose::Announce, Access::Contend),
            RadioTask::Broadcast(broadcast) => {
                let (sequence, payload_octets) = (broadcast.sequence(), broadcast.payload_octets);
                (SweepPurpose::Broadcast { sequence, payload_octets }, Access::Contend)
            }
        };
        let now = scene.now;
        let (mut radio, initiator, responder) = self.transceiver(station, Role::Initiator, scene);
        if let RadioTask::Broadcast(_) = task {
            // The initiator of a node hears no frames while it is idle, but its responder does.
            initiator.is_claimed_until(now, responder.claimed_until());
        }
        initiator.start(now, purpose, access, &mut radio);
    }

    /// The sweep of one tilt is over.
    pub(super) fn end_sweep(&mut self, station: StationId, report: InitiatorReport, scene: &mut Scene) {
        let task = self.stacks[station.index()].task.expect("a sweep is under way");
        if let RadioTask::Sweep(_) = task {
            self.gather(station, scene);
        }
        let packets = &mut self.ledger.packets[station.index()];
        packets.reports_asked += u64::from(report.asked);
        packets.reports_received += u64::from(report.reported);
        let tilt = self.stacks[station.index()].tilt + 1;
        if tilt < self.antennas.of(self.roll.kind(station)).sweeps() {
            self.set_tilt(station, tilt);
            self.start(station, task, scene);
            return;
        }
        self.stacks[station.index()].task = None;
        match task {
            RadioTask::Sweep(_) => {
                self.end_own_sweep(station, PacketEnd::Sent, PacketFate::Sent(FrameOutcome::Received), scene);
                let answers = self.sweeps.get(&station).map_or(0, |gathered| gathered.answers.len());
                self.ledger.deliveries[station.index()] += answers as u64;
                scene.upcalls.push(Upcall::Swept { station });
            }
            RadioTask::Broadcast(broadcast) => self.end_broadcast(station, broadcast, scene),
        }
        self.proceed(station, scene);
    }

    /// Keeps the answers to the sweep of this tilt: of each station, the answer with the best sector.
    fn gather(&mut self, station: StationId, scene: &Scene) {
        let loss = self.antennas.misalignment_loss();
        let antenna = self.antennas.of(self.roll.kind(station));
        let Some(Gathered { answers, powers, reports }) = self.sweeps.get_mut(&station) else { return };
        let stack = &self.stacks[station.index()];
        for answer in stack.initiator.answers() {
            let Some(from) = answer.responder.station() else { continue };
            let draw =
                [u64::from(station.0) << 32 | u64::from(from.0), self.swept[station.index()], stack.tilt.into()];
            if loss > 0.0 && scene.seed.uniform(purpose::MISALIGNMENT, draw) < loss {
                continue;
            }
            let Some(number) = stack.numbers.of(answer.select) else { continue };
            let rssi = powers.get(&from).copied().unwrap_or(Milliwatts(0.0));
            let sector = (!antenna.is_omnidirectional()).then(|| antenna.identity(number));
            let found = read(answer, sector, rssi, from);
            let best = answers.entry(from).or_insert_with(|| found.clone());
            let mut sectors = std::mem::take(&mut best.sectors);
            if found.snr > best.snr {
                *best = found;
            }
            // Each tilt has sectors of its own.
            let reported = reports.get(&from).map_or(&[][..], Vec::as_slice);
            sectors.extend(reported.iter().filter_map(|&SectorMeasurement { sector, snr }| {
                let number = stack.numbers.of(sector).filter(|_| !antenna.is_omnidirectional())?;
                #[expect(clippy::cast_possible_truncation, reason = "steps of 0.25 dB are exact in single precision")]
                let snr_db = snr.snr().0 as f32;
                Some(SectorSnr { sector: antenna.identity(number), snr_db })
            }));
            sectors.sort_by_key(|reported| reported.sector);
            best.sectors = sectors;
        }
        powers.clear();
        reports.clear();
    }
}
