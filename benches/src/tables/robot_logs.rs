//! Prints how well each estimator maps logs of robots whose nodes have known places: errors in the plane and in space, the
//! share of the nodes within their 95 % regions, and the time; for each log the best simple method, chosen with the truth, and
//! the ratio of `auto` and the link model to it; at the end, the geometric means of these ratios and the coverage of each log.
//!
//! Usage: `robot-logs [--json FILE] FOLDER..`: each a log with `nodes.csv`, or a folder of such logs.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use sextant_benches::estimators::{self, Estimator, Role};
use sextant_benches::folders;
use sextant_benches::laws::KnownLog;
use sextant_benches::measured::{Measured, geometric_mean, measure};
use sextant_benches::regret::{Row, coverage};

use crate::tables::{Outcome, Words};

/// The estimators whose ratio to the best simple method is told, also without strengths.
const JUDGED: [&str; 2] = ["auto", "link-model"];

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let mut named: Vec<PathBuf> = Vec::new();
    let mut json: Option<PathBuf> = None;
    while let Some(word) = words.next() {
        match word.as_str() {
            "--json" => json = Some(words.next().ok_or("--json needs a file")?.into()),
            flag if flag.starts_with("--") => return Err(format!("unknown flag {flag}; allowed: --json").into()),
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
            let blind: Vec<Estimator> = estimators.iter().filter(|one| JUDGED.contains(&one.name)).cloned().collect();
            bare_rows.push(table(&mut out, &blind, &bare)?);
        }
    }
    let simple = simple(&estimators);
    writeln!(out, "\nof all logs")?;
    for name in JUDGED {
        let ratios: Vec<f64> = rows.iter().filter_map(|row| Some(row.regret(name, &simple)? + 1.0)).collect();
        let worst = ratios.iter().copied().fold(0.0, f64::max);
        if let Some(mean) = geometric_mean(ratios) {
            let within = coverage(&rows, name).unwrap_or_default();
            let shares: Vec<String> = rows
                .iter()
                .map(|row| format!("{} {:.0} %", row.log, 100.0 * coverage([row], name).unwrap_or_default()))
                .collect();
            writeln!(
                out,
                "  {name}: {mean:.3} times the best simple method (geometric mean), {worst:.2} at worst; {:.1} % of the \
                 nodes in their regions: {}",
                100.0 * within,
                shares.join(", ")
            )?;
        }
    }
    if let Some(path) = json {
        rows.extend(bare_rows);
        std::fs::write(path, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(())
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
    let Measured { in_plane_m: plane, in_space_m: space, held, regions, concerns, chosen, seconds } = measured;
    write!(
        out,
        "  {name:18} mean {:7.3} m, median {:7.3} m, 95 % below {:7.3} m, in space {:7.3} m",
        plane.mean, plane.median, plane.p95, space.mean
    )?;
    if *regions > 0 {
        write!(out, ", {:5.1} % in their regions", 100.0 * *held as f64 / *regions as f64)?;
    }
    let chosen = chosen.as_ref().map_or_else(String::new, |chosen| format!(", chose {chosen}"));
    Ok(writeln!(out, ", {seconds:.1} s{chosen}, {concerns} concerns")?)
}
