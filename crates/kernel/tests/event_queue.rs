//! The order of the event queue, against a sorted reference.

use std::collections::BTreeMap;
use std::time::Duration;

use proptest::prelude::*;
use sextant_kernel::{EventQueue, Rank, SimTime, StationId};

#[derive(Clone, Debug)]
enum Step {
    /// Span from now (ns), class, node.
    Push(u64, u8, u32),
    Pop,
    Peek,
    /// Index among all keys returned so far.
    Cancel(prop::sample::Index),
}

/// Spans that are usual in a simulation, and unusual ones: ties, symbols, seconds, very long spans.
fn span() -> impl Strategy<Value = u64> {
    prop_oneof![
        3 => Just(0),
        6 => (0_u64..20).prop_map(|units| units * 64_000),
        3 => 0_u64..3,
        3 => 0_u64..2_000_000_000,
        1 => 0_u64..1 << 52,
    ]
}

fn step() -> impl Strategy<Value = Step> {
    let rank = (prop_oneof![0_u8..3, Just(u8::MAX)], prop_oneof![0_u32..3, Just(u32::MAX)]);
    prop_oneof![
        6 => (span(), rank).prop_map(|(span, (class, node))| Step::Push(span, class, node)),
        3 => Just(Step::Pop),
        1 => Just(Step::Peek),
        2 => any::<prop::sample::Index>().prop_map(Step::Cancel),
    ]
}

/// All pending events, sorted by instant, class, node and insertion.
type Reference = BTreeMap<(SimTime, u8, u32, usize), usize>;

fn first_of(reference: &mut Reference) -> Option<(SimTime, usize)> {
    reference.pop_first().map(|((at, ..), event)| (at, event))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn events_leave_as_from_a_sorted_list(steps in prop::collection::vec(step(), 0..400)) {
        let mut queue = EventQueue::new();
        let mut reference = Reference::new();
        let mut pushed = Vec::new();
        let mut now = SimTime::ZERO;
        for step in steps {
            match step {
                Step::Push(span, class, node) => {
                    let (at, event) = (now + Duration::from_nanos(span), pushed.len());
                    let key = queue.push(at, Rank::new(class, StationId(node)), event);
                    let place = (at, class, node, event);
                    reference.insert(place, event);
                    pushed.push((key, place));
                }
                Step::Pop => {
                    let expected = first_of(&mut reference);
                    now = expected.map_or(now, |(at, _)| at);
                    prop_assert_eq!(queue.pop(), expected);
                }
                Step::Peek => {
                    prop_assert_eq!(queue.peek_time(), reference.keys().next().map(|place| place.0));
                }
                Step::Cancel(index) if !pushed.is_empty() => {
                    // Often the key of an event that has left and whose slot holds another event.
                    let (key, place) = pushed[index.index(pushed.len())];
                    prop_assert_eq!(queue.cancel(key), reference.remove(&place));
                }
                Step::Cancel(_) => {}
            }
            prop_assert_eq!(queue.now(), now);
            prop_assert_eq!(queue.len(), reference.len());
            prop_assert_eq!(queue.is_empty(), reference.is_empty());
        }
        while let Some(expected) = first_of(&mut reference) {
            prop_assert_eq!(queue.pop(), Some(expected));
        }
        prop_assert_eq!(queue.pop(), None);
    }

    #[test]
    fn a_queue_of_thousands_with_most_events_cancelled_keeps_its_order(
        events in prop::collection::vec((span(), 0_u8..3, 0_u32..3), 1_000..3_000),
        kept_one_in in 2_usize..20,
    ) {
        let mut queue = EventQueue::new();
        let mut reference = Reference::new();
        let mut keys = Vec::new();
        for (event, &(span, class, node)) in events.iter().enumerate() {
            let at = SimTime::from_nanos(span);
            keys.push(queue.push(at, Rank::new(class, StationId(node)), event));
            reference.insert((at, class, node, event), event);
        }
        // The heap in front is filled before the sweep, so that the sweep has to keep it in order.
        prop_assert_eq!(queue.peek_time(), reference.keys().next().map(|place| place.0));
        for (event, key) in keys.into_iter().enumerate().filter(|(event, _)| event % kept_one_in > 0) {
            prop_assert_eq!(queue.cancel(key), Some(event));
            prop_assert_eq!(queue.cancel(key), None);
        }
        reference.retain(|_, event| event.is_multiple_of(kept_one_in));
        prop_assert_eq!(queue.len(), reference.len());
        while let Some(expected) = first_of(&mut reference) {
            prop_assert_eq!(queue.pop(), Some(expected));
        }
        prop_assert!(queue.is_empty());
    }
}

const fn rank(class: u8, node: u32) -> Rank {
    Rank::new(class, StationId(node))
}

fn micros(micros: u64) -> SimTime {
    SimTime::ZERO + Duration::from_micros(micros)
}

#[test]
fn events_of_one_instant_leave_by_class_then_node_then_insertion() {
    let mut queue = EventQueue::new();
    let at = micros(320);
    for (class, node, name) in
        [(4, 0, "e"), (1, 300, "c"), (1, 2, "a"), (1, 300, "d"), (255, 0, "g"), (4, u32::MAX, "f"), (1, 2, "b")]
    {
        queue.push(at, rank(class, node), name);
    }
    let left: String = std::iter::from_fn(|| queue.pop()).map(|(_, name)| name).collect();
    assert_eq!(left, "abcdefg");
}

#[test]
fn an_event_of_a_lower_class_pushed_at_the_present_instant_leaves_next() {
    let mut queue = EventQueue::new();
    queue.push(micros(64), rank(5, 1), "timer");
    queue.push(micros(64), rank(6, 1), "application");
    assert_eq!(queue.pop(), Some((micros(64), "timer")));
    queue.push(micros(64), rank(3, 9), "start of transmission");
    assert_eq!(queue.pop(), Some((micros(64), "start of transmission")));
    assert_eq!(queue.pop(), Some((micros(64), "application")));
}

#[test]
fn a_key_is_invalid_after_its_event_has_left_even_if_its_slot_is_reused() {
    let mut queue = EventQueue::new();
    let old = queue.push(micros(1), rank(0, 0), "old");
    assert_eq!(queue.pop(), Some((micros(1), "old")));
    assert_eq!(queue.cancel(old), None);
    let new = queue.push(micros(2), rank(0, 0), "new");
    assert_ne!(old, new);
    assert_eq!(queue.cancel(old), None);
    assert_eq!(queue.cancel(new), Some("new"));
    assert_eq!(queue.cancel(new), None);
    // A later event takes the slot of the cancelled one: it must leave once, at its own time.
    queue.push(micros(9), rank(0, 0), "newest");
    assert_eq!((queue.pop(), queue.pop()), (Some((micros(9), "newest")), None));
}

#[test]
fn earlier_events_may_be_pushed_after_a_peek() {
    let mut queue = EventQueue::new();
    queue.push(SimTime::MAX, rank(6, 0), "never");
    assert_eq!(queue.peek_time(), Some(SimTime::MAX));
    assert_eq!(queue.now(), SimTime::ZERO);
    let early = queue.push(micros(5), rank(6, 0), "early");
    assert_eq!(queue.peek_time(), Some(micros(5)));
    queue.cancel(early);
    assert_eq!(queue.peek_time(), Some(SimTime::MAX));
    queue.push(SimTime::ZERO, rank(6, 0), "at once");
    assert_eq!(queue.pop(), Some((SimTime::ZERO, "at once")));
    assert_eq!(queue.pop(), Some((SimTime::MAX, "never")));
}

#[test]
#[should_panic(expected = "pushed at 0.000063999 s, but the queue has reached 0.000064000 s")]
fn pushing_an_event_in_the_past_panics() {
    let mut queue = EventQueue::default();
    queue.push(micros(64), rank(0, 0), ());
    queue.pop();
    queue.push(SimTime::from_nanos(63_999), rank(0, 0), ());
}
