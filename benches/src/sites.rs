//! Ratios of errors over logs and over the sites where they were recorded.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_kernel::{Purpose, Seed};

use crate::measured::geometric_mean;

/// Ratios below this count as this: a simple method that fails hardly tells how good another is.
pub const LEAST_RATIO: f64 = 0.5;
/// Samples of the bootstrap.
const SAMPLES: u64 = 4_000;
const RESAMPLING: Purpose = Purpose::new(120);

/// The site of each log. Logs of one site share walls, radios and mistakes, so that many of them count as one.
#[derive(Clone, Debug, Default)]
pub struct Sites(BTreeMap<String, String>);

impl Sites {
    /// Reads a table with the columns `log` and `site`.
    ///
    /// # Errors
    /// If the file cannot be read, or a line does not have two cells.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut sites = BTreeMap::new();
        for (number, line) in text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()) {
            let Some((log, site)) = line.split_once(',') else {
                return Err(format!("{}:{}: found `{line}`; allowed: `log,site`", path.display(), number + 1));
            };
            sites.insert(log.trim().to_owned(), site.trim().to_owned());
        }
        Ok(Self(sites))
    }

    /// The site of a log: its own where none is known.
    #[must_use]
    pub fn of<'a>(&'a self, log: &'a str) -> &'a str {
        self.0.get(log).map_or(log, String::as_str)
    }
}

/// The ratio of an error to that of the best simple method, in a log of a site.
#[derive(Clone, Debug)]
pub struct SiteRatio {
    /// The site.
    pub site: String,
    /// The log.
    pub log: String,
    /// The ratio.
    pub ratio: f64,
}

/// What several ratios tell.
#[derive(Clone, Debug, PartialEq)]
pub struct RatioSummary {
    /// Geometric mean over logs.
    pub over_logs: f64,
    /// Geometric mean over sites of the geometric means over their logs.
    pub over_sites: f64,
    /// 95 % interval of the mean over sites, by drawing sites again (percentile bootstrap; Efron 1979).
    pub interval: [f64; 2],
    /// The greatest ratio, and its log.
    pub worst: f64,
    /// The log with the greatest ratio.
    pub worst_log: String,
}

impl RatioSummary {
    /// The summary of `ratios`; `None` without any. Ratios below [`LEAST_RATIO`] count as it.
    #[must_use]
    pub fn of(ratios: &[SiteRatio]) -> Option<Self> {
        let mut of_sites: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for SiteRatio { site, ratio, .. } in ratios {
            of_sites.entry(site).or_default().push(libm::log(ratio.max(LEAST_RATIO)));
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let sites: Vec<f64> = of_sites.values().map(|logs| mean(logs)).collect();
        let over_logs = geometric_mean(ratios.iter().map(|one| one.ratio.max(LEAST_RATIO)))?;
        let mut drawn: Vec<f64> = (0..SAMPLES)
            .map(|sample| {
                let draw = |place| {
                    let number = Seed(1).bits(RESAMPLING, [sample, place, 0]) % sites.len() as u64;
                    sites[usize::try_from(number).unwrap_or(0)]
                };
                (0..sites.len() as u64).map(draw).sum::<f64>() / sites.len() as f64
            })
            .collect();
        drawn.sort_by(f64::total_cmp);
        let at = |share: usize| libm::exp(drawn[(drawn.len() - 1) * share / 1000]);
        let worst = ratios.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
        Some(Self {
            over_logs,
            over_sites: libm::exp(mean(&sites)),
            interval: [at(25), at(975)],
            worst: worst.ratio,
            worst_log: worst.log.clone(),
        })
    }
}

impl std::fmt::Display for RatioSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { over_logs, over_sites, interval: [low, high], worst, worst_log } = self;
        write!(
            f,
            "{over_logs:.3} over logs, {over_sites:.3} over sites ({low:.2} to {high:.2}), {worst:.2} at worst ({worst_log})"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_of_one_site_count_as_one_site() {
        let ratio = |site: &str, log: &str, ratio| SiteRatio { site: site.to_owned(), log: log.to_owned(), ratio };
        let ratios = [ratio("a", "a1", 2.0), ratio("a", "a2", 2.0), ratio("a", "a3", 2.0), ratio("b", "b", 0.1)];
        let told = RatioSummary::of(&ratios).unwrap();
        // Below a half counts as a half: the mean over sites is 1.
        assert!((told.over_sites - 1.0).abs() < 1e-12 && (told.over_logs - 2.0f64.sqrt()).abs() < 1e-12, "{told:?}");
        let [low, high] = told.interval;
        assert!((low - 0.5).abs() < 1e-12 && (high - 2.0).abs() < 1e-12, "{told:?}");
        assert!((told.worst - 2.0).abs() < 1e-12 && told.worst_log.starts_with('a'), "{told:?}");
        assert_eq!(RatioSummary::of(&[]), None);
    }

    #[test]
    fn a_log_without_a_site_is_its_own() {
        let path = std::env::temp_dir().join(format!("sites-{}.csv", std::process::id()));
        std::fs::write(&path, "log,site\noffice-1,office\noffice-2,office\n").unwrap();
        let sites = Sites::read(&path).unwrap();
        assert_eq!((sites.of("office-2"), sites.of("hall")), ("office", "hall"));
        std::fs::write(&path, "log,site\noffice-1\n").unwrap();
        assert!(Sites::read(&path).unwrap_err().contains("office-1"));
        std::fs::remove_file(&path).unwrap();
    }
}
