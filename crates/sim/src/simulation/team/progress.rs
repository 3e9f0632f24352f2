//! The progress of parts that run in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use sextant_kernel::SimTime;

use crate::observer::{Observer, Progress};

/// How often the observer is asked whether to go on.
const LOOK: Duration = Duration::from_millis(100);

/// How far a group is, and whether it should go on.
#[derive(Debug, Default)]
pub(super) struct GroupProgress {
    time_ns: AtomicU64,
    stops: AtomicUsize,
    nodes_heard: AtomicUsize,
    packets_offered: AtomicU64,
    should_end: AtomicBool,
}

/// The observer of a group that notes its progress.
pub(super) struct Noting<'a>(pub(super) &'a GroupProgress);

impl Observer for Noting<'_> {
    fn goes_on(&mut self, progress: Progress) -> bool {
        let Self(group) = self;
        group.time_ns.store(progress.time.as_nanos(), Ordering::Relaxed);
        group.stops.store(progress.stops, Ordering::Relaxed);
        group.nodes_heard.store(progress.nodes_heard, Ordering::Relaxed);
        group.packets_offered.store(progress.packets_offered, Ordering::Relaxed);
        !group.should_end.load(Ordering::Relaxed)
    }
}

/// Does `work` while `observer` sees the progress of all groups together, and may end them.
pub(super) fn watch<T: Send>(
    groups: &[GroupProgress],
    nodes: usize,
    observer: &mut dyn Observer,
    work: impl FnOnce() -> T + Send,
) -> T {
    std::thread::scope(|scope| {
        let (done, is_done) = mpsc::channel();
        let worker = scope.spawn(move || {
            let result = work();
            // Nobody waits any more only if the observer panicked.
            let _ = done.send(());
            result
        });
        while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
            if !observer.goes_on(total(groups, nodes)) {
                groups.iter().for_each(|group| group.should_end.store(true, Ordering::Relaxed));
            }
        }
        match worker.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// The progress of all groups together: the time of the last one, and what all have done.
fn total(groups: &[GroupProgress], nodes: usize) -> Progress {
    let sum = |of: fn(&GroupProgress) -> &AtomicUsize| -> usize {
        groups.iter().map(|group| of(group).load(Ordering::Relaxed)).sum()
    };
    let time_ns = groups.iter().map(|group| group.time_ns.load(Ordering::Relaxed)).min().unwrap_or(0);
    Progress {
        time: SimTime::from_nanos(time_ns),
        stops: sum(|group| &group.stops),
        nodes_heard: sum(|group| &group.nodes_heard).min(nodes),
        nodes,
        packets_offered: groups.iter().map(|group| group.packets_offered.load(Ordering::Relaxed)).sum(),
    }
}
