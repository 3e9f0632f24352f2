//! Maps must not depend on how a log is written: where the origin lies, where x points, in which order rows come, how nodes are
//! called, and what else is in the log that nobody heard.
//!
//! All estimators that suit any log are tried, so that a new one is tried without being named.

mod change;
mod logs;

use sextant_channel::ReceptionLog;
use sextant_kernel::Unwatched;
use sextant_mapper::{AlgorithmConfig, AnyLog, Choice, Estimate, EstimatorFindings, Mapper, TopologyMap};

use change::{Change, Changed};

/// A place moves by less than this share of the standard deviation that the estimator claims.
const MOST_SIGMAS: f64 = 0.05;
/// The same of an estimator that claims none (m): a log that comes from degrees is known to a tenth of a millimetre.
const MOST_M: f64 = 0.01;

/// An estimator by its name, with what suits any log.
fn mapper(any_log: &AnyLog) -> Mapper {
    let text = format!("{} = {}", any_log.key(), any_log.settings);
    let config: AlgorithmConfig = toml::from_str(&text).expect("good settings");
    Mapper::try_from(config).expect("good settings")
}

fn map(mapper: &Mapper, log: &ReceptionLog) -> (TopologyMap, Option<EstimatorFindings>) {
    mapper.map_and_learn(log, &Unwatched).expect("a map")
}

/// The standard deviation along an axis of the plane that an estimate claims (m).
fn sigma_m(estimate: &Estimate) -> Option<f64> {
    estimate.covariance.map(|c| (0.5 * (c[0][0] + c[1][1])).sqrt())
}

/// How far a node moved, and how far it may.
#[derive(Clone, Copy, Debug)]
struct Move {
    node: usize,
    way_m: f64,
    sigma_m: Option<f64>,
}

impl Move {
    fn share(&self) -> f64 {
        self.sigma_m.map_or(self.way_m / MOST_M, |sigma_m| self.way_m / (MOST_SIGMAS * sigma_m))
    }
}

/// The node that moved most, as a share of what it may.
fn worst(before: &TopologyMap, after: &TopologyMap, changed: &Changed) -> Move {
    let moves = before.estimates.iter().enumerate().map(|(node, estimate)| {
        let found = after.estimates[changed.node_of[node]].as_ref();
        assert_eq!(estimate.is_some(), found.is_some(), "node {node} is mapped or not");
        let Some((estimate, found)) = estimate.as_ref().zip(found) else {
            return Move { node, way_m: 0.0, sigma_m: None };
        };
        let way_m = (changed.place)(estimate.position).distance_m(found.position);
        Move { node, way_m, sigma_m: sigma_m(estimate) }
    });
    moves.max_by(|a, b| a.share().total_cmp(&b.share())).expect("a log has nodes")
}

/// The estimator that `auto` chose.
fn chosen(learned: Option<&EstimatorFindings>) -> Option<&'static str> {
    learned?.get::<Choice>().map(|choice| choice.chosen)
}

/// Maps `log` and what each change makes of it, and looks at the node that moves most.
fn check(any_log: &AnyLog, log: &ReceptionLog, changes: &[Change]) {
    let mapper = mapper(any_log);
    let (before, learned) = map(&mapper, log);
    assert!(before.mapped() > 0, "{}", any_log.name);
    for change in changes {
        let changed = change.of(log);
        let (after, of_changed) = map(&mapper, &changed.log);
        let worst = worst(&before, &after, &changed);
        assert!(worst.share() < 1.0, "{} after {change:?}: {worst:?}", any_log.name);
        assert_eq!(chosen(learned.as_ref()), chosen(of_changed.as_ref()), "{} after {change:?}", any_log.name);
        for (node, estimate) in before.estimates.iter().enumerate() {
            let concern = |estimate: &Option<Estimate>| estimate.as_ref().and_then(|estimate| estimate.concern);
            let found = concern(&after.estimates[changed.node_of[node]]);
            assert_eq!(concern(estimate), found, "{} after {change:?}: node {node}", any_log.name);
        }
    }
}

#[test]
fn each_estimator_gives_the_same_map_however_its_log_is_written() {
    let log = logs::lattice();
    for any_log in AlgorithmConfig::of_any_log() {
        check(&any_log, &log, &[Change::AllAtOnce, Change::FromDegrees]);
    }
}

#[test]
fn each_change_alone_leaves_the_map_where_it_is() {
    let log = logs::few();
    for any_log in AlgorithmConfig::of_any_log() {
        check(&any_log, &log, &Change::ALL);
    }
}

#[test]
fn packets_alone_give_the_same_map_however_the_log_is_written() {
    let log = logs::without_strengths(&logs::lattice());
    let needs_strengths = |name: &str| {
        ["rss-grid", "strongest-stop", "rssi-centroid", "least-squares", "gaussian-process"].contains(&name)
    };
    for any_log in AlgorithmConfig::of_any_log().into_iter().filter(|any_log| !needs_strengths(any_log.name)) {
        check(&any_log, &log, &[Change::AllAtOnce]);
    }
}

#[test]
fn a_survey_in_space_and_one_on_a_line_give_the_same_map_too() {
    for log in [logs::in_space(), logs::on_a_line()] {
        for any_log in AlgorithmConfig::of_any_log().into_iter().filter(|any_log| any_log.name != "auto") {
            check(&any_log, &log, &[Change::AllAtOnce]);
        }
    }
}

/// The folder of logs that `SEXTANT_LOGS` names, one folder a log: prints the greatest move of each estimator after each change.
/// Without the variable there is nothing to do.
#[test]
fn logs_of_a_folder_that_is_named_give_the_same_maps_however_they_are_written() {
    let Some(folder) = std::env::var_os("SEXTANT_LOGS") else { return };
    let mut failed = Vec::new();
    for (name, log) in logs::of_folder(folder.as_ref()) {
        for any_log in AlgorithmConfig::of_any_log() {
            let mapper = mapper(&any_log);
            let Ok((before, learned)) = mapper.map_and_learn(&log, &Unwatched) else { continue };
            let mut row = format!("{name} {}:", any_log.name);
            for change in Change::ALL {
                let changed = change.of(&log);
                let (after, of_changed) = map(&mapper, &changed.log);
                let worst = worst(&before, &after, &changed);
                let is_same = chosen(learned.as_ref()) == chosen(of_changed.as_ref());
                let moved = match worst.sigma_m {
                    Some(sigma_m) => format!("{:.4} sigma", worst.way_m / sigma_m),
                    None => format!("{:.4} m", worst.way_m),
                };
                row += &format!(" {change:?} {moved}{}", if is_same { "" } else { " OTHER CHOICE" });
                if worst.share() >= 1.0 || !is_same {
                    failed.push(format!("{name} {} {change:?}: {worst:?}", any_log.name));
                }
            }
            println!("{row}");
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
