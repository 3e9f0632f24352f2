//! Signals that come at any instant of any command: each command ends within a second, with exit code 130, and leaves no temporary
//! file. `SEXTANT_SIGNALS=50 cargo test -p sextant-cli --test cli -- signals` sends so many to each command, while other threads
//! keep all cores busy.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use sextant_kernel::{Purpose, Seed};

use super::Bench;
use crate::interrupt::ended;
use crate::program::{sextant, signal};

/// Signals to each command, unless more are asked for.
const USUAL: u64 = 1;

/// The signal comes within this time (s).
const WINDOW_S: f64 = 0.6;

/// The limit is one second; on a machine where also other tests run, a program gets more.
const PATIENCE: Duration = Duration::from_secs(4);

/// Each phase of long work: surveys, each estimator, bounds, sweeps, plans, tables, pictures, reports.
const COMMANDS: [&str; 20] = [
    "run big.toml --out b.mcap --pcap b.pcap --summary b.json",
    "run big.toml --out b.mcap --set maps.0.algorithm.ml_tm.estimate=posterior_mean",
    "run neighbours.toml --out b.mcap",
    "run search.toml --out b.mcap",
    "run seek.toml --out b.mcap",
    "map big.mcap --out m.csv --algorithm auto",
    "map big.mcap --out m.csv --algorithm link-model",
    "map big.mcap --out m.csv --algorithm ml-tm",
    "map big.mcap --out m.csv --algorithm self-calibrated",
    "map big.mcap --out m.csv --algorithm rss-grid",
    "map big.mcap --out m.csv --algorithm gaussian-process",
    "map big.mcap --out m.csv --algorithm link-model --tiles 8 --keep-tiles kept",
    "sweep big.toml --runs 8 --out t.csv",
    "sweep big.toml --runs 8 --plan plan",
    "sweep done --cells 0..4",
    "export big.mcap --out tables",
    "figure big.mcap --out figures",
    "report big.mcap --out r.html",
    "recover big.mcap --out whole.mcap",
    "reproduce 4.8 --runs 1 --out chapter",
];

const BIG: &str = "extends = \"a.toml\"\nworld.nodes.lattice = { spacing_m = 1.0, count = 900, \
    region.rectangle = { min_m = [0, 0], max_m = [34, 34] } }\n";

fn prepared() -> Bench {
    let bench = Bench::new();
    let robots = "[[robots]]\nname = \"surveyor\"\nstart_m = [-2.0, -2.0]\nlisten_s = 1.2\n\
        controller.s_path = { lane_spacing_m = 4.0, overshoot_m = 2.0, \
        region.rectangle = { min_m = [0, 0], max_m = [34, 34] } }\n";
    bench.write("big.toml", &format!("{BIG}{robots}"));
    bench.write("neighbours.toml", &shipped("dmtm/rf.toml"));
    bench.write("search.toml", &shipped("target/map-then-search.toml"));
    bench.write("seek.toml", &shipped("seek/maps.toml"));
    bench.done("run big.toml --out big.mcap --set recording.frames=false --quiet");
    bench.done("sweep big.toml --runs 4 --plan done --no-trial --quiet");
    bench
}

/// A scenario that extends a shipped one.
fn shipped(name: &str) -> String {
    format!("extends = {:?}\n", crate::program::scenario(name).canonicalize().expect("it is there"))
}

#[test]
fn each_command_ends_at_a_signal_in_each_phase() {
    let asked: Option<u64> = std::env::var("SEXTANT_SIGNALS").ok().map(|text| text.parse().expect("a number"));
    let signals = asked.unwrap_or(USUAL);
    // In the usual run, other tests are load enough.
    let spinning = asked.map_or(0, |_| thread::available_parallelism().map_or(1, usize::from));
    let bench = prepared();
    let is_over = AtomicBool::new(false);
    let (mut interrupted, mut longest) = (0, Duration::ZERO);
    thread::scope(|scope| {
        for _ in 0..spinning {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            for (at, line) in COMMANDS.iter().enumerate() {
                for number in 0..signals {
                    let draw = Seed(7).uniform(Purpose::new(1), [at as u64, number, 0]);
                    let name = if number.is_multiple_of(2) { "-INT" } else { "-TERM" };
                    let delay = Duration::from_secs_f64(0.05 + WINDOW_S * draw);
                    if let Some(time) = ended_by(&bench, line, name, delay) {
                        interrupted += 1;
                        longest = longest.max(time);
                    }
                }
            }
        }));
        is_over.store(true, Ordering::Relaxed);
        outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    });
    let sent = signals * COMMANDS.len() as u64;
    assert!(interrupted * 2 > sent, "of {sent} commands only {interrupted} were interrupted");
    eprintln!("{interrupted} of {sent} commands were interrupted; the longest took {longest:?}");
}

/// Sends a signal to a command, and returns how long it took to end; nothing if it had ended before.
fn ended_by(bench: &Bench, line: &str, name: &str, delay: Duration) -> Option<Duration> {
    let out = tempfile::tempdir_in(bench.folder()).expect("there is room");
    let words = line.split(' ').map(|word| {
        let is_input = ["big.mcap", "done"].contains(&word) || word.ends_with(".toml");
        if is_input { format!("../{word}") } else { word.to_owned() }
    });
    let mut child = sextant().args(words).current_dir(out.path()).spawn().expect("it starts");
    thread::sleep(delay);
    if let Some(status) = child.try_wait().expect("a child") {
        let said = String::from_utf8(child.wait_with_output().expect("a child").stderr).expect("UTF-8");
        assert!(status.success(), "`{line}` failed by itself: {said}");
        return None;
    }
    #[expect(clippy::disallowed_methods, reason = "the time until a program ends is what is tested")]
    let sent = Instant::now();
    signal(&child, name);
    let output = ended(child);
    let time = sent.elapsed();
    assert!(time <= PATIENCE, "`{line}` ended {time:?} after {name} at {delay:?}");
    let said = String::from_utf8_lossy(&output.stderr);
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 75 | 130)), "`{line}` after {name} at {delay:?}: {code:?} {said}");
    let left: Vec<_> = std::fs::read_dir(out.path())
        .expect("a folder")
        .map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned())
        .filter(|file| file.ends_with(".part") || file.ends_with(".recovering"))
        .collect();
    assert!(left.is_empty(), "`{line}` after {name} at {delay:?} left {left:?}");
    (code != Some(0)).then_some(time)
}
