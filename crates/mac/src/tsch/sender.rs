//! What a station sends, and in which slot: its queues, retries and the back-off of shared cells.
//!
//! The back-off is that of IEEE 802.15.4-2015, 6.2.5.3. A frame that fails in a shared cell waits for a random number of
//! shared cells to its station, uniform from 0 to 2^BE - 1; BE is `macMinBE` after the first failure of a frame and grows by one
//! with each further one, up to `macMaxBE`. In dedicated cells frames are sent again at once. A wait is kept as the slot in which
//! it ends, so that nothing is counted down.

use std::cmp::Reverse;
use std::collections::VecDeque;

use sextant_kernel::StationId;

use super::{Asn, BackoffExponents, Cell, Schedule};

/// Whose turn it is in a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// That of the enhanced beacon.
    Beacon,
    /// That of the first frame to all.
    All,
    /// That of the first frame to a station.
    Station(StationId),
}

/// A slot in which a station sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chance {
    /// The slot.
    pub asn: Asn,
    /// Its cell.
    pub cell: Cell,
    /// What is sent.
    pub turn: Turn,
}

/// What a transmission to a station was for its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending<T> {
    /// The frame was acknowledged.
    Acknowledged(T),
    /// It was sent as often as allowed.
    GivenUp(T),
    /// It will be sent again.
    Again,
}

/// The frames of a station, each with a `T`.
#[derive(Clone, Debug)]
pub struct Sender<T> {
    beacon: Option<T>,
    to_all: VecDeque<T>,
    queues: Vec<Queue<T>>,
    /// Frames that wait for each station, and for all.
    most_frames: usize,
    max_retries: u8,
    exponents: BackoffExponents,
}

/// The frames to a station.
#[derive(Clone, Debug)]
struct Queue<T> {
    peer: StationId,
    frames: VecDeque<T>,
    /// Transmissions of the first one.
    tries: u8,
    /// The back-off exponent; `None` as long as nothing failed.
    exponent: Option<u8>,
    /// The back-off of shared cells ends with this slot.
    backed_off: Asn,
}

impl<T> Sender<T> {
    /// A station without frames.
    #[must_use]
    pub fn new(most_frames: usize, max_retries: u8, exponents: BackoffExponents) -> Self {
        Self { beacon: None, to_all: VecDeque::new(), queues: Vec::new(), most_frames, max_retries, exponents }
    }

    /// Takes a frame to a station or to all.
    ///
    /// # Errors
    /// The frame, if as many wait already as may.
    pub fn offer(&mut self, to: Option<StationId>, frame: T) -> Result<(), T> {
        let most_frames = self.most_frames;
        let frames = match to {
            None => &mut self.to_all,
            Some(peer) => &mut self.queue_to(peer).frames,
        };
        if frames.len() >= most_frames {
            return Err(frame);
        }
        frames.push_back(frame);
        Ok(())
    }

    /// Takes a frame to a station that goes before those that wait, but for the first one, which may be under way. There is always
    /// room for it.
    pub fn offer_first(&mut self, peer: StationId, frame: T) {
        let queue = self.queue_to(peer);
        queue.frames.insert(queue.frames.len().min(1), frame);
    }

    /// The queue to a station, which may be a new one.
    fn queue_to(&mut self, peer: StationId) -> &mut Queue<T> {
        let known = self.queues.iter().position(|queue| queue.peer == peer);
        let place = known.unwrap_or_else(|| {
            let (frames, exponent) = (VecDeque::new(), None);
            self.queues.push(Queue { peer, frames, tries: 0, exponent, backed_off: Asn(0) });
            self.queues.len() - 1
        });
        &mut self.queues[place]
    }

    /// An enhanced beacon is due, instead of one that still waits.
    pub fn offer_beacon(&mut self, beacon: T) -> Option<T> {
        self.beacon.replace(beacon)
    }

    /// The next slot from `from` on in which the station sends. In a slot with several, the slotframe with the lowest number
    /// counts, then beacons, frames to all, and the fuller queue.
    #[must_use]
    pub fn next(&self, schedule: &Schedule, from: Asn) -> Option<Chance> {
        let beacon =
            self.beacon.iter().flat_map(|_| schedule.beacon_cells()).map(|cell| (cell, Turn::Beacon, from, 0));
        let to_all = self
            .to_all
            .front()
            .into_iter()
            .flat_map(|_| schedule.cells_to_all())
            .map(|cell| (cell, Turn::All, from, 0));
        let waiting = self.queues.iter().filter(|queue| !queue.frames.is_empty());
        let to_stations = waiting.flat_map(|queue| {
            schedule.cells_to(queue.peer).map(|cell| {
                let first = if cell.is_shared() { from.max(queue.backed_off) } else { from };
                (cell, Turn::Station(queue.peer), first, queue.frames.len())
            })
        });
        let order = |turn| match turn {
            Turn::Beacon => (0, StationId(0)),
            Turn::All => (1, StationId(0)),
            Turn::Station(peer) => (2, peer),
        };
        beacon
            .chain(to_all)
            .chain(to_stations)
            .map(|(cell, turn, first, frames)| (Chance { asn: cell.next_from(first), cell, turn }, frames))
            .min_by_key(|(chance, frames)| {
                let (kind, peer) = order(chance.turn);
                (chance.asn, chance.cell.slotframe.handle, kind, Reverse(*frames), peer, chance.cell.timeslot)
            })
            .map(|(chance, _)| chance)
    }

    /// The frame whose turn it is.
    ///
    /// # Panics
    /// If there is none.
    pub fn frame(&mut self, turn: Turn) -> &mut T {
        let frame = match turn {
            Turn::Beacon => self.beacon.as_mut(),
            Turn::All => self.to_all.front_mut(),
            Turn::Station(peer) => self.queue(peer).frames.front_mut(),
        };
        frame.expect("a turn is that of a frame that waits")
    }

    /// A beacon or a frame to all was sent, and is no more in its queue.
    ///
    /// # Panics
    /// If there is none, or it is the turn of a station.
    pub fn sent(&mut self, turn: Turn) -> T {
        let frame = match turn {
            Turn::Beacon => self.beacon.take(),
            Turn::All => self.to_all.pop_front(),
            Turn::Station(_) => None,
        };
        frame.expect("a frame to all was sent")
    }

    /// The first frame to `peer` was sent in a slot and acknowledged.
    ///
    /// # Panics
    /// If there is none.
    pub fn acknowledged(&mut self, peer: StationId, cell: Cell) -> Ending<T> {
        let queue = self.queue(peer);
        let frame = queue.frames.pop_front().expect("a frame was sent");
        queue.tries = 0;
        if cell.is_shared() || queue.frames.is_empty() {
            queue.exponent = None;
            queue.backed_off = Asn(0);
        }
        Ending::Acknowledged(frame)
    }

    /// The first frame to `peer` was sent in a slot and not acknowledged. `draw` gives a number from 0 to its argument, each with
    /// the same probability.
    ///
    /// # Panics
    /// If there is none.
    pub fn failed(
        &mut self,
        peer: StationId,
        Chance { asn, cell, .. }: Chance,
        schedule: &Schedule,
        draw: impl FnOnce(u32) -> u32,
    ) -> Ending<T> {
        let (max_retries, exponents) = (self.max_retries, self.exponents);
        let queue = self.queue(peer);
        queue.tries += 1;
        if queue.tries > max_retries {
            queue.tries = 0;
            queue.exponent = None;
            queue.backed_off = Asn(0);
            return Ending::GivenUp(queue.frames.pop_front().expect("a frame was sent"));
        }
        if cell.is_shared() {
            let exponent = queue.exponent.map_or(exponents.least, |last| (last + 1).min(exponents.greatest));
            queue.exponent = Some(exponent);
            let cells = draw((1 << exponent) - 1);
            queue.backed_off = after_shared_cells(schedule, peer, asn, cells);
        }
        Ending::Again
    }

    /// Takes all frames: the beacon, those to all, and then those to each station. The station sends nothing any more.
    pub fn take_all(&mut self) -> Vec<T> {
        let queued = self.queues.iter_mut().flat_map(|queue| queue.frames.drain(..));
        self.beacon.take().into_iter().chain(self.to_all.drain(..)).chain(queued).collect()
    }

    fn queue(&mut self, peer: StationId) -> &mut Queue<T> {
        self.queues.iter_mut().find(|queue| queue.peer == peer).expect("a frame to the station was offered")
    }
}

/// The slot of the shared cell to `peer` that follows after `cells` others.
fn after_shared_cells(schedule: &Schedule, peer: StationId, failed: Asn, cells: u32) -> Asn {
    let shared = || schedule.cells_to(peer).filter(Cell::is_shared);
    let next = |from: Asn| shared().map(|cell| cell.next_from(from)).min();
    let mut at = failed;
    if let (Some(only), 1) = (shared().next(), shared().count()) {
        at = only.next_from(failed.next());
        return Asn(at.0 + u64::from(cells) * u64::from(only.slotframe.length));
    }
    for _ in 0..=cells {
        // Cells may have been negotiated meanwhile.
        let Some(shared) = next(at.next()) else { return at.next() };
        at = shared;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::super::{CellOptions, CellPeer, Slotframe};
    use super::*;

    const PEER: StationId = StationId(9);
    const SHARED: CellOptions = CellOptions::TRANSMIT.and(CellOptions::RECEIVE).and(CellOptions::SHARED);

    fn cell(timeslot: u16, options: CellOptions, peer: CellPeer) -> Cell {
        Cell { slotframe: Slotframe { handle: 0, length: 10 }, timeslot, channel_offset: 0, options, peer }
    }

    fn minimal() -> Schedule {
        Schedule::new(vec![cell(0, SHARED, CellPeer::All)])
    }

    fn sender(max_retries: u8, least: u8, greatest: u8) -> Sender<&'static str> {
        Sender::new(2, max_retries, BackoffExponents { least, greatest })
    }

    #[test]
    fn the_back_off_of_a_frame_grows_up_to_its_limit_and_starts_again_with_the_next_one() {
        let schedule = minimal();
        let mut sender = sender(4, 1, 3);
        for frame in ["first", "second"] {
            sender.offer(Some(PEER), frame).expect("there is room");
        }
        for _ in 0..2 {
            let mut windows = Vec::new();
            let mut from = Asn(0);
            loop {
                let chance = sender.next(&schedule, from).expect("a frame waits");
                from = chance.asn.next();
                let mut window = None;
                let ending = sender.failed(PEER, chance, &schedule, |most| {
                    window = Some(most);
                    most
                });
                windows.extend(window);
                if ending != Ending::Again {
                    break;
                }
                // In the next `most` shared cells nothing is sent.
                let wait = sender.next(&schedule, from).expect("it is sent again").asn.0 - chance.asn.0;
                assert_eq!(wait, 10 * (u64::from(*windows.last().expect("drawn")) + 1));
            }
            assert_eq!(windows, [1, 3, 7, 7]);
        }
        assert_eq!(sender.next(&schedule, Asn(0)), None);
    }

    #[test]
    fn a_first_try_and_one_in_a_dedicated_cell_go_at_once() {
        let dedicated = cell(3, CellOptions::TRANSMIT, CellPeer::Station(PEER));
        let shared = cell(5, CellOptions::TRANSMIT.and(CellOptions::SHARED), CellPeer::Station(PEER));
        let schedule = Schedule::new(vec![dedicated, shared]);
        let mut sender = sender(3, 2, 5);
        sender.offer(Some(PEER), "frame").expect("there is room");
        let first = sender.next(&schedule, Asn(4)).expect("it waits");
        assert_eq!(first.asn, Asn(5));
        assert_eq!(sender.failed(PEER, first, &schedule, |most| most), Ending::Again);
        // The back-off holds in shared cells alone: three of them go by.
        let second = sender.next(&schedule, Asn(6)).expect("it waits");
        assert_eq!((second.asn, second.cell), (Asn(13), dedicated));
        assert_eq!(sender.failed(PEER, second, &schedule, |_| panic!("no back-off")), Ending::Again);
        assert_eq!(sender.next(&schedule, Asn(14)).map(|chance| chance.asn), Some(Asn(23)));
        assert_eq!(sender.next(&schedule, Asn(44)).map(|chance| chance.asn), Some(Asn(45)));
    }

    #[test]
    fn a_success_in_a_dedicated_cell_ends_the_back_off_only_if_nothing_else_waits() {
        let dedicated = cell(3, CellOptions::TRANSMIT, CellPeer::Station(PEER));
        let shared = cell(5, CellOptions::TRANSMIT.and(CellOptions::SHARED), CellPeer::Station(PEER));
        let schedule = Schedule::new(vec![dedicated, shared]);
        for (frames, next) in [(2, Asn(13)), (1, Asn(5))] {
            let mut sender = sender(3, 3, 5);
            for frame in &["a", "b"][..frames] {
                sender.offer(Some(PEER), frame).expect("there is room");
            }
            let failed = Chance { asn: Asn(5), cell: shared, turn: Turn::Station(PEER) };
            assert_eq!(sender.failed(PEER, failed, &schedule, |most| most), Ending::Again);
            assert_eq!(sender.acknowledged(PEER, dedicated), Ending::Acknowledged("a"));
            if frames == 1 {
                sender.offer(Some(PEER), "c").expect("there is room");
            }
            assert_eq!(sender.next(&schedule, Asn(4)).map(|chance| chance.asn), Some(next), "{frames}");
        }
    }

    /// Two stations with one frame each in the same shared cell: they meet again as often as they draw the same wait. All draws are
    /// tried: a frame is lost with the product of 2^-BE over its retries.
    #[test]
    fn two_stations_deliver_with_the_exact_probability_of_their_draws() {
        let schedule = minimal();
        for (retries, least, greatest, expected) in
            [(3, 1, 7, 0.984_375), (7, 1, 7, 1.0 - 0.5_f64.powi(28)), (7, 2, 5, 1.0 - 0.5_f64.powi(29))]
        {
            let mut station = sender(retries, least, greatest);
            station.offer(Some(PEER), "frame").expect("there is room");
            let mut meet = 1.0;
            loop {
                let chance = station.next(&schedule, Asn(0)).expect("a frame waits");
                let mut waits = Vec::new();
                let mut most = 0;
                let mut draw = 0;
                while draw <= most {
                    let mut one = station.clone();
                    let ending = one.failed(PEER, chance, &schedule, |greatest| {
                        most = greatest;
                        draw
                    });
                    if ending != Ending::Again {
                        break;
                    }
                    waits.push(one.next(&schedule, chance.asn.next()).expect("it is sent again").asn);
                    draw += 1;
                }
                if waits.is_empty() {
                    break;
                }
                let ties = waits.iter().flat_map(|a| waits.iter().filter(move |b| a == *b)).count();
                meet *= ties as f64 / (waits.len() * waits.len()) as f64;
                // What they drew does not matter for what follows, if it was the same.
                assert_eq!(station.failed(PEER, chance, &schedule, |_| 0), Ending::Again);
            }
            assert!((1.0 - meet - expected).abs() < 1e-15, "{retries} retries: {}", 1.0 - meet);
        }
    }

    #[test]
    fn a_frame_that_goes_first_waits_for_the_one_under_way_and_always_has_room() {
        let mut sender = sender(0, 1, 7);
        sender.offer_first(PEER, "first");
        sender.offer(Some(PEER), "last").expect("there is room");
        assert_eq!(sender.offer(Some(PEER), "lost"), Err("lost"));
        sender.offer_first(PEER, "second");
        let frames = sender.take_all();
        assert_eq!(frames, ["first", "second", "last"]);
    }

    #[test]
    fn beacons_go_first_and_then_frames_to_all_and_the_fuller_queue() {
        let schedule = minimal();
        let mut sender = sender(0, 1, 7);
        for (to, frame) in [(Some(StationId(1)), "a"), (Some(PEER), "b"), (Some(PEER), "c"), (None, "all")] {
            sender.offer(to, frame).expect("there is room");
        }
        assert_eq!(sender.offer(Some(PEER), "d"), Err("d"));
        sender.offer_beacon("beacon");
        let mut turns = Vec::new();
        while let Some(chance) = sender.next(&schedule, Asn(0)) {
            turns.push(*sender.frame(chance.turn));
            match chance.turn {
                Turn::Station(peer) => drop(sender.acknowledged(peer, chance.cell)),
                turn => drop(sender.sent(turn)),
            }
        }
        assert_eq!(turns, ["beacon", "all", "b", "a", "c"]);
    }
}
