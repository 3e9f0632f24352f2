//! Prints a table of the grid solver's times against the literal product and a NumPy script, on one thread and on two.
//!
//! Usage: `grid-solver [W1|W2|W3|linear|W4|W5]..`, by default W1, W2, W3 and linear; `linear` goes up to 100
//! 000 nodes; W5 continues it. Peak memory is that of the whole process, the log included. `PYTHON` names an
//! interpreter with NumPy (`python3` if unset); without one the NumPy columns stay empty. The range is enlarged by
//! half a cell diagonal, so that every node is placed. Times are the shortest of several runs. Times of the literal
//! product and of NumPy are scaled from a sample of the nodes, from W3 on also from a sample of the vertices; they
//! then leave out the antenna sectors of W3.

use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use sextant_benches::workload::{self, Workload};
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{MlTm, MlTmConfig, ProfileConfig, TieRule, TrapezoidConfig};

use crate::tables::{Outcome, Words};

/// Number of nodes for which the literal product is computed.
const LITERAL_NODES: usize = 5;
/// Number of nodes given to the NumPy product, and to the NumPy matrix product.
const PEER_NODES: [usize; 2] = [5, 500];

pub(crate) fn print(words: Words) -> Outcome<()> {
    let mut names: Vec<String> = words.collect();
    if names.is_empty() {
        names = ["W1", "W2", "W3", "linear"].map(String::from).to_vec();
    }
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "| | nodes | stops | receptions a node | one thread [ms] | two threads [ms] | nodes/s | vertices/s | peak memory [MB] | literal product [s], ratio | NumPy product [s], ratio | NumPy GEMM [s], ratio | same vertex |"
    )?;
    writeln!(out, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    for name in &names {
        match name.as_str() {
            "W1" => row(&mut out, name, &workload::plane(), 30, Peers::Whole)?,
            "W2" => row(&mut out, name, &workload::ball(), 10, Peers::Whole)?,
            "W3" => row(&mut out, name, &workload::room(), 10, Peers::Sampled)?,
            "W4" => row(&mut out, name, &workload::field(100_000), 3, Peers::Sampled)?,
            "W5" => row(&mut out, name, &workload::field(1_000_000), 1, Peers::Sampled)?,
            "linear" => {
                for nodes in [1_000, 10_000, 100_000] {
                    row(&mut out, &format!("{nodes} nodes"), &workload::field(nodes), 3, Peers::None)?;
                }
            }
            _ => return Err(format!("`{name}`; allowed: W1, W2, W3, linear, W4, W5").into()),
        }
    }
    Ok(())
}

/// The part of a workload that is given to the literal product and to NumPy.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Peers {
    /// Nothing.
    None,
    /// Some nodes at widely spaced vertices. The time is scaled to all vertices, and no results are compared. Antenna
    /// sectors are left out; they would take more time.
    Sampled,
    /// Some nodes at all vertices.
    Whole,
}

/// Maximum number of pairs of a node and a stop for NumPy, because of its memory.
const MOST_PEER_PAIRS: usize = 120_000_000;
/// Approximate number of pairs of a vertex and a stop in a sample.
const SAMPLED_PAIRS: u64 = 4_000_000;

fn row(out: &mut impl std::io::Write, name: &str, workload: &Workload, runs: usize, peers: Peers) -> Outcome<()> {
    let log = &workload.log;
    let flat = log.stops().iter().all(|stop| stop.position.z_m.abs() < 1e-9);
    let half_diagonal_m = 0.5 * workload.grid_step_m * if flat { 2.0_f64 } else { 3.0 }.sqrt();
    let range_m = workload.range_m + half_diagonal_m;
    let profile = TrapezoidConfig::new(0.95, 0.2 * range_m, range_m);
    let config = MlTmConfig::new(workload.grid_step_m, ProfileConfig::Trapezoid(profile.clone()));
    let ml_tm = MlTm::try_from(MlTmConfig { ties: TieRule::First, ..config }).expect("good settings");
    let lattice = ml_tm.lattice(log).expect("a lattice");
    let (one, map) = least(1, runs, || ml_tm.map(log, &Unwatched).expect("a map"));
    let (two, _) = least(2, runs, || ml_tm.map(log, &Unwatched).expect("a map"));
    assert_eq!((map.infeasible(), map.unmapped()), (0, 0), "every node is answered");
    let place = |node: usize| map.estimates[node].as_ref().map(|estimate| estimate.position);
    let nodes = log.node_count();
    let scale = |sample: usize| count(nodes) / count(sample);
    write!(
        out,
        "| {name} | {nodes} | {} | {:.0} | {:.2} | {:.2} | {:.0} | {:.3e} | {:.0} |",
        log.stops().len(),
        count(log.receptions().len()) / count(nodes),
        one * 1e3,
        two * 1e3,
        count(nodes) / one,
        map_vertices(map.vertices_evaluated) / one,
        peak_mb().unwrap_or(f64::NAN),
    )?;
    let ratio = |seconds: f64| format!(" {seconds:.3}, {:.0} |", seconds / one);
    if peers == Peers::None {
        return Ok(writeln!(out, " | | | |")?);
    }
    let whole = peers == Peers::Whole;
    let sampled = (SAMPLED_PAIRS / log.stops().len() as u64).clamp(1, lattice.len());
    let stride = if whole { 1 } else { lattice.len().div_ceil(sampled) };
    let vertices = || (0..lattice.len()).step_by(usize::try_from(stride).expect("a lattice in memory"));
    let scale = |sample: usize| scale(sample) * map_vertices(lattice.len()) / count(vertices().count());
    let sample: Vec<usize> = (0..LITERAL_NODES).map(|i| i * nodes / LITERAL_NODES).collect();
    let (seconds, best) = least(1, 1, || {
        let best = |&node: &usize| {
            let node = NodeId::from_index(node);
            workload::likeliest(&lattice, vertices(), log, ml_tm.profile(), node).0
        };
        sample.iter().map(best).collect::<Vec<u64>>()
    });
    let same = |(&node, &index): (&usize, &u64)| place(node) == Some(lattice.position(lattice.vertex(index)));
    let agreed = sample.iter().zip(&best).filter(|&pair| same(pair)).count();
    write!(out, "{}", ratio(seconds * scale(LITERAL_NODES)))?;
    let folder = std::env::temp_dir().join(format!("sextant-grid-ml-{}", std::process::id()));
    let mut agreement = format!("literal {agreed} of {LITERAL_NODES}");
    for (version, sample) in [("product", PEER_NODES[0]), ("gemm", PEER_NODES[1])] {
        let sample = sample.min(nodes);
        // The matrix product is efficient for many nodes at once, so a small sample would be unfair.
        if sample * log.stops().len() > MOST_PEER_PAIRS {
            write!(out, " |")?;
            continue;
        }
        let places = vertices().map(|index| lattice.position(lattice.vertex(index)));
        write_case(&folder, log, places, &profile, sample)?;
        match peer(&folder, version) {
            Some((seconds, best)) => {
                let all: Vec<usize> = (0..sample).collect();
                let agreed = all.iter().zip(&best).filter(|&pair| same(pair)).count();
                agreement += &format!(", {version} {agreed} of {sample}");
                write!(out, "{}", ratio(seconds * scale(sample)))?;
            }
            None => write!(out, " |")?,
        }
    }
    if !whole {
        agreement.clear();
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(writeln!(out, " {agreement} |")?)
}

/// The shortest time of several runs on this many threads (s), and the result.
#[expect(clippy::disallowed_methods, reason = "a stopwatch")]
fn least<T: Send>(threads: usize, runs: usize, run: impl Fn() -> T + Sync) -> (f64, T) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let time = || {
            let start = Instant::now();
            let result = run();
            (start.elapsed().as_secs_f64(), result)
        };
        (1..runs).map(|_| time()).fold(time(), |best, next| if next.0 < best.0 { next } else { best })
    })
}

/// Writes the input of the NumPy script.
fn write_case(
    folder: &Path,
    log: &ReceptionLog,
    vertices: impl Iterator<Item = Position>,
    profile: &TrapezoidConfig,
    nodes: usize,
) -> Outcome<()> {
    std::fs::create_dir_all(folder)?;
    let octets = |values: &mut dyn Iterator<Item = f64>| values.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
    let stops = octets(&mut log.stops().iter().flat_map(|stop| <[f64; 3]>::from(stop.position)));
    std::fs::write(folder.join("stops.f64"), stops)?;
    std::fs::write(folder.join("vertices.f64"), octets(&mut vertices.flat_map(<[f64; 3]>::from)))?;
    let mut heard = vec![0_u8; nodes * log.stops().len()];
    for (node, row) in heard.chunks_mut(log.stops().len()).enumerate() {
        for reception in log.of(NodeId::from_index(node)) {
            row[reception.stop as usize] = 1;
        }
    }
    std::fs::write(folder.join("heard.u8"), heard)?;
    let TrapezoidConfig { p0, plateau_m, range_m, floor, ceiling } = *profile;
    std::fs::write(folder.join("profile.f64"), octets(&mut [p0, plateau_m, range_m, floor, ceiling].into_iter()))?;
    Ok(())
}

/// Time (s) and best vertices of the NumPy script; `None` if it does not run on this machine.
fn peer(folder: &Path, version: &str) -> Option<(f64, Vec<u64>)> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/grid_ml.py");
    let mut command = Command::new(python);
    command.arg(script).arg(folder).arg(version);
    for variable in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"] {
        command.env(variable, "1");
    }
    let output = command.output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    let (seconds, best) = text.trim().split_once('\n')?;
    let best = best.split(' ').map(str::parse).collect::<Result<_, _>>().ok()?;
    Some((seconds.parse().ok()?, best))
}

/// Peak memory of the process (MB); `None` if the system does not report it.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

fn count(number: usize) -> f64 {
    number as f64
}

fn map_vertices(number: u64) -> f64 {
    number as f64
}
