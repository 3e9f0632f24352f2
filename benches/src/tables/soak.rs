//! Mixed work in one process for hours, with its memory and its open files: both must stay as they are.
//!
//! `cargo run --release -p sextant-benches -- soak HOURS > soak.csv` prints a row after each cycle of twelve rounds (time, rounds,
//! bytes and blocks that the program holds, resident memory, open files, files left over). All cycles do the same work, so what
//! the program holds after them must not grow: it ends with an error if the last quarter holds more than the second one at its
//! most, if its resident memory is a tenth larger, or if it has more files open. A leak of one block in a cycle shows within
//! minutes, and ten hours are more of the same. Each round simulates and records a scenario with another seed, exports its tables,
//! reads the recording back, maps it, sweeps a scenario, and does a part of a plan. Linux only: the figures are those of `/proc`.

use std::alloc::System;
use std::fs;
use std::io::Write;
use std::num::NonZeroU32;
use std::path::Path;

use sextant::export::ExportFormat;
use sextant::summary::Stopwatch;
use sextant::{AlgorithmName, NumberRange, RunRecorder, Scenario, Unwatched, export, map_log};
use sextant_recording::read_log;
use sextant_study::campaign::Replace;
use sextant_study::sweep::{self, Shard};
use sextant_study::{Campaign, Sweep};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

use crate::tables::{Outcome, Words};

/// Counts what the program holds.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Most cycles: the list of readings has room for them from the start, so that it does not grow.
const MOST_CYCLES: usize = 100_000;

/// Rounds of a cycle: each scenario with each algorithm.
const CYCLE: u64 = 12;

/// What the memory of the last quarter may be, in shares of that of the second one.
const ALLOWED: f64 = 1.1;

/// The process at one time.
#[derive(Clone, Copy, Debug)]
struct Reading {
    /// Bytes and blocks on the heap that are in use.
    held_bytes: usize,
    held_blocks: usize,
    resident_mb: f64,
    open_files: usize,
}

impl Reading {
    fn now() -> Outcome<Self> {
        let status = fs::read_to_string("/proc/self/status")?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("no resident memory is told")?;
        let kilobytes: f64 = line.trim().trim_end_matches(" kB").parse()?;
        let heap = ALLOCATOR.stats();
        let held_bytes = heap.bytes_allocated - heap.bytes_deallocated;
        let held_blocks = heap.allocations - heap.deallocations;
        Ok(Self {
            held_bytes,
            held_blocks,
            resident_mb: kilobytes / 1000.0,
            open_files: fs::read_dir("/proc/self/fd")?.count(),
        })
    }
}

/// One round of mixed work in `folder`.
fn round(number: u64, scenarios: &Path, folder: &Path) -> Outcome<()> {
    let names = ["smoke.toml", "mmtm/two-bands.toml", "sensing/targets-and-fields.toml", "mac/poisson-star.toml"];
    let name = names[usize::try_from(number % names.len() as u64)?];
    let scenario = Scenario::load(scenarios.join(name))?.with("seed", number)?;
    let recording = folder.join("run.mcap");
    let run = sextant::run(&scenario, &mut RunRecorder::new(&recording), &Unwatched)?;
    export(&recording, &folder.join("tables"), ExportFormat::Csv, &Unwatched)?;
    if run.survey().is_some_and(|survey| !survey.logs.first().stops().is_empty()) {
        let algorithms: [AlgorithmName; 3] = ["auto".parse()?, "ml-tm".parse()?, "packet-centroid".parse()?];
        map_log(read_log(&recording)?.log(), algorithms[usize::try_from(number % 3)?], &Unwatched)?;
    }
    let sweep = Sweep::read(&scenarios.join("smoke.toml"), &[], Some(number), NonZeroU32::new(3))?;
    let table = folder.join("t.csv");
    let rows = sweep::run(&sweep, Shard::default(), &table, false, &Unwatched)?;
    sweep::write_table(&table, &sweep, &rows)?;
    sweep::clear_parts(&table)?;
    let plan = Campaign::create(sweep, &folder.join("plan"), None, Replace::Plan)?;
    plan.run(NumberRange { start: 0, end: 2 }, &Unwatched)?;
    Ok(())
}

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let hours: f64 = words.next().ok_or("give the number of hours")?.parse()?;
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let folder = std::env::temp_dir().join(format!("sextant-soak-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "t_s,rounds,held_bytes,held_blocks,resident_mb,open_files,files_left")?;
    let (clock, mut readings, mut rounds) = (Stopwatch::start(), Vec::with_capacity(MOST_CYCLES), 0);
    while clock.elapsed_s() < hours * 3600.0 && readings.len() < MOST_CYCLES {
        for number in 0..CYCLE {
            round(number, &scenarios, &folder)?;
            rounds += 1;
        }
        let left = fs::read_dir(&folder)?.count();
        let reading = Reading::now()?;
        let Reading { held_bytes, held_blocks, resident_mb, open_files } = reading;
        let time_s = clock.elapsed_s();
        writeln!(out, "{time_s:.0},{rounds},{held_bytes},{held_blocks},{resident_mb:.1},{open_files},{left}")?;
        out.flush()?;
        readings.push(reading);
    }
    fs::remove_dir_all(&folder)?;
    judge(&readings)
}

/// An error if the process has grown.
fn judge(readings: &[Reading]) -> Outcome<()> {
    let quarter = |number: usize| &readings[number * readings.len() / 4..(number + 1) * readings.len() / 4];
    let mean_mb = |readings: &[Reading]| {
        readings.iter().map(|reading| reading.resident_mb).sum::<f64>() / readings.len().max(1) as f64
    };
    let most_files = |readings: &[Reading]| readings.iter().map(|reading| reading.open_files).max().unwrap_or(0);
    let (before, after) = (quarter(1), quarter(3));
    let most_bytes = |readings: &[Reading]| readings.iter().map(|reading| reading.held_bytes).max().unwrap_or(0);
    if most_bytes(after) > most_bytes(before) {
        return Err(format!("what is held grew from {} to {} bytes", most_bytes(before), most_bytes(after)).into());
    }
    if mean_mb(after) > ALLOWED * mean_mb(before) {
        return Err(format!("memory grew from {:.1} to {:.1} MB", mean_mb(before), mean_mb(after)).into());
    }
    if most_files(after) > most_files(before) {
        return Err(format!("open files grew from {} to {}", most_files(before), most_files(after)).into());
    }
    Ok(())
}
