//! Learns the constants by which `auto` joins opinions, with each site left out: the errors on sites that had no part in the
//! choice, and how the constants move.
//!
//! Usage: `cross-validation [--sites FILE] FOLDER..`
//!
//! - `--sites`: a CSV table with the columns `log` and `site`. A log that it lacks is a site of its own.
//! - `FOLDER..`: each a log with strengths and `nodes.csv`, or a folder of such logs.

use std::io::Write;
use std::path::PathBuf;

use rayon::prelude::*;
use sextant_benches::estimators::{self, Role};
use sextant_benches::folders;
use sextant_benches::laws::KnownLog;
use sextant_benches::measured::measure;
use sextant_benches::sites::{RatioSummary, SiteRatio, Sites};
use sextant_kernel::Unwatched;
use sextant_mapper::{
    Auto, AutoConfig, LinkModel, LinkModelConfig, OpinionConstants, OpinionSource, OtherOpinions, PositionError,
    TopologyMap,
};

use crate::tables::{Outcome, Words};

/// What is tried of the lower gain, the power of the link model there, the factor on the scales at a gain of 0, and its growth.
const LOWER_GAINS: [f64; 3] = [-0.3, -0.15, -0.05];
const LOWER_POWERS: [f64; 3] = [0.2, 0.3, 0.5];
const FACTORS: [f64; 3] = [1.5, 2.0, 3.0];
const GROWTHS: [f64; 3] = [0.0, 1.4, 3.0];

/// A log, with what does not depend on the constants.
struct MappedLog {
    site: String,
    known: KnownLog,
    map: TopologyMap,
    others: OtherOpinions,
    gain: Option<f64>,
    /// Mean error of the best simple method (m).
    best_m: f64,
}

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let mut named: Vec<PathBuf> = Vec::new();
    let mut sites = Sites::default();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--sites" => sites = Sites::read(words.next().ok_or("--sites needs a file")?.as_ref())?,
            flag if flag.starts_with("--") => return Err(format!("unknown flag {flag}; allowed: --sites").into()),
            folder => named.push(folder.into()),
        }
    }
    let folders = folders::logs_in(&named)?;
    let logs: Outcome<Vec<Option<MappedLog>>> = folders
        .par_iter()
        .map(|folder| {
            let known = folders::read(folder)?;
            let site = sites.of(&known.name).to_owned();
            mapped(known, site)
        })
        .collect();
    let logs: Vec<MappedLog> = logs?.into_iter().flatten().collect();
    if logs.is_empty() {
        return Err("name folders: each a log with strengths and nodes.csv, or a folder of such logs".into());
    }
    let settings = settings();
    let ratios: Vec<Vec<SiteRatio>> =
        settings.par_iter().map(|constants| logs.iter().filter_map(|log| ratio(log, constants)).collect()).collect();
    report(&mut std::io::stdout().lock(), &logs, &settings, &ratios)
}

/// What does not depend on the constants; `None` where opinions are not joined, or nothing is known of the truth.
fn mapped(known: KnownLog, site: String) -> Outcome<Option<MappedLog>> {
    let (_, choice) = Auto::try_from(AutoConfig::default())?.map(&known.log, None, &Unwatched)?;
    let Some(opinions) = choice.and_then(|choice| choice.opinions) else { return Ok(None) };
    let links = LinkModel::try_from(LinkModelConfig::default())?.with_own_share(opinions.own_share);
    let (map, fit) = links.map(&known.log, None, &Unwatched)?;
    let others = OtherOpinions::of(&known.log, OpinionSource::Strengths, &Unwatched)?;
    let has_far_nodes = fit.is_some_and(|fit| fit.has_far_nodes);
    let others = if has_far_nodes { others.amid_stops(&known.log, &map) } else { others };
    let mut best_m = f64::INFINITY;
    for simple in estimators::all()?.iter().filter(|one| one.role == Role::Simple) {
        if let Some(measured) = measure(&simple.mapper, &known)? {
            best_m = best_m.min(measured.in_plane_m.mean);
        }
    }
    let has_strengths = opinions.others.len() > 1 && best_m.is_finite();
    Ok(has_strengths.then_some(MappedLog { site, known, map, others, gain: opinions.gain, best_m }))
}

/// All that is tried.
fn settings() -> Vec<OpinionConstants> {
    let learnt = OpinionConstants::LEARNT;
    let mut all = Vec::new();
    for low in LOWER_GAINS {
        for power in LOWER_POWERS {
            for factor in FACTORS {
                for growth in GROWTHS {
                    all.push(OpinionConstants {
                        gains: [low, learnt.gains[1]],
                        links_power: [power, learnt.links_power[1]],
                        wider: [learnt.wider[0], factor],
                        wider_a_nat: growth,
                        ..learnt
                    });
                }
            }
        }
    }
    all
}

/// The ratio of the error in the plane to that of the best simple method.
fn ratio(log: &MappedLog, constants: &OpinionConstants) -> Option<SiteRatio> {
    let mut map = log.map.clone();
    log.others.join(&mut map, log.gain, constants);
    let both = map.estimates.iter().zip(&log.known.truth);
    let errors: Vec<f64> = both
        .filter_map(|(estimate, place)| {
            let apart = estimate.as_ref()?.position - (*place)?;
            Some(libm::hypot(apart.x_m, apart.y_m))
        })
        .collect();
    let error = PositionError::of(&errors)?;
    Some(SiteRatio { site: log.site.clone(), log: log.known.name.clone(), ratio: error.mean / log.best_m })
}

/// The number of the setting with the least mean over sites, if `site` has no part in it.
fn best_without(ratios: &[Vec<SiteRatio>], site: Option<&str>) -> Option<usize> {
    let mean = |ratios: &[SiteRatio]| {
        let others: Vec<SiteRatio> =
            ratios.iter().filter(|one| site.is_none_or(|site| one.site != site)).cloned().collect();
        RatioSummary::of(&others).map(|told| told.over_sites)
    };
    let means = ratios.iter().enumerate().filter_map(|(number, ratios)| Some((number, mean(ratios)?)));
    means.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number)
}

fn report(
    out: &mut impl Write,
    logs: &[MappedLog],
    settings: &[OpinionConstants],
    ratios: &[Vec<SiteRatio>],
) -> Outcome<()> {
    let words = |constants: &OpinionConstants| {
        let OpinionConstants { gains, links_power, wider, wider_a_nat, .. } = constants;
        format!("gain {}, power {}, factor {}, growth {wider_a_nat}", gains[0], links_power[0], wider[1])
    };
    let mut sites: Vec<&str> = logs.iter().map(|log| log.site.as_str()).collect();
    sites.sort_unstable();
    sites.dedup();
    writeln!(
        out,
        "{} logs of {} sites, {} settings; ratios to the best simple method",
        logs.len(),
        sites.len(),
        settings.len()
    )?;
    let in_use: Vec<SiteRatio> = logs.iter().filter_map(|log| ratio(log, &OpinionConstants::LEARNT)).collect();
    if let Some(told) = RatioSummary::of(&in_use) {
        writeln!(out, "in use ({}): {told}", words(&OpinionConstants::LEARNT))?;
    }
    if let Some(best) = best_without(ratios, None)
        && let Some(told) = RatioSummary::of(&ratios[best])
    {
        writeln!(out, "best of all logs ({}): {told}", words(&settings[best]))?;
    }
    let mut held_out: Vec<SiteRatio> = Vec::new();
    for site in sites {
        let Some(best) = best_without(ratios, Some(site)) else { continue };
        writeln!(out, "  without {site}: {}", words(&settings[best]))?;
        held_out.extend(ratios[best].iter().filter(|one| one.site == site).cloned());
    }
    if let Some(told) = RatioSummary::of(&held_out) {
        writeln!(out, "each site by constants without it: {told}")?;
    }
    Ok(())
}
