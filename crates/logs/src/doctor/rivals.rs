//! What looks like a mistake of a node, a clock or a map and is none: no check may accuse it. And the mistakes themselves, which
//! must be found beside it.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};

use super::tests::{NODES, changed, checks, clock_of_body, draw, findings, good, lanes, log_of, node, path};
use super::*;

/// The lanes, driven twice.
fn twice() -> Vec<Position> {
    [lanes(), lanes()].concat()
}

/// The log with other strengths (dBm): of a node, at a stop.
fn with_levels(log: &ReceptionLog, level: impl Fn(u32, u32, f64) -> f64) -> ReceptionLog {
    let row =
        |row: Reception| Reception { rssi_dbm: row.rssi_dbm.map(|dbm| level(row.node.0, row.stop, dbm)), ..row };
    changed(log, |stop| stop, row)
}

#[test]
fn a_loss_that_steps_is_no_node_that_moved() {
    for places in [lanes(), twice()] {
        let (log, half) = (log_of(&places, |number, _| node(number)), u32::try_from(places.len() / 2).unwrap());
        for loss_db in [5.0, 10.0] {
            for number in [1, 5] {
                let step = |of: u32, stop: u32| of == number && stop >= half;
                let stepped = with_levels(&log, |of, stop, dbm| if step(of, stop) { dbm - loss_db } else { dbm });
                assert_eq!(checks(&stepped), Vec::<&str>::new(), "n{number} {loss_db} dB weaker after {half}");
            }
            // A door that is open for a third of the survey, and a receiver that gets deaf.
            let dip = |stop: u32| stop >= half / 2 && stop < half;
            let door = with_levels(&log, |of, stop, dbm| if of % 3 == 0 && dip(stop) { dbm - loss_db } else { dbm });
            assert_eq!(checks(&door), Vec::<&str>::new(), "a door");
            let deaf = with_levels(&log, |_, stop, dbm| if stop >= half { dbm - loss_db } else { dbm });
            assert_eq!(checks(&deaf), Vec::<&str>::new(), "a receiver");
        }
    }
}

#[test]
fn nodes_that_move_far_are_found_whatever_the_others_do() {
    let places = twice();
    let (mut far, mut found) = (0, 0);
    for number in 0..NODES {
        let there = Position::new(if node(number).x_m < 10.0 { 18.0 } else { 2.0 }, 6.0, 0.0);
        if crate::place::distance::plane_m(there, node(number)) >= 9.0 {
            far += 1;
            let log = log_of(&places, |of, stop| if of == number && stop >= 77 { there } else { node(of) });
            let told = findings(&log);
            assert!(told.len() <= 1, "{told:?}");
            found += told.iter().filter(|one| one.odd.contains(&format!(": n{number} ("))).count();
        }
    }
    assert!(10 * found >= 9 * far, "{found} of {far} moves of 9 m and more");
}

#[test]
fn floors_are_no_moves() {
    // The same lanes on a second floor, whose ceiling costs 15 dB; nodes are heard best below the stairs in a corner.
    let stairs = Position::new(19.0, 11.0, 0.0);
    let log = log_of(&twice(), |of, stop| if stop >= 77 && of % 2 == 0 { stairs } else { node(of) });
    let weaker = with_levels(&log, |_, stop, dbm| if stop >= 77 { dbm - 15.0 } else { dbm });
    assert_eq!(checks(&weaker), Vec::<&str>::new(), "floors that no height tells");
    let few = log_of(&twice(), |of, stop| if stop >= 77 && of < 2 { stairs } else { node(of) });
    let lifted = |stop: Stop| {
        let is_above = stop.time.as_secs_f64() >= 770.0;
        Stop { position: stop.position + Position::new(0.0, 0.0, if is_above { 3.5 } else { 0.0 }), ..stop }
    };
    assert_eq!(checks(&changed(&few, lifted, |row| row)), Vec::<&str>::new(), "floors with heights");
    assert_eq!(checks(&few), ["moved-nodes"], "the same on one floor");
}

#[test]
fn strengths_without_distances_are_told_and_give_no_other_accusation() {
    let log = log_of(&twice(), |number, _| node(number));
    let mixed = with_levels(&log, |of, stop, _| -60.0 + 6.0 * draw(20, [u64::from(of), u64::from(stop)]));
    let told = checks(&mixed);
    assert!(told.contains(&"no-distance") && !told.contains(&"moved-nodes"), "{told:?}");
    // A field that changes smoothly over the hall, another one of each node.
    let smooth = |of: u32, stop: u32| {
        let at = twice()[stop as usize];
        let wave = |i: u64| {
            let [x, y] = [0, 1].map(|axis| 0.25 * draw(21, [u64::from(of), 2 * i + axis]));
            libm::cos(x * at.x_m + y * at.y_m + 3.0 * draw(22, [u64::from(of), i]))
        };
        -60.0 + 3.0 * (0..8).map(wave).sum::<f64>()
    };
    let told = checks(&with_levels(&log, |of, stop, _| smooth(of, stop)));
    assert!(!told.contains(&"moved-nodes"), "{told:?}");
}

#[test]
fn a_body_is_no_clock_and_a_clock_is_found_beside_a_body() {
    let path = path(0.5);
    type Body = (&'static str, fn(f64) -> f64);
    let bodies: [Body; 2] = [
        ("4 dB behind", |cosine| 2.0 * (1.0 - cosine)),
        ("4 dB in the rear half", |cosine| if cosine < 0.0 { 4.0 } else { 0.0 }),
    ];
    for (name, body) in bodies {
        for delay_s in [0.0, 3.0] {
            let found = clock_of_body(&path, delay_s, true, body);
            assert!((found.delay_s - delay_s).abs() < 0.8, "{name}, {delay_s} s: {found:?}");
            if delay_s.abs() < 0.1 {
                assert!(!found.is_clear, "{name}: {found:?}");
            } else if delay_s.abs() > 2.0 {
                assert!(found.told_s().is_some(), "{name}, {delay_s} s: {found:?}");
            }
        }
        let by_packets = clock_of_body(&path, 0.0, false, body);
        assert!(!by_packets.is_clear, "{name}, packets alone: {by_packets:?}");
    }
}

#[test]
fn nodes_at_their_places_are_not_far_from_where_they_are_strongest() {
    let log = good();
    let places: Vec<Option<Position>> = (0..NODES).map(|number| Some(node(number))).collect();
    assert_eq!(far_from_strongest::finding(&log, &places), None);
    // All of them in the middle of the hall, as a law without distance has them.
    let middle = vec![Some(Position::new(10.0, 6.0, 0.0)); NODES as usize];
    let found = far_from_strongest::finding(&log, &middle).unwrap();
    assert!(found.odd.contains(" of 12 nodes are mapped far from where they are heard strongest"), "{found}");
    // Outside of the hall, the nearest stop is the strongest.
    let log = log_of(&lanes(), |number, _| Position::new(node(number).x_m, -2.0, 0.0));
    let outside: Vec<_> = (0..NODES).map(|number| Some(Position::new(node(number).x_m, -4.0, 0.0))).collect();
    assert_eq!(far_from_strongest::finding(&log, &outside), None);
}
