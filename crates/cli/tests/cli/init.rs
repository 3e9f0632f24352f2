//! `sextant init`: each template does what its head promises.

use std::path::Path;

use assert_cmd::assert::Assert;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use sextant::scenario::Scenario;
use sextant::template::Template;
use sextant_kernel::Unwatched;

use crate::program::summary;

fn sextant(folder: &Path, words: &[&str]) -> Assert {
    cargo_bin_cmd!("sextant").current_dir(folder).args(words).assert()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("there is room")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// Writes a template, checks it and runs it: the summary.
fn run(template: &str) -> Value {
    run_in(folder().path(), template, &[])
}

/// The same in a folder of the test, with these words behind the command that runs it.
fn run_in(folder: &Path, template: &str, words: &[&str]) -> Value {
    sextant(folder, &["init", template]).success();
    let file = format!("{template}.toml");
    let checked = sextant(folder, &["check", &file]).success();
    assert_eq!(text(&checked.get_output().stderr), "", "{template}");
    sextant(folder, &[&["run", &file, "--summary", "summary.json", "--quiet"], words].concat()).success();
    summary(&folder.join("summary.json"))
}

fn mean_error_m(map: &Value) -> f64 {
    map["position_error_m"]["mean"].as_f64().expect("the true places are known")
}

#[test]
fn the_survey_maps_all_nodes_better_than_a_centroid() {
    let summary = run("survey");
    let maps = summary["maps"].as_array().expect("maps");
    assert_eq!((maps.len(), &maps[0]["mapped"]), (2, &Value::from(36)));
    assert!(mean_error_m(&maps[0]) < 1.0 && mean_error_m(&maps[0]) < mean_error_m(&maps[1]));
}

#[test]
fn ranges_map_all_nodes_to_a_few_centimetres_and_the_recording_and_its_tables_give_the_same_map() {
    let folder = folder();
    let words = ["--set", "recording.map_snapshots=0", "--out", "run.mcap"];
    let summary = run_in(folder.path(), "ranges", &words);
    let map = &summary["maps"][0];
    let bound_m = map["posterior_bound_m"].as_f64().expect("a bound");
    assert_eq!((&map["mapped"], &map["coverage_95"]), (&Value::from(16), &Value::from(1.0)));
    assert!(bound_m > 0.005 && mean_error_m(map) > bound_m && mean_error_m(map) < 0.05, "{bound_m}: {map}");
    assert!(summary["gathering"]["ranges"].as_u64().expect("a count") > 5000);

    let printed = |words: &[&str]| -> Value {
        let printed = sextant(folder.path(), &[words, &["--format", "json"]].concat()).success();
        serde_json::from_slice(&printed.get_output().stdout).expect("JSON")
    };
    sextant(folder.path(), &["export", "run.mcap", "--out", "tables"]).success();
    let known = "tables/nodes.csv";
    let from_recording = printed(&["map", "run.mcap", "--algorithm", "range-ml"]);
    let from_tables = printed(&["map", "tables", "--algorithm", "range-ml", "--truth", known]);
    let law = |summary: &Value| summary["maps"][0]["range_law"].clone();
    assert!(law(&summary)["bias_m"].as_f64().is_some_and(|bias_m| (bias_m - 0.3).abs() < 0.1));
    assert_eq!(law(&summary), law(&from_recording));
    assert_eq!(law(&summary), law(&from_tables));
    let errors = |summary: &Value| summary["maps"][0]["position_error_m"].clone();
    assert_eq!(errors(&from_recording), errors(&from_tables));

    // The track of the robot.
    let track = printed(&["map", "run.mcap", "--track", "--known", known, "--out", "track.csv"])["tracks"][0].clone();
    assert_eq!((&track["tag"], &track["receivers"]), (&Value::from("surveyor"), &Value::from(16)));
    let length_m = track["length_m"].as_f64().expect("a length");
    assert!((length_m - 140.0).abs() < 6.0, "{length_m}");
}

#[test]
fn the_robot_looks_into_five_rooms_of_the_building() {
    let summary = run("building");
    let maps = summary["maps"].as_array().expect("maps");
    assert_eq!((&maps[0]["mapped"], &summary["gathering"]["stops"]), (&Value::from(18), &Value::from(37)));
    assert!(mean_error_m(&maps[0]) < 3.0 && mean_error_m(&maps[0]) < mean_error_m(&maps[1]));
}

#[test]
fn the_study_of_channel_access_delivers_most_packets() {
    let summary = run("mac");
    assert!(summary["mac"]["prr"].as_f64().expect("a share") > 0.98);
    assert!(summary["mac"]["retries"].as_u64().expect("a count") > 0);
}

#[test]
fn the_tree_of_the_network_delivers_repairs_itself_and_has_its_pictures() {
    let summary = run("network");
    let routing = &summary["routing"];
    assert!(routing["delivery"].as_f64().expect("a share") > 0.98, "{routing}");
    assert!(
        routing["depth"].as_u64().expect("hops") >= 2 && routing["parent_changes"].as_u64().expect("a count") > 5
    );
    let battery = &summary["battery"];
    assert!(battery["depleted"].as_u64().expect("a count") > 5 && battery["half_death_s"].is_number(), "{battery}");
    let folder = folder();
    sextant(folder.path(), &["init", "network"]).success();
    sextant(folder.path(), &["run", "network.toml", "--out", "network.mcap", "--quiet"]).success();
    let drawn = sextant(folder.path(), &["figure", "network.mcap", "--out", "pictures"]).success();
    let drawn = text(&drawn.get_output().stdout);
    for picture in ["tree.svg", "tree-changes.svg", "time-line.svg"] {
        assert!(drawn.contains(picture), "{picture} in {drawn}");
    }
}

/// The text of the template `network` without the tables that begin with `without`, and with the marked settings that begin
/// with `with`, and what follows them.
fn varied(without: &[&str], with: &[&str]) -> String {
    let begins = |line: &str, words: &[&str]| words.iter().any(|word| line.starts_with(word));
    let template = Template::named("network").and_then(Template::scenario).expect("a template");
    let (mut leaves_out, mut takes) = (false, false);
    let mut lines = Vec::new();
    for line in template.text.lines() {
        if let Some(setting) = line.strip_prefix("#: ") {
            takes = begins(setting, with) || takes && !setting.starts_with('[');
            leaves_out = false;
            lines.push(if takes { setting } else { line });
            continue;
        }
        takes = false;
        leaves_out = begins(line, without) || leaves_out && !line.is_empty() && !line.starts_with(['[', '#']);
        if !leaves_out {
            lines.push(line);
        }
    }
    lines.join("\n")
}

#[test]
fn each_marked_setting_of_the_network_is_another_network() {
    let run = |without: &[&str], with: &[&str]| {
        let scenario = Scenario::parse(&varied(without, with)).expect("a good scenario");
        sextant::run(&scenario, &mut (), &Unwatched).expect("it runs").summary().clone()
    };
    let (csma, collection) = ("[mac.csma_unslotted]", "[routing.tree.collection]");
    let delivery = |summary: &sextant::Summary| summary.routing.as_ref().and_then(|routing| routing.delivery);
    let slots = run(&[csma], &["[mac.tsch"]);
    assert!(
        slots
            .mac
            .as_ref()
            .and_then(|mac| mac.slots.as_ref())
            .is_some_and(|slots| slots.duty_cycle.is_some_and(|share| share < 0.05))
    );
    assert!(delivery(&slots).is_some_and(|share| share > 0.98));
    let asleep = run(&[csma, collection], &["[mac.sleep", "[routing.tree.shortest"]);
    assert!(
        asleep
            .mac
            .as_ref()
            .and_then(|mac| mac.sleep.as_ref())
            .is_some_and(|sleep| sleep.duty_cycle.is_some_and(|share| share < 0.02))
    );
    assert!(delivery(&asleep).is_some_and(|share| share > 0.98));
    let still = run(&[], &[]);
    let changes = |summary: &sextant::Summary| summary.routing.as_ref().map_or(0, |routing| routing.parent_changes);
    for with in [&["fading ="][..], &["[[world.motions", "[world.motions"]] {
        assert!(changes(&run(&[], with)) > 3 * changes(&still), "{with:?}");
    }
}

#[test]
fn the_survey_by_sectors_maps_all_nodes_within_half_a_metre() {
    let summary = run("mmwave");
    assert_eq!(summary["maps"][0]["mapped"], 40);
    assert!(mean_error_m(&summary["maps"][0]) < 0.5);
}

#[test]
fn the_nodes_of_the_distributed_template_all_find_their_places() {
    let summary = run("distributed");
    assert_eq!(summary["maps"][0]["mapped"], 60);
    assert!(mean_error_m(&summary["maps"][0]) < 2.0);
}

#[test]
fn the_target_of_the_search_is_captured() {
    assert_eq!(run("search")["applications"][0]["captured"], true);
}

#[test]
fn both_laws_of_the_seek_template_reach_the_source() {
    let summary = run("seek");
    let applications = summary["applications"].as_array().expect("applications");
    assert_eq!(applications.iter().filter(|application| application["arrived"] == true).count(), 2);
}

#[test]
fn each_obstacle_of_a_template_takes_power_from_a_link() {
    let mut count = 0;
    for template in Template::all() {
        let Some(file) = template.scenario() else { continue };
        let scenario = Scenario::parse(file.text).expect("a good scenario");
        let world = scenario.world();
        let nodes = || world.nodes.iter().map(|node| node.position);
        let obstacles = world.obstacles.obstacles();
        let pieces_of_walls: usize = world.walls.iter().map(ExactSizeIterator::len).sum();
        let alone = world.obstacles_alone();
        let others = obstacles[..alone].iter().chain(&obstacles[alone + pieces_of_walls..]);
        for (i, obstacle) in others.enumerate() {
            let is_crossed = nodes().any(|a| nodes().any(|b| obstacle.shape().length_inside_m(a, b) > 0.3));
            assert!(is_crossed, "{}: obstacle {i} is between no two nodes", template.name);
            count += 1;
        }
    }
    assert_eq!(count, 4, "obstacles of templates");
}

#[test]
fn the_log_is_mapped_at_once_and_is_what_its_readme_says() {
    let folder = folder();
    sextant(folder.path(), &["init", "log"]).success();
    let map =
        ["map", "log", "--truth", "log/nodes.csv", "--algorithm", "link-model", "--summary", "map.json", "--quiet"];
    sextant(folder.path(), &map).success();
    let map = summary(&folder.path().join("map.json"));
    assert_eq!(map["maps"][0]["mapped"], 12);
    assert!(mean_error_m(&map["maps"][0]) < 0.5);

    let survey = Template::named("survey").and_then(Template::scenario).expect("a template");
    let mut scenario = Scenario::parse(survey.text).expect("a good scenario");
    for (key, value) in [
        ("seed", "7"),
        ("world.nodes.lattice.count", "12"),
        ("world.nodes.lattice.spacing_m", "3.0"),
        ("robots.0.controller.s_path.lane_spacing_m", "4.0"),
        ("channel.obstacles_attenuate", "false"),
    ] {
        scenario = scenario.with(key, value).expect("a good setting");
    }
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("it runs");
    let simulated = run.survey().expect("a robot surveys");
    let log = simulated.logs.first();
    let rows = |name: &str| {
        let text = std::fs::read_to_string(folder.path().join("log").join(name)).expect("a file of the template");
        text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (stops, nodes, receptions) = (rows("stops.csv"), rows("nodes.csv"), rows("receptions.csv"));
    let near = |written: &str, value: f64| {
        let written: f64 = written.parse().expect("a number");
        assert!((written - value).abs() < 6e-4, "{written}, not {value}");
    };
    assert_eq!((stops.len(), nodes.len()), (log.stops().len(), scenario.world().nodes.len()));
    for (row, stop) in stops.iter().zip(log.stops()) {
        near(&row[2], stop.position.x_m);
        near(&row[3], stop.position.y_m);
    }
    for (row, node) in nodes.iter().zip(&scenario.world().nodes) {
        assert_eq!(row[0], node.name);
        near(&row[1], node.position.x_m);
        near(&row[2], node.position.y_m);
    }
    let received: u64 = receptions.iter().map(|row| row[2].parse::<u64>().expect("a count")).sum();
    assert_eq!(
        received,
        simulated.robots.iter().flat_map(|robot| &robot.packets).map(|packets| u64::from(*packets)).sum::<u64>()
    );
}

#[test]
fn the_tag_is_tracked_by_the_one_command_that_is_told_and_its_files_are_those_of_its_scenario() {
    let folder = folder();
    let told = sextant(folder.path(), &["init", "track"]).success();
    let told = text(&told.get_output().stdout);
    let command = told.lines().find_map(|line| line.trim().strip_prefix("sextant ")).expect("a command");
    let words: Vec<&str> = command.split(' ').chain(["--summary", "track.json", "--quiet"]).collect();
    sextant(folder.path(), &words).success();
    let track = summary(&folder.path().join("track.json"))["tracks"][0].clone();
    let number = |key: &str| track[key].as_f64().expect("a number");
    assert!(number("position_rmse_m") < 0.3 && number("in_region_95") > 0.85, "{track}");
    assert_eq!((&track["receivers"], &track["is_among_receivers"]), (&Value::from(6), &Value::from(true)));

    let scenario = Scenario::load(folder.path().join("track/track.toml")).expect("a good scenario");
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("it runs");
    let log = run.survey().expect("a robot surveys").logs.first();
    let written = std::fs::read_to_string(folder.path().join("track/ranges.csv")).expect("a file of the template");
    let mut simulated: Vec<(String, String)> = (log.ranges().iter())
        .map(|range| (log.names()[range.node.index()].clone(), format!("{:.3}", range.range_m)))
        .collect();
    let mut of_file: Vec<(String, String)> = (written.lines().skip(1))
        .map(|row| row.split(',').collect::<Vec<_>>())
        .map(|row| (row[1].to_owned(), format!("{:.3}", row[2].parse::<f64>().expect("a number"))))
        .collect();
    simulated.sort_unstable();
    of_file.sort_unstable();
    assert_eq!(of_file, simulated);
}

#[test]
fn a_scenario_is_printed_or_named_and_its_commands_name_its_file() {
    let folder = folder();
    let printed = sextant(folder.path(), &["init", "mac", "--out", "-"]).success();
    assert_eq!(text(&printed.get_output().stdout), Template::named("mac").expect("a template").files[0].text);
    let told = sextant(folder.path(), &["init", "mac", "--out", "mine.toml"]).success();
    assert!(text(&told.get_output().stdout).contains("sextant run mine.toml --out mine.mcap"));
    let written = std::fs::read_to_string(folder.path().join("mine.toml")).expect("it was written");
    assert!(written.contains("sextant run mine.toml --out mine.mcap") && !written.contains("mac.toml"));
    let listed = sextant(folder.path(), &["init", "--list"]).success();
    let listed = text(&listed.get_output().stdout);
    assert!(Template::all().iter().all(|template| listed.contains(template.summary)));
}

#[test]
fn nothing_is_overwritten_and_folders_and_unknown_templates_are_refused() {
    let folder = folder();
    let refused = |words: &[&str], why: &str| {
        let refused = sextant(folder.path(), words).failure();
        let told = text(&refused.get_output().stderr);
        assert!(told.contains(why), "{words:?}: {told}");
        refused.get_output().status.code()
    };
    std::fs::write(folder.path().join("survey.toml"), "mine").expect("there is room");
    std::fs::create_dir(folder.path().join("full")).expect("there is room");
    std::fs::write(folder.path().join("full/notes"), "mine").expect("there is room");
    assert_eq!(refused(&["init"], "nothing is overwritten"), Some(2));
    assert_eq!(refused(&["init", "--out", "full"], "--out full/survey.toml"), Some(2));
    assert_eq!(refused(&["init", "log", "--out", "full"], "`full` exists"), Some(2));
    assert_eq!(refused(&["init", "log", "--out", "-"], "is a folder"), Some(2));
    assert_eq!(refused(&["init", "nothing"], "distributed"), Some(2));
    assert_eq!(refused(&["init", "--out", "no/such/a.toml"], "`no/such/a.toml` cannot be written"), Some(1));
    assert_eq!(std::fs::read_to_string(folder.path().join("survey.toml")).expect("it is there"), "mine");
}
