//! How much worse an estimator is than the best of several, log by log and family by family.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::measured::{Measured, geometric_mean};

/// What all estimators made of one log.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The family of the log.
    pub family: String,
    /// The name of the log.
    pub log: String,
    /// Nodes and stops.
    pub nodes: usize,
    /// Stops.
    pub stops: usize,
    /// The maps, by estimator; estimators that cannot map the log are absent.
    pub maps: BTreeMap<&'static str, Measured>,
}

impl Row {
    /// Mean error in the plane of the estimator's map (m).
    #[must_use]
    pub fn error_m(&self, estimator: &str) -> Option<f64> {
        self.maps.get(estimator).map(|map| map.in_plane_m.mean)
    }

    /// The best of `candidates`, and its mean error in the plane (m).
    #[must_use]
    pub fn best<'a>(&self, candidates: &[&'a str]) -> Option<(&'a str, f64)> {
        let errors = candidates.iter().filter_map(|name| Some((*name, self.error_m(name)?)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// By what share the error of `subject` is above that of the best of `candidates`; below zero if it is better than all.
    #[must_use]
    pub fn regret(&self, subject: &str, candidates: &[&str]) -> Option<f64> {
        let (_, best_m) = self.best(candidates)?;
        Some(self.error_m(subject)? / best_m.max(1e-3) - 1.0)
    }
}

/// The regrets of several logs.
#[derive(Clone, Debug, Serialize)]
pub struct Regret {
    /// The mean: of the ratios to the best candidate, the geometric one, less 1.
    pub mean: f64,
    /// The greatest.
    pub worst: f64,
    /// The log with the greatest.
    pub worst_log: String,
}

impl Regret {
    /// The regrets of `rows`; `None` if none has one.
    #[must_use]
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a Row>, subject: &str, candidates: &[&str]) -> Option<Self> {
        let regrets: Vec<(f64, &str)> =
            rows.into_iter().filter_map(|row| Some((row.regret(subject, candidates)?, row.log.as_str()))).collect();
        let mean = geometric_mean(regrets.iter().map(|(regret, _)| 1.0 + regret))? - 1.0;
        let (worst, worst_log) = regrets.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self { mean, worst, worst_log: worst_log.to_owned() })
    }
}

/// The share of the nodes in their 95 % regions, pooled over `rows`; `None` if the estimator has no regions.
#[must_use]
pub fn coverage<'a>(rows: impl IntoIterator<Item = &'a Row>, estimator: &str) -> Option<f64> {
    let maps = rows.into_iter().filter_map(|row| row.maps.get(estimator));
    let (held, regions) = maps.fold((0, 0), |(held, all), map| (held + map.held, all + map.regions));
    (regions > 0).then(|| held as f64 / regions as f64)
}

/// How often each estimator was chosen by `chooser`, most often first: `link-model 4, fitted 1`.
#[must_use]
pub fn chosen<'a>(rows: impl IntoIterator<Item = &'a Row>, chooser: &str) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in rows.into_iter().filter_map(|row| row.maps.get(chooser)?.chosen.as_deref()) {
        *counts.entry(name).or_default() += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    counts.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use sextant_mapper::PositionError;

    use super::*;

    fn row(log: &str, errors_m: &[(&'static str, f64)]) -> Row {
        let map = |error_m: f64| {
            let error = PositionError::of(&[error_m]).unwrap();
            let chosen = Some("b".to_owned());
            Measured {
                in_plane_m: error,
                in_space_m: error,
                held: 3,
                regions: 4,
                half_axis_m: None,
                concerns: 0,
                chosen,
                seconds: 0.0,
            }
        };
        let maps = errors_m.iter().map(|&(name, error_m)| (name, map(error_m))).collect();
        Row { family: "f".to_owned(), log: log.to_owned(), nodes: 4, stops: 9, maps }
    }

    #[test]
    fn regret_is_what_the_subject_is_above_the_best_candidate() {
        let rows = [
            row("one", &[("auto", 2.0), ("a", 1.0), ("b", 4.0)]),
            row("two", &[("auto", 1.0), ("a", 3.0), ("b", 2.0)]),
            row("blind", &[("a", 3.0)]),
        ];
        let regret = Regret::of(&rows, "auto", &["a", "b"]).unwrap();
        assert!(regret.mean.abs() < 1e-12 && (regret.worst - 1.0).abs() < 1e-12 && regret.worst_log == "one");
        assert_eq!(rows[1].best(&["a", "b"]), Some(("b", 2.0)));
        assert!((coverage(&rows, "auto").unwrap() - 0.75).abs() < 1e-12);
        assert_eq!((chosen(&rows, "auto").as_str(), coverage(&rows, "none")), ("b 2", None));
        assert!(Regret::of(&rows, "none", &["a"]).is_none());
    }
}
