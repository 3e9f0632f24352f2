//! Maps must not depend on how a log is written: where the origin lies, where x points, in which order rows come, how nodes are
//! called, and what else is in the log that nobody heard.
//!
//! All estimators that suit any log are tried, so that a new one is tried without being named.

mod change;
mod logs;

use std::path::Path;

use sextant_channel::ReceptionLog;
use sextant_kernel::Unwatched;
use sextant_mapper::{AlgorithmConfig, AnyLog, Choice, Estimate, EstimatorFindings, Mapper, TopologyMap};

use change::{Change, Changed};

use crate::estimators::of_receptions;

/// A place moves by less than this share of the standard deviation that the estimator claims.
const MOST_SIGMAS: f64 = 0.05;
/// The same of an estimator that claims none (m): a log that comes from degrees is known to a tenth of a millimetre.
const MOST_M: f64 = 0.01;
/// What coordinates of other last digits may do, times as much: the rounds of a fit may end elsewhere.
const OTHER_DIGITS: f64 = 20.0;

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

/// How far a node moved, and what it may.
#[derive(Clone, Copy, Debug)]
struct Move {
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
            return Move { way_m: 0.0, sigma_m: None };
        };
        let way_m = (changed.place)(estimate.position).distance_m(found.position);
        Move { way_m, sigma_m: sigma_m(estimate) }
    });
    moves.max_by(|a, b| a.share().total_cmp(&b.share())).expect("a log has nodes")
}

impl Change {
    /// How much more than usual a change may move places.
    fn tolerance(self) -> f64 {
        if self == Self::FromDegrees { OTHER_DIGITS } else { 1.0 }
    }
}

/// The estimator that `auto` chose.
fn chosen(learned: Option<&EstimatorFindings>) -> Option<&'static str> {
    learned?.get::<Choice>().map(|choice| choice.chosen)
}

/// Maps `log` and what each change makes of it, and looks at the node that moves most. Returns what is not the same.
fn differences(any_log: &AnyLog, log: &ReceptionLog, changes: &[Change]) -> Vec<String> {
    let mapper = mapper(any_log);
    let (before, learned) = map(&mapper, log);
    assert!(before.mapped() > 0, "{}", any_log.name);
    let mut found = Vec::new();
    for change in changes {
        let changed = change.of(log);
        let (after, of_changed) = map(&mapper, &changed.log);
        let worst = worst(&before, &after, &changed);
        if worst.share() >= change.tolerance() {
            found.push(format!("{} after {change:?}: {worst:?}", any_log.name));
        }
        let [was, is] = [&learned, &of_changed].map(|learned| chosen(learned.as_ref()));
        if was != is {
            found.push(format!("{} after {change:?} chose {is:?} instead of {was:?}", any_log.name));
        }
        for (node, estimate) in before.estimates.iter().enumerate() {
            let concern = |estimate: &Option<Estimate>| estimate.as_ref().and_then(|estimate| estimate.concern);
            let [was, is] = [concern(estimate), concern(&after.estimates[changed.node_of[node]])];
            if was != is {
                found.push(format!("{} after {change:?}: node {node} has {is:?} instead of {was:?}", any_log.name));
            }
        }
    }
    found
}

/// Each estimator of `names` gives the same map of `log` after each change.
fn check(names: fn(&str) -> bool, log: &ReceptionLog, changes: &[Change]) {
    let estimators = of_receptions().filter(|any_log| names(any_log.name));
    let found: Vec<String> = estimators.flat_map(|any_log| differences(&any_log, log, changes)).collect();
    assert!(found.is_empty(), "{found:#?}");
}

fn any(_: &str) -> bool {
    true
}

/// `auto` makes several maps, which takes long.
fn others_than_auto(name: &str) -> bool {
    name != "auto"
}

#[test]
fn each_estimator_gives_the_same_map_however_its_log_is_written() {
    check(any, &logs::lattice(), &[Change::AllAtOnce, Change::FromDegrees]);
}

#[test]
fn each_change_alone_leaves_the_map_where_it_is() {
    check(others_than_auto, &logs::few(), &Change::ALL);
}

#[test]
fn packets_alone_give_the_same_map_however_the_log_is_written() {
    let needs_none = |name: &str| {
        !["rss-grid", "strongest-stop", "rssi-centroid", "least-squares", "gaussian-process"].contains(&name)
    };
    check(needs_none, &logs::without_strengths(&logs::lattice()), &[Change::AllAtOnce]);
}

#[test]
fn a_survey_in_space_gives_the_same_map_too() {
    check(others_than_auto, &logs::in_space(), &[Change::AllAtOnce]);
}

#[test]
fn a_survey_on_a_line_has_nodes_on_the_same_side_unless_it_is_mirrored() {
    // Nothing in the log tells one side from the other, so that a mirrored log may have the other.
    let changes = [Change::Shift, Change::Turn37, Change::Turn90, Change::OtherOrderOfStops, Change::SilentFarStop];
    check(others_than_auto, &logs::on_a_line(), &changes);
}

/// The folder of logs that `SEXTANT_LOGS` names, one folder a log: prints the greatest move of each estimator after each change.
/// Without the variable there is nothing to do.
#[test]
fn logs_of_a_folder_that_is_named_give_the_same_maps_however_they_are_written() {
    let Some(folder) = std::env::var_os("SEXTANT_LOGS") else { return };
    let mut failed = Vec::new();
    for (name, log) in logs::of_folder(folder.as_ref()) {
        for any_log in of_receptions() {
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
                if worst.share() >= change.tolerance() || !is_same {
                    failed.push(format!("{name} {} {change:?}: {worst:?}", any_log.name));
                }
            }
            let error_m = logs::mean_error_m(&Path::new(&folder).join(&name), &log, &before);
            println!("{row} mean error {error_m:?} m {:?}", chosen(learned.as_ref()));
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
