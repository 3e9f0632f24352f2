//! `sextant report`: where the file goes, what is said, and what is refused.

use std::fs;

use super::program::{Said, call, scenario};

#[test]
fn a_report_of_a_run_is_written_in_the_working_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let smoke = scenario("smoke.toml");
    let smoke = smoke.to_str().expect("UTF-8");
    assert!(call(folder.path(), &["run", smoke, "--out", "a.mcap", "--quiet"]).status.success());
    let told = call(folder.path(), &["report", "a.mcap"]).printed();
    let html = fs::read_to_string(folder.path().join("a.html")).expect("a report");
    assert_eq!(told, format!("a.html ({} kB)\n", html.len().div_ceil(1000)));
    assert!(html.starts_with("<!DOCTYPE html>") && html.contains("<title>smoke"));
    assert!(html.len() < 5_000_000);

    call(folder.path(), &["report", "a.mcap", "--algorithm", "auto", "--out", "b.html", "--quiet"]).printed();
    call(folder.path(), &["report", "a.mcap", "--out", "c.html"]).printed();
    assert_eq!(fs::read_to_string(folder.path().join("c.html")).expect("a report"), html, "the same bytes");
}

#[test]
fn a_report_of_a_log_has_its_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("walk");
    fs::create_dir(&log).expect("room");
    let stops: String = (0..9).map(|i| format!("{i},{i},{},{}\n", i % 3, i / 3)).collect();
    fs::write(log.join("stops.csv"), format!("stop,t_s,x_m,y_m\n{stops}")).expect("room");
    fs::write(log.join("receptions.csv"), "node,stop,received,sent\nlamp,4,9,10\nlamp,3,5,10\nlamp,5,5,10\n")
        .expect("room");
    call(folder.path(), &["report", "walk", "--algorithm", "packet-centroid"]).printed();
    let html = fs::read_to_string(folder.path().join("walk.html")).expect("a report");
    assert!(html.contains("Map of a log") && html.contains("<title>walk"));
}

#[test]
fn what_is_not_an_input_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content, said) in [
        ("other.csv", "a,b\n1,2\n", "is no table that a report can show"),
        ("table.parquet", "PAR1", "is a Parquet table"),
        ("text.mcap", "no recording at all", "but a text that begins with `no recording at all`"),
    ] {
        fs::write(folder.path().join(name), content).expect("room");
        let told = call(folder.path(), &["report", name]).refusal();
        assert!(told.contains(said), "{told}");
    }
    assert_eq!(call(folder.path(), &["report", "absent.mcap"]).status.code(), Some(2));
    let left = fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 3, "no report is left behind");
}
