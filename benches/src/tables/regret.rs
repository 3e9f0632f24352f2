//! Prints how much worse an estimator is than the best of several, chosen with the truth, on logs of many laws: simulated
//! surveys, laws that no estimator assumes, and folders; each with and without signal strengths.
//!
//! Usage: `regret [--families A,B] [--seeds N] [--only A,B] [--against A,B] [--json FILE] [--write DIR] [FOLDER..]`
//!
//! - `--families`: only these families of logs (`real` for the folders); all by default.
//! - `--seeds`: seeds 1 to N of each family that is made, 3 by default.
//! - `--only`: only these estimators. The subject is `auto`, or the first of them.
//! - `--against`: the candidates of the first regret; those that `auto` chooses among or joins by default. The second is against all.
//! - `--json`: writes all that was measured.
//! - `--write`: writes the logs that are made as folders with `nodes.csv`, and maps nothing.
//! - `FOLDER..`: each a log with `nodes.csv`, or a folder of such logs.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use rayon::prelude::*;
use sextant_benches::estimators::{self, Estimator};
use sextant_benches::folders;
use sextant_benches::laws::{self, KnownLog, LAWS};
use sextant_benches::measured::{geometric_mean, measure};
use sextant_benches::regret::{Regret, Row, chosen, coverage};
use sextant_benches::simulated::{self, SHIPPED};

use crate::tables::{Outcome, Words};

/// What is asked for.
struct Request {
    families: Option<Vec<String>>,
    seeds: u64,
    estimators: Vec<Estimator>,
    against: Vec<Estimator>,
    json: Option<PathBuf>,
    write: Option<PathBuf>,
    folders: Vec<PathBuf>,
}

/// The candidates of the first regret.
const AGAINST: &str = "link-model,self-calibrated,fitted,packet-centroid-6,strongest-stop,gaussian-process";

impl Request {
    fn of(mut words: Words) -> Outcome<Self> {
        let all = estimators::all()?;
        let mut request = Self {
            families: None,
            seeds: 3,
            against: estimators::named(&all, AGAINST)?,
            estimators: all.clone(),
            json: None,
            write: None,
            folders: Vec::new(),
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
            match word.as_str() {
                "--families" => request.families = Some(value()?.split(',').map(str::to_owned).collect()),
                "--seeds" => {
                    let value = value()?;
                    request.seeds = value.parse().map_err(|_| format!("--seeds {value}: allowed: a whole number"))?;
                }
                "--only" => request.estimators = estimators::named(&all, &value()?)?,
                "--against" => request.against = estimators::named(&all, &value()?)?,
                "--json" => request.json = Some(value()?.into()),
                "--write" => request.write = Some(value()?.into()),
                flag if flag.starts_with("--") => {
                    let known = "--families, --seeds, --only, --against, --json, --write";
                    return Err(format!("unknown flag {flag}; allowed: {known}").into());
                }
                folder => request.folders.push(folder.into()),
            }
        }
        let known = || SHIPPED.iter().map(|one| one.0).chain(LAWS.iter().map(|law| law.0)).chain(["real"]);
        let unknown = request.families.iter().flatten().find(|family| known().all(|other| other != family.as_str()));
        if let Some(unknown) = unknown {
            let known: Vec<&str> = known().collect();
            return Err(format!("no family `{unknown}`; allowed: {}", known.join(", ")).into());
        }
        Ok(request)
    }

    fn has(&self, family: &str) -> bool {
        self.families.as_ref().is_none_or(|families| families.iter().any(|one| one == family))
    }

    /// The logs that are made, with strengths.
    fn made(&self) -> Outcome<Vec<KnownLog>> {
        let shipped = SHIPPED.iter().filter(|one| self.has(one.0));
        let shipped = shipped.flat_map(|one| (1..=self.seeds).map(move |seed| (one, seed)));
        let shipped: Vec<_> = shipped.collect();
        let laws = LAWS.iter().filter(|law| self.has(law.0));
        let laws: Vec<_> = laws.flat_map(|law| (1..=self.seeds).map(move |seed| (law, seed))).collect();
        let simulated: Outcome<Vec<KnownLog>> =
            shipped.par_iter().map(|&(one, seed)| Ok(simulated::simulated(one, seed)?)).collect();
        let made: Outcome<Vec<KnownLog>> = laws.par_iter().map(|&(law, seed)| Ok(laws::made(law, seed)?)).collect();
        Ok([simulated?, made?].concat())
    }
}

pub(crate) fn print(words: Words) -> Outcome<()> {
    let request = Request::of(words)?;
    let mut logs = request.made()?;
    if let Some(folder) = &request.write {
        return logs.iter().try_for_each(|known| Ok(laws::write(known, &folder.join(&known.name))?));
    }
    if request.has("real") {
        let real: Result<Vec<KnownLog>, _> =
            folders::logs_in(&request.folders)?.iter().map(|folder| folders::read(folder)).collect();
        logs.extend(real?);
    }
    let bare: Result<Vec<_>, _> = logs.iter().map(folders::without_strengths).collect();
    logs.extend(bare?.into_iter().flatten());
    let rows: Outcome<Vec<Row>> = logs.par_iter().map(|known| row(&request.estimators, known)).collect();
    let rows = rows?;
    let mut out = std::io::stdout().lock();
    errors(&mut out, &request, &rows)?;
    regrets(&mut out, &request, &rows)?;
    if let Some(path) = &request.json {
        std::fs::write(path, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(())
}

/// What the estimators make of a log.
fn row(estimators: &[Estimator], known: &KnownLog) -> Outcome<Row> {
    let mut maps = BTreeMap::new();
    for estimator in estimators {
        let measured = measure(&estimator.mapper, known)
            .map_err(|error| format!("{}, {}: {error}", known.name, estimator.name))?;
        maps.extend(measured.map(|measured| (estimator.name, measured)));
    }
    let (family, log) = (known.family.clone(), known.name.clone());
    Ok(Row { family, log, nodes: known.log.node_count(), stops: known.log.stops().len(), maps })
}

/// The rows of each family, in the order of their first logs, and all of them.
fn families(rows: &[Row]) -> Vec<(&str, Vec<&Row>)> {
    let mut families: Vec<(&str, Vec<&Row>)> = Vec::new();
    for row in rows {
        match families.iter_mut().find(|(family, _)| *family == row.family) {
            Some((_, rows)) => rows.push(row),
            None => families.push((&row.family, vec![row])),
        }
    }
    families.push(("all", rows.iter().collect()));
    families
}

/// The table of errors: geometric means over the logs of a family.
fn errors(out: &mut impl Write, request: &Request, rows: &[Row]) -> Outcome<()> {
    let names: Vec<&str> = request.estimators.iter().map(|estimator| estimator.name).collect();
    writeln!(
        out,
        "Mean error in the plane [m], geometric mean over the logs of a family; seconds a log in the last line\n"
    )?;
    writeln!(out, "| family | logs | {} |", names.join(" | "))?;
    writeln!(out, "| --- |{}", " --- |".repeat(names.len() + 1))?;
    for (family, rows) in families(rows) {
        let cell = |name: &&str| {
            let mean = geometric_mean(rows.iter().filter_map(|row| row.error_m(name)));
            mean.map_or_else(|| "-".to_owned(), |mean| format!("{mean:.2}"))
        };
        writeln!(out, "| {family} | {} | {} |", rows.len(), names.iter().map(cell).collect::<Vec<_>>().join(" | "))?;
    }
    let seconds = |name: &&str| {
        let times: Vec<f64> = rows.iter().filter_map(|row| Some(row.maps.get(*name)?.seconds)).collect();
        format!("{:.2}", times.iter().sum::<f64>() / times.len().max(1) as f64)
    };
    Ok(writeln!(out, "| seconds | | {} |\n", names.iter().map(seconds).collect::<Vec<_>>().join(" | "))?)
}

/// The table of choices, regrets and regions.
fn regrets(out: &mut impl Write, request: &Request, rows: &[Row]) -> Outcome<()> {
    let names = |estimators: &[Estimator]| estimators.iter().map(|one| one.name).collect::<Vec<_>>();
    let all = names(&request.estimators);
    let subject = *all.iter().find(|name| **name == "auto").unwrap_or(&all[0]);
    let others: Vec<&str> = all.iter().copied().filter(|name| *name != subject).collect();
    let against: Vec<&str> = names(&request.against).into_iter().filter(|name| others.contains(name)).collect();
    let with_regions: Vec<&str> = all.iter().copied().filter(|name| coverage(rows, name).is_some()).collect();
    writeln!(
        out,
        "Regret of {subject}, and share of the nodes in their 95 % regions. Candidates: {}\n",
        against.join(", ")
    )?;
    writeln!(
        out,
        "| family | chosen | regret | worst | best | against all | worst | {} |",
        with_regions.iter().map(|name| format!("in regions: {name}")).collect::<Vec<_>>().join(" | ")
    )?;
    writeln!(out, "| --- |{}", " --- |".repeat(with_regions.len() + 6))?;
    for (family, rows) in families(rows) {
        let rows = || rows.iter().copied();
        let cells = |candidates: &[&str]| {
            Regret::of(rows(), subject, candidates).map_or_else(
                || "- | -".to_owned(),
                |Regret { mean, worst, worst_log }| {
                    format!("{:+.1} % | {:+.0} % ({worst_log})", 100.0 * mean, 100.0 * worst)
                },
            )
        };
        let mut best: BTreeMap<&str, usize> = BTreeMap::new();
        for (name, _) in rows().filter_map(|row| row.best(&against)) {
            *best.entry(name).or_default() += 1;
        }
        let best = best.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ");
        let regions = with_regions.iter().map(|name| {
            coverage(rows(), name).map_or_else(|| "-".to_owned(), |share| format!("{:.0} %", 100.0 * share))
        });
        let regions = regions.collect::<Vec<_>>().join(" | ");
        let chosen = chosen(rows(), subject);
        writeln!(out, "| {family} | {chosen} | {} | {best} | {} | {regions} |", cells(&against), cells(&others))?;
    }
    Ok(())
}
