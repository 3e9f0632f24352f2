//! When an engine ends: after all tasks, at its time, or when nothing is left to happen.

use std::time::Duration;

use sextant_channel::Position;
use sextant_sim::{Application, Port, Setup, Timer};

use crate::network;

const FINISH: Timer = Timer(0);
const BEAT: Timer = Timer(1);

/// Does something each millisecond, so that there is always something to happen, and calls its task done at times.
struct Worker {
    has_task: bool,
    finishes_ms: Vec<u64>,
    beats: u64,
    most_beats: u64,
}

impl Application for Worker {
    fn has_task(&self) -> bool {
        self.has_task
    }

    fn started(&mut self, port: &mut Port<'_>) {
        for &at_ms in &self.finishes_ms {
            port.after(Duration::from_millis(at_ms), FINISH);
        }
        port.after(Duration::from_millis(1), BEAT);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == FINISH {
            port.finish();
            return;
        }
        self.beats += 1;
        if self.beats < self.most_beats {
            port.after(Duration::from_millis(1), BEAT);
        }
    }
}

fn worker(has_task: bool, finishes_ms: &[u64]) -> Worker {
    Worker { has_task, finishes_ms: finishes_ms.to_vec(), beats: 0, most_beats: 100 }
}

/// When an engine with these workers ends (ms).
fn end_ms(workers: Vec<Worker>, duration: Option<Duration>) -> u64 {
    let places = vec![Position::ORIGIN; workers.len()];
    let setup = Setup { duration, ..network::engine(&places, network::link(1.0, network::prompt()), 1) };
    let ended = network::run(setup, workers);
    assert!(!ended.interrupted);
    ended.end.as_nanos() / 1_000_000
}

#[test]
fn an_engine_ends_when_the_last_task_is_done() {
    assert_eq!(end_ms(vec![worker(true, &[5]), worker(true, &[9]), worker(false, &[])], None), 9);
}

#[test]
fn a_task_is_done_once_and_only_by_its_own_station() {
    assert_eq!(end_ms(vec![worker(true, &[5, 6]), worker(true, &[9])], None), 9);
    assert_eq!(end_ms(vec![worker(false, &[5]), worker(true, &[9])], None), 9);
}

#[test]
fn an_engine_ends_at_its_time_even_if_tasks_are_not_done_and_earlier_if_they_are() {
    let time = Some(Duration::from_millis(7));
    assert_eq!(end_ms(vec![worker(true, &[9])], time), 7);
    assert_eq!(end_ms(vec![worker(true, &[5])], time), 5);
    assert_eq!(end_ms(vec![worker(false, &[])], time), 7);
}

#[test]
fn an_engine_without_tasks_ends_when_nothing_is_left_to_happen() {
    assert_eq!(end_ms(vec![worker(false, &[]), worker(false, &[])], None), 100);
}
