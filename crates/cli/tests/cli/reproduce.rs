//! `sextant reproduce` from end to end.

use std::process::Output;

use tempfile::TempDir;

#[cfg(unix)]
use crate::program::signal;
use crate::program::{Said, sextant};

fn reproduce(arguments: &[&str], folder: &TempDir) -> Output {
    sextant().current_dir(folder.path()).arg("reproduce").args(arguments).output().expect("it starts")
}

#[test]
fn the_list_names_each_experiment() {
    let folder = TempDir::new().unwrap();
    let text = reproduce(&["--list"], &folder).printed();
    for experiment in sextant_thesis::experiments() {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(experiment.id.as_str()));
        let line = line.unwrap_or_else(|| panic!("{} is missing in:\n{text}", experiment.id));
        assert!(line.contains(&experiment.title), "{line}");
        let mut rest = line[line.find(&experiment.title).unwrap() + experiment.title.len()..].split_whitespace();
        assert_eq!(rest.next(), Some(experiment.runs.to_string().as_str()), "{line}");
    }
    assert!(text.lines().any(|line| line.starts_with("all: ") && line.contains("of CPU time")), "{text}");
}

#[test]
fn an_experiment_writes_its_table_and_the_scenarios() {
    let folder = TempDir::new().unwrap();
    let json = reproduce(&["3.2", "--out", "here", "--quiet", "--format", "json"], &folder).json();
    let lines = &json["reproduction"]["experiments"][0]["lines"];
    assert_eq!(lines.as_array().unwrap().len(), 4);
    assert_eq!((&lines[2]["published"], &lines[2]["source"]), (&"0.3708".into(), &"table 3.2".into()));
    let out = folder.path().join("here");
    let table = std::fs::read_to_string(out.join("3.2.csv")).unwrap();
    assert!(table.starts_with("what,published,unit,mean,half_width_95,runs,result,source,verdict\n"), "{table}");
    for (name, text) in sextant_thesis::SHIPPED {
        assert_eq!(std::fs::read_to_string(out.join("scenarios").join(name)).unwrap(), *text);
    }
}

#[test]
fn pages_have_the_verdicts_of_conclusions_and_numbers() {
    let folder = TempDir::new().unwrap();
    let printed = reproduce(&["3.2", "3.3", "--runs", "2", "--out", "here", "--quiet"], &folder).printed();
    assert!(printed.lines().any(|line| line.starts_with("chapter 3  ")), "{printed}");
    let read = |folder_name: &str, name: &str| {
        std::fs::read_to_string(folder.path().join(folder_name).join(name)).unwrap_or_else(|_| panic!("{name}"))
    };
    let chapter = read("here", "chapter-3.md");
    assert!(chapter.contains("| P of node p at (4, 2) | 0 | table 3.2 | 0.0000 |  | within interval |"), "{chapter}");
    assert!(read("here", "index.md").contains("`sextant reproduce 3.6`"), "what is left out has its command");
    assert!(read("here", "chapter-3.html").contains("<td>within interval</td>"));
    let json: serde_json::Value = serde_json::from_str(&read("here", "reproduction.json")).unwrap();
    let verdicts = &json["reproduction"]["verdicts"][0];
    assert_eq!((&verdicts["of"], &verdicts["numbers"]["within interval"].is_u64()), (&"chapter 3".into(), &true));
    // The same from the recorded runs; an experiment without runs is left out.
    let again = reproduce(&["3.2", "3.3", "3.6", "--from", "here", "--out", "there"], &folder);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert!(String::from_utf8_lossy(&again.stderr).contains("3.6: left out"), "{again:?}");
    for name in ["3.3.csv", "chapter-3.md", "reproduction.json"] {
        assert_eq!(read("here", name), read("there", name), "{name}");
    }
}

/// Cheap parts of the results in the guide, made again: no run, and a robot in a room. With `SEXTANT_RESULTS=all`, as `.ci/release`
/// sets it, four paths too.
#[test]
fn the_committed_results_are_what_the_program_computes() {
    let folder = TempDir::new().unwrap();
    let mut parts = vec![("3.2", "verdict"), ("7.11", "verdict")];
    if std::env::var("SEXTANT_RESULTS").is_ok_and(|wish| wish == "all") {
        parts.push(("3.3", "half_width_95"));
    }
    let ids: Vec<&str> = parts.iter().map(|(id, _)| *id).collect();
    reproduce(&[&ids[..], &["--out", "here", "--quiet"]].concat(), &folder).printed();
    let committed = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/results");
    for (id, kept) in parts {
        let read = |folder: &std::path::Path| std::fs::read_to_string(folder.join(format!("{id}.csv"))).unwrap();
        let (new, old) = (read(&folder.path().join("here")), read(&committed));
        // A verdict of 3.3 may name a reading, which was not run here.
        let cut = |table: &str| -> Vec<Vec<String>> {
            let rows = rows(table);
            let last = rows[0].iter().position(|name| name == kept).unwrap();
            rows.into_iter().map(|row| row[..=last].to_vec()).collect()
        };
        assert_eq!(cut(&new), cut(&old), "{id}");
    }
}

#[test]
fn the_page_on_how_far_the_thesis_holds_has_the_verdicts_of_the_results() {
    let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let read = |name: &str| std::fs::read_to_string(docs.join(name)).unwrap();
    let (page, index) = (read("how-far-the-thesis-holds.md"), read("results/index.md"));
    let verdicts = index.lines().find(|line| line.starts_with("| all chapters |")).unwrap();
    assert!(page.lines().any(|line| line == verdicts), "{verdicts} is not on the page");
}

#[test]
fn other_seeds_give_other_runs_and_are_known_to_the_folder() {
    let folder = TempDir::new().unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap_or_else(|_| panic!("{name}"));
    let seeds_of = |table: &str| -> Vec<String> {
        let table = read(table);
        table.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().to_owned()).collect()
    };
    let made = |arguments: &[&str]| {
        reproduce(&[&["3.3", "--quiet", "--format", "json"], arguments].concat(), &folder).printed();
    };
    made(&["--seeds", "5..7", "--out", "range"]);
    made(&["--seed", "5", "--runs", "2", "--out", "first"]);
    let table = "runs-ml-tm-trajectory-s.csv";
    assert_eq!(seeds_of(&format!("range/{table}")), ["5", "6"]);
    for name in [table, "3.3.csv", "index.md"] {
        assert_eq!(read(&format!("range/{name}")), read(&format!("first/{name}")), "{name}");
    }
    assert!(read("range/index.md").contains("the seeds 5, 6, .."));
    made(&["--from", "range", "--out", "again"]);
    assert_eq!(read("range/3.3.csv"), read("again/3.3.csv"));
    for (arguments, part) in [
        (&["3.3", "--seeds", "7..5"][..], "7..5"),
        (&["3.3", "--seeds", "1..3", "--runs", "2"], "--runs"),
        (&["3.3", "--seed", "1", "--from", "range"], "--from"),
        (&["3.3", "--readings", "--from", "range"], "--from"),
    ] {
        let output = reproduce(arguments, &folder);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(part), "{output:?}");
    }
}

/// The rows of a table, and their cells.
fn rows(table: &str) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(table.as_bytes());
    reader.records().map(|row| row.expect("a table").iter().map(str::to_owned).collect()).collect()
}

#[test]
fn readings_show_what_a_number_depends_on() {
    let folder = TempDir::new().unwrap();
    reproduce(&["3.3", "--readings", "--runs", "2", "--out", "here", "--quiet"], &folder).printed();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap_or_else(|_| panic!("{name}"));
    let page = read("here/chapter-3.md");
    assert!(page.contains("### What it depends on"), "{page}");
    assert!(page.contains("`robots.controller.random_walk.steps_per_turn`"), "{page}");
    let table = read("here/3.3-readings.csv");
    let is_sought =
        |row: &Vec<String>| row[0].starts_with("random walk: time") && row.concat().contains("after 5 steps");
    let cells = rows(&table).into_iter().find(is_sought).unwrap_or_else(|| panic!("{table}"));
    // The same mean as that of a sweep with this setting, and the difference of runs of the same seed.
    let mean_of = |table: &str| {
        let table = read(table);
        let column = table.lines().next().unwrap().split(',').position(|name| name == "path_length_m").unwrap();
        let values = table.lines().skip(1).map(|row| row.split(',').nth(column).unwrap().parse::<f64>().unwrap());
        let values: Vec<f64> = values.collect();
        assert_eq!(values.len(), 2);
        values.iter().sum::<f64>() / 2.0
    };
    let turning = mean_of("here/runs-ml-tm-trajectory-random--turns-of-the-random-walk-after-5-steps.csv");
    let taken = mean_of("here/runs-ml-tm-trajectory-random.csv");
    let number = |cell: usize| cells[cell].parse::<f64>().unwrap();
    assert!((number(4) - turning).abs() < 1e-9, "{cells:?}: {turning}");
    assert!((number(5) - (turning - taken)).abs() < 1e-9, "{cells:?}: {turning} and {taken}");
    // Runs of readings are read back, and only they give the part of the page.
    reproduce(&["3.3", "--from", "here", "--out", "there", "--quiet"], &folder).printed();
    assert_eq!(page, read("there/chapter-3.md"));
}

#[test]
fn an_unknown_id_is_rejected_with_a_list_of_ids() {
    let folder = TempDir::new().unwrap();
    let text = reproduce(&["9.9"], &folder).refusal();
    assert!(text.contains("`9.9`") && text.contains("3.6"), "{text}");
    assert_eq!(reproduce(&[], &folder).status.code(), Some(2), "an id is required");
    assert_eq!(reproduce(&["3.2", "--runs", "0"], &folder).status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn an_interrupted_reproduction_keeps_the_finished_experiments() {
    let folder = TempDir::new().unwrap();
    let mut command = sextant();
    // The second experiment has a thousand runs, so the interrupt comes before its end.
    command.current_dir(folder.path()).args(["reproduce", "3.2", "3.3", "--runs", "1000", "--out", "here"]);
    let mut child = command.spawn().expect("it starts");
    let out = folder.path().join("here");
    while !out.join("3.2.csv").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before its first experiment");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    // The runs of the second experiment begin as soon as the first is printed.
    std::thread::sleep(std::time::Duration::from_millis(500));
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    let (printed, notes) =
        (String::from_utf8_lossy(&output.stdout).into_owned(), String::from_utf8_lossy(&output.stderr).into_owned());
    assert_eq!(output.status.code(), Some(130), "{notes}");
    assert!(printed.contains("P of node p at (1, 3)"), "{printed}");
    assert!(notes.contains("3.3: 4000 runs of 4 scenarios, then"), "{notes}");
    assert!(notes.contains("1 of 2 experiments are done"), "{notes}");
    assert!(!out.join("3.3.csv").exists());
    let runs = std::fs::read_to_string(out.join("runs-ml-tm-trajectory-s.csv")).unwrap();
    let columns = runs.lines().next().expect("a header").split(',').count();
    assert!(runs.lines().all(|row| row.split(',').count() == columns), "{runs}");
    let rows = runs.lines().count() - 1;
    assert!(rows < 1000, "{rows} runs");
}
