//! The event queue in the hold model: take the next event, insert it again one gap later. Throughput in events/s.
//!
//! Gaps: `exponential` with a mean of 1 s (no ties); `csma`, the steps of an IEEE 802.15.4 cycle (CCA, turnaround,
//! frame of 20 octets, backoffs, 1 s to the next), which all lie on a grid of 64 µs and so tie often.
//! With `cancelled`, one event in ten also cancels another one and pushes it anew.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput};
use rand::RngExt;
use rand_distr::{Distribution, Exp1};
use sextant_kernel::{EventKey, EventQueue, Purpose, Rank, Seed, SimTime, StationId};

/// Events popped in one iteration.
const BATCH: u64 = 10_000;

/// As large as a simulation's event: 24 octets.
#[derive(Clone, Copy)]
struct Event {
    node: StationId,
    class: u8,
    _data: [u32; 4],
}

#[derive(Clone, Copy, Debug)]
enum Gaps {
    Exponential,
    Csma,
}

/// The operations on a queue. They are drawn before the measurement, because drawing takes as long as the queue
/// itself.
struct Load {
    pending: u32,
    starts: Vec<SimTime>,
    gaps: Vec<Duration>,
    /// Node whose event is cancelled after a pop.
    cancels: Vec<Option<StationId>>,
}

impl Load {
    fn new(gaps: Gaps, pending: u32, cancelled: bool) -> Self {
        const DRAWS: usize = 1 << 18;
        let mut draw = Seed(1).stream(Purpose::new(2), 0);
        let starts = (0..pending)
            .map(|_| match gaps {
                Gaps::Exponential => draw.random_range(0..1_000_000_000),
                Gaps::Csma => 64_000 * draw.random_range(0..15_625),
            })
            .map(SimTime::from_nanos)
            .collect();
        let gap = |_| match gaps {
            Gaps::Exponential => Duration::from_secs_f64(Exp1.sample(&mut draw)),
            Gaps::Csma => Duration::from_micros(match draw.random_range(0..6) {
                0 => 1_000_000,
                1 => 128,
                2 => 192,
                3 => 832,
                4 => 320 * draw.random_range(0..8),
                _ => 320 * draw.random_range(0..16),
            }),
        };
        let gaps = (0..DRAWS).map(gap).collect();
        let cancels = (0..DRAWS)
            .map(|_| (cancelled && draw.random_range(0..10) == 0).then(|| StationId(draw.random_range(0..pending))))
            .collect();
        Self { pending, starts, gaps, cancels }
    }
}

struct Hold<'a> {
    load: &'a Load,
    queue: EventQueue<Event>,
    keys: Vec<EventKey>,
    draws: usize,
}

impl<'a> Hold<'a> {
    /// A queue in its steady state.
    fn new(load: &'a Load) -> Self {
        let mut queue = EventQueue::new();
        let mut push = |(node, &at): (u32, _)| {
            let node = StationId(node);
            queue.push(at, Rank::new(0, node), Event { node, class: 0, _data: [0; 4] })
        };
        let keys = (0..).zip(&load.starts).map(&mut push).collect();
        let mut hold = Self { load, queue, keys, draws: 0 };
        hold.run(u64::from(2 * load.pending));
        hold
    }

    fn gap(&mut self) -> Duration {
        self.draws = (self.draws + 1) % self.load.gaps.len();
        self.load.gaps[self.draws]
    }

    fn run(&mut self, events: u64) {
        for _ in 0..events {
            let (now, mut event) = self.queue.pop().expect("as many events as nodes");
            event.class = (event.class + 1) % 6;
            let at = now + self.gap();
            self.keys[event.node.index()] = self.queue.push(at, Rank::new(event.class, event.node), event);
            if let Some(node) = self.load.cancels[self.draws] {
                let event = self.queue.cancel(self.keys[node.index()]).expect("one event a node");
                let at = now + self.gap();
                self.keys[node.index()] = self.queue.push(at, Rank::new(event.class, node), event);
            }
        }
    }
}

fn bench_queue(group: &mut BenchmarkGroup<'_, WallTime>, load: &Load) {
    let mut hold = None;
    group.bench_function(BenchmarkId::new("kernel", load.pending), |bencher| {
        let hold = hold.get_or_insert_with(|| Hold::new(load));
        bencher.iter(|| hold.run(black_box(BATCH)));
    });
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    for gaps in [Gaps::Exponential, Gaps::Csma] {
        for cancelled in [false, true] {
            let suffix = if cancelled { "_cancelled" } else { "" };
            let name = format!("event_queue/{gaps:?}{suffix}").to_lowercase();
            let mut group = criterion.benchmark_group(name);
            group.throughput(Throughput::Elements(BATCH));
            for pending in [100, 500, 10_000, 1_000_000] {
                let load = Load::new(gaps, pending, cancelled);
                bench_queue(&mut group, &load);
            }
        }
    }
    criterion.final_summary();
}
