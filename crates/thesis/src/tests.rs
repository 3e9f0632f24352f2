//! Tests of the experiments: everything that they read exists in their scenarios, and each conclusion can hold or fail.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::sync::LazyLock;

use tempfile::TempDir;

use super::*;
use sextant::scenario::Scenario;
use sextant::summary::Measure;
use sextant_kernel::Unwatched;
use sextant_study::sweep::{self, RunRow, Sweep};

/// Invented runs.
const RUNS: NonZeroU32 = NonZeroU32::new(3).expect("three is above zero");
/// Invented runs of searches: so many that the share of those with a capture can be above 0.8 for sure.
const SEARCH_RUNS: NonZeroU32 = NonZeroU32::new(20).expect("twenty is above zero");
/// Runs of tiny scenarios: the fewest with an interval.
const TINY_RUNS: NonZeroU32 = NonZeroU32::new(2).expect("two is above zero");

/// Settings that make a scenario so small that it runs in a moment.
fn tiny(scenario: &str) -> Vec<String> {
    if scenario.starts_with("mmtm/") || scenario.starts_with("dmtm/mmtm-") {
        return tiny_mmtm(scenario);
    }
    if scenario.starts_with("dmtm/") {
        return tiny_dmtm(scenario);
    }
    if scenario.starts_with("target/") {
        return tiny_search(scenario);
    }
    if scenario.starts_with("seek/") {
        return tiny_seek(scenario);
    }
    let nodes = match scenario {
        _ if scenario.contains("trajectory") => "world.nodes.random.count=30",
        "ml-tm/sphere.toml" | "ml-tm/cylinder.toml" => "world.nodes.lattice.count=100",
        _ => "world.nodes.lattice.count=50",
    };
    let mut set = vec![nodes, "maps.0.algorithm.ml_tm.grid_step_m=1.0"];
    if scenario.contains("comparison") {
        // With so few nodes and hops of 3 m, the network would not be connected.
        set.push("discovery.range_m=8.0");
    }
    set.into_iter().map(str::to_owned).collect()
}

/// The same for the scenarios of chapter 4: a few nodes around a short path below or above them.
fn tiny_mmtm(scenario: &str) -> Vec<String> {
    let places: Vec<_> = (0..12_u8).map(|i| format!("[{}.0, {}.0, {}.6]", i % 4, i / 4 + 1, i % 2)).collect();
    let z_m = if scenario.contains("greenhouse") { "3.0" } else { "0.3" };
    let stops =
        [(0.0, 0.0), (3.0, 0.5), (3.0, 4.0), (0.5, 4.0)].map(|(x_m, y_m)| format!("[{x_m:?}, {y_m:?}, {z_m}]"));
    let mut set = vec![
        format!("world.nodes={{ explicit = {{ positions_m = [{}] }} }}", places.join(", ")),
        "world.obstacles=[]".to_owned(),
        format!("robots.0.start_m={}", stops[0]),
        format!("robots.0.controller={{ waypoints = {{ places_m = [{}] }} }}", stops.join(", ")),
    ];
    if scenario.contains("comparison") {
        set.push("anchors.share=0.5".to_owned());
    } else if scenario.contains("few-anchors") {
        // A fiftieth of the nodes must be five anchors.
        let place = |i: usize| format!("[{}.0, {}.0, {}.6]", i % 20, i / 20, i % 2);
        let places: Vec<_> = (0..260).map(place).collect();
        set[0] = format!("world.nodes={{ explicit = {{ positions_m = [{}] }} }}", places.join(", "));
    } else {
        let maps = if scenario.starts_with("dmtm/") || scenario.contains("one-sweep") { 1 } else { 3 };
        set.extend((0..maps).map(|map| format!("maps.{map}.algorithm.mmtm.grid_step_m=0.45")));
    }
    set
}

/// The same for the maps of chapter 5 that nodes compute: enough nodes that a twentieth of them are several anchors.
fn tiny_dmtm(scenario: &str) -> Vec<String> {
    let places: Vec<_> =
        (0..60_u8).map(|i| format!("[{}.0, {}.0, {}.6]", 1 + i % 10, 1 + i / 10, 1 + i % 2)).collect();
    let mut set = vec![
        format!("world.nodes={{ explicit = {{ positions_m = [{}] }} }}", places.join(", ")),
        "world.obstacles=[]".to_owned(),
        "distributed_mapping.place.grid_step_m=0.6".to_owned(),
    ];
    if scenario.contains("hs-") || scenario.contains("heard-") {
        set.push("robots.0.start_m=[5.0, 3.0, 0.4]".to_owned());
        set.push(
            "robots.0.controller.random_walk.region.rectangle={ min_m = [0.0, 0.0], max_m = [10.0, 6.0] }".to_owned(),
        );
    }
    if scenario.contains("/hs-") || scenario.contains("anchors-hs-") {
        set.push("distributed_mapping.mobile_phase_s=5.0".to_owned());
    }
    set
}

/// The same for the searches of chapter 6: they end early.
fn tiny_search(scenario: &str) -> Vec<String> {
    let applications = match scenario {
        "target/filters.toml" => 7,
        "target/maps.toml" => 4,
        "target/imperfect-sensors.toml" => 5,
        _ if scenario.starts_with("target/elements-") => 9,
        _ => 3,
    };
    // Errors of predictions need a target that has been seen for a while.
    let has_predictions = ["filters", "thesis-1", "thesis-2", "thesis-3"].map(|name| format!("target/{name}.toml"));
    let duration_s = if has_predictions.contains(&scenario.to_owned()) { "20.0" } else { "8.0" };
    let mut set: Vec<_> = (0..applications).map(|i| format!("applications.{i}.duration_s={duration_s}")).collect();
    // In the large field fewer nodes, farther apart: the cost rises with the square of their number.
    let has_few_nodes =
        scenario.ends_with("-3.toml") || ["target/maps.toml", "target/walls.toml"].contains(&scenario);
    if !has_few_nodes {
        set.extend(["world.nodes.lattice.spacing_m=1.6", "world.nodes.lattice.count=600"].map(str::to_owned));
    }
    if scenario == "target/maps.toml" {
        set.push("maps.0.algorithm.ml_tm.grid_step_m=1.0".to_owned());
        set.push("maps.1.algorithm.self_calibrated.grid_step_m=1.0".to_owned());
    }
    set
}

/// The same for source seeking: few nodes around a start that is near the level.
fn tiny_seek(scenario: &str) -> Vec<String> {
    let applications = match scenario {
        "seek/space.toml" => 1,
        "seek/one-source.toml" | "seek/slow-robot.toml" => 4,
        _ => 3,
    };
    // In the room, the thesis' numbers need a minute and a half.
    let duration_s = if scenario == "seek/pioneer.toml" { "240.0" } else { "60.0" };
    let mut set: Vec<_> = (0..applications).map(|i| format!("applications.{i}.duration_s={duration_s}")).collect();
    set.extend(
        match scenario {
            "seek/pioneer.toml" => &[][..],
            "seek/space.toml" => &["robots.0.start_m=[15.0, 14.0, 6.0]"],
            "seek/two-sources.toml" => &[
                "world.nodes.lattice.count=300",
                "world.nodes.lattice.region.rectangle={ min_m = [35.0, 33.0], max_m = [55.0, 53.0] }",
                "robots.0.start_m=[46.0, 48.0]",
            ],
            _ => &[
                "world.nodes.lattice.count=300",
                "world.nodes.lattice.region.rectangle={ min_m = [28.0, 25.0], max_m = [48.0, 45.0] }",
                "robots.0.start_m=[30.0, 28.0]",
            ],
        }
        .iter()
        .map(|&setting| setting.to_owned()),
    );
    set
}

/// The plans of all scenarios of the chapters, in full size or tiny. Their files are in `folder`.
fn plans(folder: &TempDir, is_tiny: bool) -> BTreeMap<String, Sweep> {
    write_scenarios(folder.path()).unwrap();
    let mut plans = BTreeMap::new();
    let experiments = experiments();
    for scenario in experiments.iter().flat_map(Experiment::scenarios) {
        let set = if is_tiny { tiny(scenario) } else { Vec::new() };
        let runs = match scenario {
            _ if is_tiny => TINY_RUNS,
            _ if scenario.starts_with("target/") || scenario.starts_with("seek/") => SEARCH_RUNS,
            _ => RUNS,
        };
        let plan = || Sweep::read(&folder.path().join(scenario), &set, None, Some(runs)).unwrap();
        plans.entry(scenario.to_owned()).or_insert_with(plan);
    }
    plans
}

/// The plans in full size, and invented runs of them in which each value is one.
static PLANS: LazyLock<BTreeMap<String, Sweep>> = LazyLock::new(|| plans(&TempDir::new().unwrap(), false));
static ONES: LazyLock<Runs> = LazyLock::new(|| made_up(&PLANS, |_, _, _| Some(1.0)));

/// Everything that an experiment reads, with its description.
fn terms(experiment: &Experiment) -> Vec<(&str, &Term)> {
    let of_lines =
        experiment.lines.iter().flat_map(|line| line.ours.terms().into_iter().map(|term| (line.what.as_str(), term)));
    let of_charts = experiment.charts.iter().flat_map(|chart| {
        let terms = chart.lines.iter().flat_map(|line| &line.points);
        let with_across = terms.flat_map(|(across, term)| match across {
            Across::Setting(_) => vec![term],
            Across::Measured(measured) => vec![measured, term],
        });
        with_across.map(|term| (chart.name.as_str(), term))
    });
    let of_claims = experiment
        .claims
        .iter()
        .flat_map(|claim| claim.check.terms().into_iter().map(|term| (claim.text.as_str(), term)));
    of_lines.chain(of_charts).chain(of_claims).collect()
}

/// Invented runs: `value` gives each value of each cell, and replicates differ slightly.
fn made_up(plans: &BTreeMap<String, Sweep>, value: impl Fn(&str, usize, &Measure) -> Option<f64>) -> Runs {
    let mut runs = Runs::new(std::path::PathBuf::new(), RunCounts::Each(RUNS), None);
    for (scenario, plan) in plans {
        let mut rows = Vec::new();
        for cell in 0..plan.cells().len() {
            let values: Vec<Option<f64>> =
                plan.measures().iter().map(|measure| value(scenario, cell, measure)).collect();
            rows.extend((0..plan.runs()).map(|replicate| {
                let scatter = 1.0 + 1e-6 * f64::from(replicate);
                let outcome = Ok(values.iter().map(|value| Some(scatter * (*value)?)).collect());
                RunRow { cell, replicate, outcome }
            }));
        }
        runs.insert(Variant::shipped(scenario), (plan.clone(), rows));
    }
    runs
}

#[test]
fn every_experiment_has_a_unique_id_and_reads_shipped_scenarios() {
    let experiments = experiments();
    for (i, experiment) in experiments.iter().enumerate() {
        assert!(experiments[..i].iter().all(|other| other.id != experiment.id), "{}", experiment.id);
        let scenarios = experiment.scenarios();
        for scenario in &scenarios {
            assert!(SHIPPED.iter().any(|(name, _)| name == scenario), "{scenario}");
        }
        for (what, term) in terms(experiment) {
            assert!(scenarios.contains(&term.variant.scenario.as_str()), "`{what}` reads {}", term.variant.scenario);
        }
    }
}

#[test]
fn experiments_that_share_a_scenario_have_the_same_usual_number_of_runs() {
    let mut runs: BTreeMap<String, (NonZeroU32, String)> = BTreeMap::new();
    for experiment in experiments() {
        for scenario in experiment.scenarios() {
            let (usual, id) =
                runs.entry(scenario.to_owned()).or_insert_with(|| (experiment.runs, experiment.id.clone()));
            assert_eq!(*usual, experiment.runs, "{scenario}: {id} and {}", experiment.id);
        }
    }
}

#[test]
fn times_are_those_of_scenarios_that_are_run_and_published_numbers_have_a_verdict() {
    let experiments = experiments();
    let scenarios: Vec<&str> = experiments.iter().flat_map(Experiment::scenarios).collect();
    for (scenario, run_s) in Costs::measured().all() {
        assert!(scenarios.contains(&scenario) && run_s > 0.0, "{scenario}: {run_s} s");
    }
    for line in experiments.iter().flat_map(|experiment| experiment.lines(&ONES)) {
        assert_eq!(line.verdict().is_some(), line.published.is_some(), "{}: {:?}", line.what, line.published);
    }
}

#[test]
fn everything_that_an_experiment_reads_exists_in_its_scenario() {
    for experiment in experiments() {
        for (what, term) in terms(&experiment) {
            let column = term.measure.column();
            let columns = PLANS[&term.variant.scenario].columns();
            assert!(columns.iter().any(|other| other.name == column), "`{what}` reads {column}");
            assert_eq!(
                ONES.values(term).len(),
                PLANS[&term.variant.scenario].runs() as usize,
                "`{what}` reads {column} in {term:?}"
            );
        }
        for line in experiment.lines(&ONES) {
            assert_ne!(line.ours, Ours::Missing, "{}", line.what);
        }
    }
}

#[test]
fn every_reading_can_be_run_and_has_what_published_values_read() {
    let folder = TempDir::new().unwrap();
    write_scenarios(folder.path()).unwrap();
    let mut plans: BTreeMap<Variant, Sweep> = BTreeMap::new();
    for experiment in experiments() {
        for reading in experiment.readings.iter().filter(|reading| reading.choices.len() == 1) {
            let stated = experiment.lines.iter().zip(&reading.lines).filter(|(line, _)| line.published.is_some());
            let claims = experiment.claims.iter().zip(&reading.checks).filter(|(claim, _)| claim.published.is_some());
            let own = stated.clone().flat_map(|(line, _)| line.ours.terms());
            let own: Vec<_> = own.chain(claims.clone().flat_map(|(claim, _)| claim.check.terms())).collect();
            let terms = stated.flat_map(|(_, ours)| ours.terms()).chain(claims.flat_map(|(_, check)| check.terms()));
            let terms: Vec<_> = terms.collect();
            assert_ne!(terms, own, "{}: `{}` changes no published value", experiment.id, reading.name());
            for term in terms {
                let plan = plans.entry(term.variant.clone()).or_insert_with(|| {
                    let Variant { scenario, set, .. } = &term.variant;
                    Sweep::read(&folder.path().join(scenario), set, None, Some(NonZeroU32::MIN))
                        .unwrap_or_else(|errors| panic!("{} `{}`: {errors:?}", experiment.id, reading.name()))
                });
                let column = term.measure.column();
                assert!(plan.columns().iter().any(|other| other.name == column), "`{}`: {column}", reading.name());
                let has_cell = (0..plan.cells().len()).any(|cell| {
                    let values = plan.values(cell);
                    term.settings.iter().all(|(key, wanted)| {
                        plan.keys().iter().zip(&values).any(|(column, value)| column.name == *key && value == wanted)
                    })
                });
                assert!(has_cell, "{}: `{}` has no cell {:?}", experiment.id, reading.name(), term.settings);
            }
        }
    }
}

#[test]
fn no_two_runs_have_the_same_table() {
    let mut tables: BTreeMap<String, Variant> = BTreeMap::new();
    for experiment in experiments() {
        for variant in experiment.shipped().into_iter().chain(experiment.of_readings()) {
            let name = variant.table_name();
            assert!(name.len() < 200, "{name}");
            let known = tables.entry(name).or_insert_with(|| variant.clone());
            assert_eq!(*known, variant, "{}", experiment.id);
        }
    }
}

#[test]
fn the_neighbourhood_in_a_description_is_that_of_the_scenario() {
    let folder = TempDir::new().unwrap();
    write_scenarios(folder.path()).unwrap();
    let mut count = 0;
    for experiment in experiments() {
        for (what, term) in terms(&experiment) {
            let at = ["neighbourhood of ", "within "].iter().find_map(|mark| what.split_once(mark));
            let Some(radius_m) = at.and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok()) else {
                continue;
            };
            let scenario = Scenario::load(folder.path().join(&term.variant.scenario)).unwrap();
            let column = term.measure.column();
            let index = match column.split_once("connectivity_errors.") {
                Some((_, rest)) => rest[..1].parse().unwrap(),
                None => 0,
            };
            let found_m = scenario.metrics().neighbourhood_m[index];
            assert!((found_m - radius_m).abs() < 1e-9, "`{what}` reads {column} within {found_m} m");
            count += 1;
        }
    }
    assert!(count > 50, "{count} names with a neighbourhood");
}

#[test]
fn published_connectivity_errors_are_only_given_for_the_radius_of_communication() {
    let folder = TempDir::new().unwrap();
    write_scenarios(folder.path()).unwrap();
    for experiment in experiments() {
        for Quantity { what, ours, published, .. } in &experiment.lines {
            let Some((_, rest)) = what.split_once("neighbourhood of ") else { continue };
            let terms = ours.terms();
            let (Some(published), [term, ..]) = (published, terms.as_slice()) else { continue };
            let scenario = Scenario::load(folder.path().join(&term.variant.scenario)).unwrap();
            let radius_m = scenario.config().channel.max_range_m.unwrap();
            assert_eq!(rest, format!("{radius_m} m"), "{what}: {published:?}");
        }
    }
}

#[test]
fn every_conclusion_can_hold_or_not() {
    for experiment in experiments() {
        for claim in &experiment.claims {
            let terms = claim.check.terms();
            let mut verdicts = Vec::new();
            let missing = |verdicts: &[Verdict]| {
                [Verdict::Holds, Verdict::DoesNotHold].into_iter().find(|verdict| !verdicts.contains(verdict))
            };
            let is_read = |scenario: &str| terms.iter().any(|term| term.variant.scenario == scenario);
            let read = PLANS.iter().filter(|(scenario, _)| is_read(scenario));
            let read: BTreeMap<_, _> = read.map(|(scenario, plan)| (scenario.clone(), plan.clone())).collect();
            // The values of the terms rise, fall or are equal, at several sizes.
            for step in [1.3, 1.0 / 1.3, 1.0, 2.0, 0.5, 100.0] {
                for size in [0.5, 0.01, 100.0, 0.05, 0.95, 10.0] {
                    if missing(&verdicts).is_none() {
                        continue;
                    }
                    let runs = made_up(&read, |scenario, cell, measure| {
                        let is_of_cell = |term: &Term| {
                            let values = PLANS[scenario].values(cell);
                            PLANS[scenario].keys().iter().zip(&values).all(|(key, value)| {
                                term.settings.iter().any(|(name, wanted)| *name == key.name && wanted == value)
                            })
                        };
                        let is_it = |term: &&Term| {
                            term.variant.scenario == scenario && term.measure == *measure && is_of_cell(term)
                        };
                        let at = terms.iter().position(is_it)?;
                        Some(size * f64::powi(step, i32::try_from(at).unwrap()))
                    });
                    verdicts.push(
                        claim
                            .finding(&runs)
                            .unwrap_or_else(|| panic!("`{}`: a term has no value", claim.text))
                            .verdict,
                    );
                }
            }
            if let Some(verdict) = missing(&verdicts) {
                panic!("`{}` never {}", claim.text, verdict.words());
            }
        }
    }
}

/// A picture is drawn with the figures of a scenario that its experiment runs, and shows a map or an application of that.
#[test]
fn every_picture_shows_what_its_scenario_has() {
    let folder = TempDir::new().unwrap();
    write_scenarios(folder.path()).unwrap();
    let mut shown = 0;
    for experiment in experiments() {
        let scenarios = experiment.scenarios();
        for picture in &experiment.pictures {
            let of = format!("{}: {picture:?}", experiment.id);
            assert!(scenarios.contains(&picture.scenario.as_str()), "{of} is of no run");
            let scenario = Scenario::load(folder.path().join(&picture.scenario)).unwrap();
            let maps = scenario.maps().iter().map(|map| &map.name).chain(scenario.distributed().map(|map| &map.name));
            let maps = maps.map(|name| format!("map-{name}"));
            let searches = scenario.missions().iter().map(|mission| format!("application-{}", mission.name));
            let mut figures = maps.chain(searches).chain(["network".to_owned()]);
            assert!(figures.any(|figure| figure == picture.figure), "{of}");
            shown += 1;
        }
    }
    assert!(shown > 30, "{shown} pictures");
}

#[test]
fn a_published_value_names_its_source() {
    for experiment in experiments() {
        let of_lines = experiment.lines.iter().map(|line| (&line.what, &line.published));
        let of_claims = experiment.claims.iter().map(|claim| (&claim.text, &claim.published));
        for (what, published) in of_lines.chain(of_claims) {
            let Some(Published { value, source }) = published else { continue };
            let (kind, number) = source.split_once(' ').expect("`table 3.6`");
            let chapter = number.split_once('.').map(|(chapter, _)| chapter);
            assert!(["table", "figure", "section"].contains(&kind), "{source}");
            assert!(chapter.is_some_and(|chapter| ["3", "4", "5", "6", "7"].contains(&chapter)), "{source}");
            assert!(!value.is_empty(), "{what}");
        }
    }
}

#[test]
fn a_tiny_run_has_a_value_for_each_line_and_a_verdict_for_each_conclusion() {
    let folder = TempDir::new().unwrap();
    let plans = plans(&folder, true);
    let (names, plans): (Vec<_>, Vec<_>) = plans.into_iter().unzip();
    let (rows, outcome) = sweep::rows(&plans, &Unwatched);
    outcome.unwrap();
    let mut runs = Runs::new(std::path::PathBuf::new(), RunCounts::Each(TINY_RUNS), None);
    for (name, made) in names.into_iter().zip(plans.into_iter().zip(rows)) {
        runs.insert(Variant::shipped(&name), made);
    }
    assert_eq!(runs.failures(), [""; 0]);
    for experiment in experiments() {
        for line in experiment.lines(&runs).into_iter().chain(experiment.conclusions(&runs)) {
            assert_ne!(line.ours, Ours::Missing, "{} {}", experiment.id, line.what);
        }
        write_figures(&experiment, &runs, folder.path()).unwrap();
        for chart in &experiment.charts {
            assert!(folder.path().join(format!("{}.svg", chart.name)).exists(), "{}", chart.name);
        }
    }
}
