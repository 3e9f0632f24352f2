//! The messages of MSF: what is answered, and what a transaction changes.

use sextant_kernel::StationId;

use super::super::{Asn, CellPlace, ReturnCode, SixP, SixPBody, SixPCommand};
use super::machine::{Draw, Msf};
use super::negotiated::{HeardCell, SendCell};
use super::peer::{Change, Ended, MOST_UNANSWERED};

impl Msf {
    /// A message of a neighbour came. Returns the answer to a request.
    pub fn receive(&mut self, from: StationId, message: &SixP, now: Asn, draw: Draw<'_>) -> Option<SixP> {
        match &message.body {
            SixPBody::Request(command) => {
                let (code, cells) = self.answer(from, message.sequence, command, now);
                Some(SixP { sequence: message.sequence, body: SixPBody::Response { code, cells } })
            }
            SixPBody::Response { code, cells } => {
                self.take_response(from, message.sequence, *code, cells, now, draw);
                None
            }
        }
    }

    fn answer(
        &mut self,
        from: StationId,
        sequence: u8,
        command: &SixPCommand,
        now: Asn,
    ) -> (ReturnCode, Vec<CellPlace>) {
        if *command == SixPCommand::Clear {
            self.drop_cells(from, now);
            let peer = self.peer(from);
            (peer.sequence, peer.answer, peer.open, peer.clears) = (0, None, None, 0);
            return (ReturnCode::Success, Vec::new());
        }
        let peer = self.peer(from);
        if !peer.is_free() {
            return (ReturnCode::Busy, Vec::new());
        }
        if sequence != peer.sequence {
            return (ReturnCode::SequenceError, Vec::new());
        }
        let has = |cell: &CellPlace| self.heard.contains(&HeardCell { peer: from, place: *cell });
        let suits = |candidates: &[CellPlace]| candidates.iter().copied().find(|place| self.is_free(place.timeslot));
        let (change, cell) = match command {
            SixPCommand::Add { candidates } => match suits(candidates) {
                Some(place) => (Change::Added(place), Some(place)),
                None => (Change::Nothing, None),
            },
            SixPCommand::Delete { cell } if has(cell) => (Change::Deleted(*cell), Some(*cell)),
            SixPCommand::Relocate { cell, candidates } if has(cell) => match suits(candidates) {
                Some(to) => (Change::Relocated { from: *cell, to }, Some(to)),
                None => (Change::Nothing, None),
            },
            SixPCommand::Delete { .. } | SixPCommand::Relocate { .. } | SixPCommand::Clear => {
                return (ReturnCode::CellListError, Vec::new());
            }
        };
        self.peer(from).answer = Some((sequence, change));
        (ReturnCode::Success, cell.into_iter().collect())
    }

    /// The sending of an answer that says yes has ended: it changes the schedule if it was acknowledged.
    pub fn answered(&mut self, to: StationId, sequence: u8, ended: Ended) {
        let peer = self.peer(to);
        let Some((_, change)) = peer.answer.take_if(|(number, _)| *number == sequence) else { return };
        if ended == Ended::GivenUp {
            return;
        }
        peer.count();
        let replace = |heard: &mut Vec<HeardCell>, from: Option<CellPlace>, by: Option<CellPlace>| {
            heard.retain(|cell| cell.peer != to || Some(cell.place) != from);
            heard.extend(by.map(|place| HeardCell { peer: to, place }));
        };
        match change {
            Change::Nothing => return,
            Change::Added(place) => replace(&mut self.heard, None, Some(place)),
            Change::Deleted(place) => replace(&mut self.heard, Some(place), None),
            Change::Relocated { from, to } => replace(&mut self.heard, Some(from), Some(to)),
        }
        self.has_changed = true;
    }

    /// The sending of a request has ended.
    pub fn asked(&mut self, to: StationId, sequence: u8, ended: Ended, now: Asn, draw: Draw<'_>) {
        let has_cells = self.cells_to(to).next().is_some();
        let peer = self.peer(to);
        if ended == Ended::Acknowledged {
            return;
        }
        let Some(open) = peer.open.take_if(|open| open.sequence == sequence) else { return };
        self.counts.failures += 1;
        if open.command == SixPCommand::Clear {
            self.clear_failed(to);
        } else if has_cells && self.peer(to).unanswered >= MOST_UNANSWERED {
            // Nothing arrives in the negotiated cells: the next request goes in the autonomous one.
            return self.start_again(to, now);
        }
        self.hold(to, now, draw);
    }

    fn take_response(
        &mut self,
        from: StationId,
        sequence: u8,
        code: ReturnCode,
        cells: &[CellPlace],
        now: Asn,
        draw: Draw<'_>,
    ) {
        let Some(open) = self.peer(from).open.take_if(|open| open.sequence == sequence) else { return };
        match code {
            ReturnCode::Success => {
                self.peer(from).count();
                self.complete(from, &open.command, cells.first().copied(), now, draw);
            }
            ReturnCode::SequenceError | ReturnCode::CellListError => {
                self.counts.failures += 1;
                self.start_again(from, now);
            }
            ReturnCode::Busy => {
                self.counts.failures += 1;
                self.hold(from, now, draw);
            }
            ReturnCode::Error => {
                self.counts.failures += 1;
                self.peer(from).held_until = Asn(now.0 + self.rules.quarantine);
            }
        }
    }

    /// A transaction is done, with the cell that the neighbour chose.
    fn complete(
        &mut self,
        from: StationId,
        command: &SixPCommand,
        cell: Option<CellPlace>,
        now: Asn,
        draw: Draw<'_>,
    ) {
        self.weigh(now);
        self.settle(now);
        self.misplaced = None;
        match (command, cell) {
            (SixPCommand::Clear, _) => {
                let peer = self.peer(from);
                (peer.sequence, peer.clears) = (0, 0);
            }
            (SixPCommand::Add { .. }, Some(place)) => self.sending.push(SendCell::new(from, place)),
            (SixPCommand::Delete { .. }, Some(place)) => {
                self.sending.retain(|cell| cell.peer != from || cell.place != place);
            }
            (SixPCommand::Relocate { cell: old, .. }, Some(place)) => {
                self.sending.retain(|cell| cell.peer != from || cell.place != *old);
                self.sending.push(SendCell::new(from, place));
                self.counts.relocations += 1;
            }
            // No slot is free at both.
            (SixPCommand::Add { .. } | SixPCommand::Delete { .. } | SixPCommand::Relocate { .. }, None) => {
                return self.hold(from, now, draw);
            }
        }
        self.has_changed = true;
    }
}
