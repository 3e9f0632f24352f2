//! Prints how well each estimator maps logs of robots whose nodes have known places: errors in the plane and in space, the
//! share of the nodes within their 95 % regions, and the time; for each log the best simple method, chosen with the truth, and
//! the ratio of `auto` and the link model to it. At the end, the geometric means of these ratios over logs and over sites, with a
//! bootstrap interval; beside them, one simple method for all logs; and the coverage of each log.
//!
//! Usage: `robot-logs [--json FILE] [--sites FILE] FOLDER..`
//!
//! - `--json`: writes all that was measured.
//! - `--sites`: a CSV table with the columns `log` and `site`. A log that it lacks is a site of its own.
//! - `FOLDER..`: each a log with `nodes.csv`, or a folder of such logs.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use sextant_benches::estimators::{self, Estimator, Role};
use sextant_benches::folders::{self, WITHOUT_STRENGTHS};
use sextant_benches::laws::KnownLog;
use sextant_benches::measured::{Measured, measure};
use sextant_benches::regret::{Row, coverage};
use sextant_benches::sites::{RatioSummary, SiteRatio, Sites};

use crate::tables::{Outcome, Words};

/// The estimators whose ratio to the best simple method is told, also without strengths.
const JUDGED: [&str; 2] = ["auto", "link-model"];
/// The simple method that is fixed in advance for all logs.
const FIXED: &str = "strongest-stop";

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let mut named: Vec<PathBuf> = Vec::new();
    let mut json: Option<PathBuf> = None;
    let mut sites = Sites::default();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--json" => json = Some(words.next().ok_or("--json needs a file")?.into()),
            "--sites" => sites = Sites::read(words.next().ok_or("--sites needs a file")?.as_ref())?,
            flag if flag.starts_with("--") => {
                return Err(format!("unknown flag {flag}; allowed: --json, --sites").into());
            }
            folder => named.push(folder.into()),
        }
    }
    if named.is_empty() {
        return Err("name folders: each a log with nodes.csv, or a folder of such logs".into());
    }
    let estimators = estimators::all()?;
    let mut out = std::io::stdout().lock();
    let (mut rows, mut bare_rows) = (Vec::new(), Vec::new());
    for folder in folders::logs_in(&named)? {
        let known = folders::read(&folder)?;
        let (nodes, stops) = (known.log.node_count(), known.log.stops().len());
        writeln!(out, "{} ({nodes} nodes, {stops} stops)", folder.display())?;
        rows.push(table(&mut out, &estimators, &known)?);
        if let Some(bare) = folders::without_strengths(&known)? {
            writeln!(out, "{}, without strengths", folder.display())?;
            let is_told = |one: &&Estimator| JUDGED.contains(&one.name) || one.name.starts_with("packet-centroid");
            let blind: Vec<Estimator> = estimators.iter().filter(is_told).cloned().collect();
            bare_rows.push(table(&mut out, &blind, &bare)?);
        }
    }
    let simple = simple(&estimators);
    writeln!(out, "\ntimes the best simple method, which differs from log to log")?;
    for name in JUDGED.iter().chain([&FIXED]) {
        summary(&mut out, &sites, &rows, &simple, name)?;
    }
    if !bare_rows.is_empty() {
        writeln!(out, "\nthe same without strengths, times the best packet centroid")?;
        for name in JUDGED {
            summary(&mut out, &sites, &bare_rows, &simple, name)?;
        }
    }
    if let Some(path) = json {
        rows.extend(bare_rows);
        std::fs::write(path, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(())
}

/// The line of an estimator over all logs.
fn summary(out: &mut impl Write, sites: &Sites, rows: &[Row], simple: &[&str], name: &str) -> Outcome<()> {
    let ratio = |row: &Row| {
        let site = sites.of(row.log.trim_end_matches(WITHOUT_STRENGTHS)).to_owned();
        Some(SiteRatio { site, log: row.log.clone(), ratio: row.regret(name, simple)? + 1.0 })
    };
    let ratios: Vec<SiteRatio> = rows.iter().filter_map(ratio).collect();
    let Some(told) = RatioSummary::of(&ratios) else { return Ok(()) };
    write!(out, "  {name}: {told}")?;
    if let Some(within) = coverage(rows, name) {
        let share = |row: &Row| Some(format!("{} {:.0} %", row.log, 100.0 * coverage([row], name)?));
        let shares: Vec<String> = rows.iter().filter_map(share).collect();
        write!(out, "; {:.1} % of the nodes in their regions: {}", 100.0 * within, shares.join(", "))?;
    }
    Ok(writeln!(out)?)
}

/// The simple methods.
fn simple(estimators: &[Estimator]) -> Vec<&'static str> {
    estimators.iter().filter(|one| one.role == Role::Simple).map(|one| one.name).collect()
}

/// Prints the lines of a log as they are measured.
fn table(out: &mut impl Write, estimators: &[Estimator], known: &KnownLog) -> Outcome<Row> {
    let mut maps = BTreeMap::new();
    for estimator in estimators {
        if let Some(measured) = measure(&estimator.mapper, known)? {
            line(out, estimator.name, &measured)?;
            maps.insert(estimator.name, measured);
        }
    }
    let (nodes, stops) = (known.log.node_count(), known.log.stops().len());
    let row = Row { family: known.family.clone(), log: known.name.clone(), nodes, stops, maps };
    if let Some((best, error_m)) = row.best(&simple(estimators)) {
        let ratios = JUDGED.iter().filter_map(|name| Some(format!("{name} {:.2}", row.error_m(name)? / error_m)));
        let ratios: Vec<String> = ratios.collect();
        writeln!(out, "  best simple method: {best}, {error_m:.3} m; times that: {}", ratios.join(", "))?;
    }
    Ok(row)
}

fn line(out: &mut impl Write, name: &str, measured: &Measured) -> Outcome<()> {
    let Measured { in_plane_m: plane, in_space_m: space, held, regions, half_axis_m, concerns, chosen, seconds } =
        measured;
    write!(
        out,
        "  {name:18} mean {:7.3} m, median {:7.3} m, 95 % below {:7.3} m, in space {:7.3} m",
        plane.mean, plane.median, plane.p95, space.mean
    )?;
    if *regions > 0 {
        write!(out, ", {:5.1} % in their regions", 100.0 * *held as f64 / *regions as f64)?;
    }
    if let Some(half_axis_m) = half_axis_m {
        write!(out, " of {half_axis_m:.2} m")?;
    }
    let chosen = chosen.as_ref().map_or_else(String::new, |chosen| format!(", chose {chosen}"));
    Ok(writeln!(out, ", {seconds:.1} s{chosen}, {concerns} concerns")?)
}
