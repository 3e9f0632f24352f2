//! Scripts of two or three stations that agree on cells.

use sextant_kernel::StationId;

use super::super::{Asn, Cell, CellPeer, ReturnCode, SixP, SixPBody, SixPCommand};
use super::{Ended, Msf, MsfRules};

const CHILD: StationId = StationId(1);
const PARENT: StationId = StationId(2);
const OTHER: StationId = StationId(3);

const RULES: MsfRules = MsfRules {
    length: 101,
    channels: 16,
    max_num_cells: 100,
    used_high: 75,
    used_low: 25,
    housekeeping: 6000,
    waits: [3000, 6000],
    quarantine: 30_000,
    timeout: 9393,
};

/// Numbers that follow each other in no order.
fn draws() -> impl FnMut() -> f64 {
    let mut state = 7_u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24)
    }
}

fn station(number: StationId) -> Msf {
    Msf::new(RULES, u16::try_from(number.0).expect("few stations"))
}

/// Number of cells in which a station sends to another, and in which it listens to it.
fn cells_between(msf: &Msf, peer: StationId) -> (usize, usize) {
    let of =
        |is: fn(&Cell) -> bool| msf.cells().filter(|cell| cell.peer == CellPeer::Station(peer)).filter(&is).count();
    (of(Cell::sends), of(Cell::listens))
}

/// All messages of `from` to others arrive, with their answers, until it has none.
fn settle(
    from: (StationId, &mut Msf),
    others: &mut [(StationId, &mut Msf)],
    now: Asn,
    draw: &mut dyn FnMut() -> f64,
) {
    let (own, asker) = from;
    while let Some((to, request)) = asker.act(now, draw) {
        asker.asked(to, request.sequence, Ended::Acknowledged, now, draw);
        let (_, answerer) = others.iter_mut().find(|(station, _)| *station == to).expect("a station of the script");
        let response = answerer.receive(own, &request, now, draw).expect("requests are answered");
        assert_eq!(asker.receive(to, &response, now, draw), None);
        answerer.answered(own, response.sequence, Ended::Acknowledged);
    }
}

/// The start of a child: after its wait it has a cell.
fn first_cell(child: &mut Msf, parent: &mut Msf, draw: &mut dyn FnMut() -> f64) -> Asn {
    child.begin(Some(PARENT), Asn(0), draw);
    assert_eq!(child.act(Asn(0), draw), None);
    let now = child.due().expect("it wants a cell");
    assert!(now < Asn(6000));
    settle((CHILD, child), &mut [(PARENT, parent)], now, draw);
    assert_eq!((cells_between(child, PARENT), cells_between(parent, CHILD)), ((1, 0), (0, 1)));
    now
}

/// Slot by slot, with frames in as many of the cells of a slotframe as `load` says, as far as there are cells.
fn run(child: &mut Msf, parent: &mut Msf, from: Asn, slots: u64, load: usize, draw: &mut dyn FnMut() -> f64) -> Asn {
    for asn in from.0..from.0 + slots {
        let cells: Vec<Cell> = child.cells().collect();
        let mut slotframe: Vec<&Cell> = cells.iter().collect();
        slotframe.sort_by_key(|cell| cell.timeslot);
        if let Some(place) = slotframe.iter().position(|cell| cell.is_at(Asn(asn)))
            && place < load
        {
            child.sent(slotframe[place], Ended::Acknowledged);
        }
        if child.due().is_some_and(|due| due.0 <= asn + 1) {
            settle((CHILD, child), &mut [(PARENT, parent)], Asn(asn + 1), draw);
        }
    }
    Asn(from.0 + slots)
}

#[test]
fn cells_grow_and_shrink_with_the_load_and_have_a_hysteresis() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    let mut now = first_cell(&mut child, &mut parent, &mut draw);
    // A load of c frames a slotframe: from below the first number of cells with c / cells at most 0.75, from above the first one with
    // at least 0.25.
    for (load, cells) in [(1, 2), (3, 4), (8, 11), (6, 11), (3, 11), (1, 4), (0, 1), (1, 2), (3, 4)] {
        now = run(&mut child, &mut parent, now, 40 * 101 * 12, load, &mut draw);
        assert_eq!(cells_between(&child, PARENT), (cells, 0), "load {load}");
        assert_eq!(cells_between(&parent, CHILD), (0, cells), "load {load}");
    }
}

#[test]
fn both_have_the_same_cells_in_slots_of_their_own() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    let now = first_cell(&mut child, &mut parent, &mut draw);
    run(&mut child, &mut parent, now, 101 * 600, 30, &mut draw);
    let places = |msf: &Msf| {
        let mut places: Vec<_> = msf.cells().map(|cell| (cell.timeslot, cell.channel_offset)).collect();
        places.sort_unstable();
        places
    };
    assert_eq!(places(&child), places(&parent));
    let slots: Vec<u16> = places(&child).iter().map(|place| place.0).collect();
    assert!(slots.len() > 20 && slots.windows(2).all(|pair| pair[0] < pair[1]), "{slots:?}");
    // Neither in that of the minimal schedule nor in their autonomous cells.
    assert!(slots.iter().all(|slot| ![0, 1, 2].contains(slot)));
}

/// The child has its cell, the parent not, because no acknowledgement of the response came. The next request has a number that
/// the parent does not expect: both give up all cells and begin again.
#[test]
fn a_lost_acknowledgement_of_a_response_is_found_by_its_number_and_cleared() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    child.begin(Some(PARENT), Asn(0), &mut draw);
    let now = child.due().expect("it wants a cell");
    let (_, request) = child.act(now, &mut draw).expect("it asks");
    let response = parent.receive(CHILD, &request, now, &mut draw).expect("it is answered");
    child.receive(PARENT, &response, now, &mut draw);
    parent.answered(CHILD, response.sequence, Ended::GivenUp);
    assert_eq!((cells_between(&child, PARENT), cells_between(&parent, CHILD)), ((1, 0), (0, 0)));
    // Its cell is full of frames.
    let cell = child.cells().next().expect("a cell");
    (0..100).for_each(|_| child.sent(&cell, Ended::Acknowledged));
    let now = child.due().expect("cells go by").0.max(now.0 + 101 * 100);
    let (_, second) = child.act(Asn(now), &mut draw).expect("it asks for more");
    assert_eq!(second.sequence, 1);
    let refusal = parent.receive(CHILD, &second, Asn(now), &mut draw).expect("it is answered");
    assert_eq!(refusal.body, SixPBody::Response { code: ReturnCode::SequenceError, cells: Vec::new() });
    child.receive(PARENT, &refusal, Asn(now), &mut draw);
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], Asn(now), &mut draw);
    assert_eq!((cells_between(&child, PARENT), cells_between(&parent, CHILD)), ((2, 0), (0, 2)));
    assert_eq!(child.used(Asn(now)).failures, 1);
}

#[test]
fn a_lost_response_is_waited_for_and_the_request_comes_again() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    child.begin(Some(PARENT), Asn(0), &mut draw);
    let now = child.due().expect("it wants a cell");
    let (_, request) = child.act(now, &mut draw).expect("it asks");
    let response = parent.receive(CHILD, &request, now, &mut draw).expect("it is answered");
    // While the answer waits, another request is refused.
    let busy = parent.receive(CHILD, &request, now, &mut draw).expect("it is answered");
    assert_eq!(busy.body, SixPBody::Response { code: ReturnCode::Busy, cells: Vec::new() });
    parent.answered(CHILD, response.sequence, Ended::GivenUp);
    assert_eq!(child.due(), Some(Asn((now.0 + RULES.timeout).min(now.0 + RULES.housekeeping))));
    assert_eq!(child.act(Asn(now.0 + RULES.timeout - 1), &mut draw), None);
    let late = Asn(now.0 + RULES.timeout);
    assert_eq!(child.act(late, &mut draw), None);
    assert_eq!(child.used(late).failures, 1);
    assert_eq!(child.act(Asn(late.0 + 2999), &mut draw), None);
    let again = Asn(late.0 + 6000);
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], again, &mut draw);
    assert_eq!((cells_between(&child, PARENT), cells_between(&parent, CHILD)), ((1, 0), (0, 1)));
}

#[test]
fn a_request_that_nobody_acknowledges_in_negotiated_cells_begins_again_with_an_autonomous_one() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    let now = first_cell(&mut child, &mut parent, &mut draw);
    let cell = child.cells().next().expect("a cell");
    (0..100).for_each(|_| child.sent(&cell, Ended::GivenUp));
    let now = Asn(now.0 + 101 * 100);
    let (to, request) = child.act(now, &mut draw).expect("it asks for more");
    assert!(matches!(request.body, SixPBody::Request(SixPCommand::Add { .. })));
    child.asked(to, request.sequence, Ended::GivenUp, now, &mut draw);
    let (_, clear) = child.act(now, &mut draw).expect("it clears");
    assert_eq!(clear.body, SixPBody::Request(SixPCommand::Clear));
    assert_eq!(cells_between(&child, PARENT), (0, 0));
    let response = parent.receive(CHILD, &clear, now, &mut draw).expect("it is answered");
    assert_eq!(cells_between(&parent, CHILD), (0, 0));
    child.receive(PARENT, &response, now, &mut draw);
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], now, &mut draw);
    assert_eq!((cells_between(&child, PARENT), cells_between(&parent, CHILD)), ((2, 0), (0, 2)));
}

#[test]
fn cells_move_to_a_new_parent_before_those_to_the_old_one_are_given_up() {
    let (mut child, mut parent, mut other, mut draw) = (station(CHILD), station(PARENT), station(OTHER), draws());
    let now = first_cell(&mut child, &mut parent, &mut draw);
    let now = run(&mut child, &mut parent, now, 101 * 400, 3, &mut draw);
    assert_eq!(cells_between(&child, PARENT), (4, 0));
    child.follow(Some(OTHER), now);
    // The first four requests ask the new parent.
    for cells in 1..=4 {
        let (to, request) = child.act(now, &mut draw).expect("it asks");
        assert_eq!(to, OTHER);
        let response = other.receive(CHILD, &request, now, &mut draw).expect("it is answered");
        child.receive(OTHER, &response, now, &mut draw);
        other.answered(CHILD, response.sequence, Ended::Acknowledged);
        assert_eq!((cells_between(&child, OTHER), cells_between(&child, PARENT)), ((cells, 0), (4, 0)));
    }
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent), (OTHER, &mut other)], now, &mut draw);
    assert_eq!((cells_between(&child, OTHER), cells_between(&child, PARENT)), ((4, 0), (0, 0)));
    assert_eq!((cells_between(&other, CHILD), cells_between(&parent, CHILD)), ((0, 4), (0, 0)));
}

#[test]
fn a_cell_that_collides_is_relocated() {
    let (mut child, mut parent, mut draw) = (station(CHILD), station(PARENT), draws());
    let now = first_cell(&mut child, &mut parent, &mut draw);
    let now = run(&mut child, &mut parent, now, 101 * 400, 2, &mut draw);
    let cells: Vec<Cell> = child.cells().collect();
    assert_eq!(cells.len(), 3);
    for _ in 0..300 {
        child.sent(&cells[0], Ended::Acknowledged);
        child.sent(&cells[1], Ended::GivenUp);
    }
    // At most a minute later it looks at its cells; no hundred of them have gone by.
    let mut now = now;
    while child.used(now).relocations == 0 {
        now = child.due().expect("it looks at its cells").max(now.next());
        settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], now, &mut draw);
        assert!(now.0 < 101 * 500 + 6000, "it was not relocated");
    }
    let after: Vec<Cell> = child.cells().collect();
    assert!(after.contains(&cells[0]) && after.contains(&cells[2]) && !after.contains(&cells[1]));
    let heard: Vec<u16> = parent.cells().map(|cell| cell.timeslot).collect();
    assert!(after.iter().all(|cell| heard.contains(&cell.timeslot)), "{heard:?}");
}

#[test]
fn a_neighbour_that_fails_is_left_alone_for_five_minutes() {
    let (mut child, mut draw) = (station(CHILD), draws());
    child.begin(Some(PARENT), Asn(0), &mut draw);
    let now = child.due().expect("it wants a cell");
    let (_, request) = child.act(now, &mut draw).expect("it asks");
    let body = SixPBody::Response { code: ReturnCode::Error, cells: Vec::new() };
    child.receive(PARENT, &SixP { sequence: request.sequence, body }, now, &mut draw);
    assert_eq!(child.act(Asn(now.0 + 29_999), &mut draw), None);
    assert!(child.act(Asn(now.0 + 30_000), &mut draw).is_some());
}

#[test]
fn a_full_schedule_has_no_cell_to_offer() {
    let rules = MsfRules { length: 4, ..RULES };
    let (mut child, mut parent, mut draw) = (Msf::new(rules, 1), Msf::new(rules, 2), draws());
    child.begin(Some(PARENT), Asn(0), &mut draw);
    let now = child.due().expect("it wants a cell");
    // Slots 0, 1 and 2 are those of the minimal schedule and the autonomous cells; slot 3 is left.
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], now, &mut draw);
    let cell = child.cells().next().expect("a cell");
    assert_eq!((cell.timeslot, child.used(now).cells), (3, 1));
    (0..100).for_each(|_| child.sent(&cell, Ended::Acknowledged));
    let later = Asn(now.0 + 400);
    settle((CHILD, &mut child), &mut [(PARENT, &mut parent)], later, &mut draw);
    assert_eq!(child.used(later).cells, 1);
    assert!(child.due().is_some_and(|due| due > later), "it waits: {:?}", child.due());
}
