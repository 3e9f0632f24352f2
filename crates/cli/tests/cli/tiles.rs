//! `sextant map --tiles`: the same maps as in one piece, and what is refused.

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Said, scenario, sextant, unwrapped};

/// A recording of a shipped scenario, in a folder of its own.
struct Recorded {
    folder: TempDir,
}

impl Recorded {
    fn of(name: &str) -> Self {
        let folder = TempDir::new().expect("there is room");
        let mut command = sextant();
        command.arg("run").arg(scenario(name)).arg("--out").arg(folder.path().join("run.mcap"));
        command.output().expect("it starts").printed();
        Self { folder }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Maps the recording with these words to `out`.
    fn map(&self, out: &str, words: &[&str]) -> Output {
        let mut command = sextant();
        command.arg("map").arg(self.file("run.mcap")).arg("--out").arg(self.file(out)).args(words);
        command.args(["--format", "json"]).output().expect("it starts")
    }

    /// The map file and the summary without its timing.
    fn mapped(&self, words: &[&str]) -> (String, Value) {
        let mut summary = self.map("map.csv", words).json();
        summary.as_object_mut().expect("an object").remove("timing");
        (std::fs::read_to_string(self.file("map.csv")).expect("a map"), summary)
    }

    /// Checks that the map with `words` is the same in one piece and in tiles.
    fn check(&self, tiles: &[&str], words: &[&str]) {
        let (map, summary) = self.mapped(words);
        assert!(map.lines().count() > 50, "{map}");
        for count in tiles {
            let (tiled, of_tiles) = self.mapped(&[words, &["--tiles", count]].concat());
            assert!(tiled == map, "{words:?} in {count} tiles: the map is another one");
            assert_eq!(of_tiles, summary, "{words:?} in {count} tiles");
        }
        assert_eq!(files(self.folder.path()), ["map.csv", "run.mcap"], "no temporary file remains");
    }

    /// The error of a map with these words, which leaves no file.
    fn refused(&self, words: &[&str]) -> String {
        let output = self.map("refused.csv", words);
        assert!(!output.status.success(), "{words:?}");
        let left = std::fs::read_dir(self.folder.path()).expect("a folder").count();
        assert_eq!(left, 1, "{words:?} left a file");
        unwrapped(&output.all().2)
    }
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A log of a robot: 80 nodes, of which each stop hears those near it, with a packet a row.
fn csv_log(folder: &Path, header: &str, row: impl Fn(usize, usize, f64) -> Option<String>) {
    let (mut stops, mut receptions) = ("stop,x_m,y_m\n".to_owned(), format!("{header}\n"));
    for stop in 0..144_usize {
        let [x_m, y_m] = [stop % 12, stop / 12].map(|lane| lane as f64 * 2.0);
        stops.push_str(&format!("s{stop},{x_m},{y_m}\n"));
        for node in 0..80_usize {
            let at = [node * 37 % 101, node * 53 % 97].map(|share| share as f64 * 0.22);
            let row = row(node, stop, f64::hypot(x_m - at[0], y_m - at[1]));
            receptions.push_str(&row.map(|row| format!("n{node},s{stop},{row}\n")).unwrap_or_default());
        }
    }
    std::fs::create_dir(folder).expect("there is room");
    std::fs::write(folder.join("stops.csv"), stops).expect("there is room");
    std::fs::write(folder.join("receptions.csv"), receptions).expect("there is room");
}

#[test]
fn tiles_of_the_log_of_a_robot_give_the_map_of_one_piece() {
    let folder = TempDir::new().expect("there is room");
    let draw = |node: usize, stop: usize| (node * 7919 + stop * 104_729) % 1009;
    let heard =
        |distance_m: f64, node, stop| distance_m < 5.0 && (draw(node, stop) as f64) < 900.0 - 150.0 * distance_m;
    csv_log(&folder.path().join("counts"), "node,stop,received,sent", |node, stop, distance_m| {
        heard(distance_m, node, stop).then(|| format!("{},4", 1 + draw(node, stop) % 4))
    });
    csv_log(&folder.path().join("strengths"), "node,stop,rssi_dbm", |node, stop, distance_m| {
        heard(distance_m, node, stop).then(|| format!("{:.1}", -50.0 - 6.0 * distance_m))
    });
    csv_log(&folder.path().join("received"), "node,stop,received", |node, stop, distance_m| {
        heard(distance_m, node, stop).then(|| (1 + draw(node, stop) % 3).to_string())
    });
    let profile = ["--profile", "trapezoid:p0=0.8,plateau_m=0,range_m=6"];
    for (log, words) in [
        ("counts", &profile[..]),
        ("strengths", &profile),
        ("received", &profile),
        ("counts", &["--algorithm", "ml-tm"]),
        ("strengths", &["--algorithm", "link-model"]),
    ] {
        let map = |words: &[&str]| {
            let mut command = sextant();
            command.arg("map").arg(folder.path().join(log)).arg("--out").arg(folder.path().join("map.csv"));
            let mut summary = command.args(words).args(["--format", "json"]).output().expect("it starts").json();
            // What is odd in a log is sought in one piece only.
            for key in ["timing", "notes"] {
                summary.as_object_mut().expect("an object").remove(key);
            }
            (std::fs::read_to_string(folder.path().join("map.csv")).expect("a map"), summary)
        };
        let whole = map(words);
        assert!(whole.0.lines().count() > 70, "{}", whole.0);
        assert!(map(&[words, &["--tiles", "3"]].concat()) == whole, "{log}, {words:?} in tiles");
    }
}

const POSTERIOR: &str = "maps.0.algorithm.ml_tm.estimate=posterior_mean";

#[test]
fn tiles_of_a_survey_among_obstacles_give_the_map_of_one_piece() {
    let run = Recorded::of("ml-tm/circular.toml");
    run.check(&["1", "9", "auto:61"], &[]);
    run.check(&["9"], &["--set", POSTERIOR]);
    // The profile is fitted to all tiles.
    run.check(&["9"], &["--profile", "fitted"]);
    run.check(&["5"], &["--algorithm", "packet-centroid"]);
}

#[test]
fn tiles_of_a_survey_in_space_give_the_map_of_one_piece() {
    let run = Recorded::of("ml-tm/sphere.toml");
    run.check(&["4"], &[]);
    run.check(&["4"], &["--set", POSTERIOR]);
}

#[test]
fn what_tiles_cannot_do_is_refused_and_leaves_nothing() {
    let run = Recorded::of("smoke.toml");
    for (words, parts) in [
        (&["--tiles", "0"][..], &["`0` is not a number of tiles", "allowed: 1 or more, `auto`"][..]),
        (&["--tiles", "5000"], &["5000 tiles are about", "less than the reach", "allowed: 1 to"]),
        (&["--tiles", "auto:1"], &["MB of memory", "free: 1 MB; no number of tiles fits"]),
        (
            &["--tiles", "2", "--algorithm", "self-calibrated"],
            &["`self-calibrated` cannot map tile by tile", "`packet-centroid`"],
        ),
        (&["--tiles", "2", "--figure", "pictures"], &["--figure"]),
    ] {
        let error = run.refused(words);
        for part in parts {
            assert!(error.contains(part), "{words:?}: {error}");
        }
    }
}

#[test]
fn tiles_are_made_of_receptions_and_not_of_ranges() {
    let folder = TempDir::new().expect("there is room");
    let log = folder.path().join("log");
    csv_log(&log, "node,stop,received,sent", |_, _, distance_m| (distance_m < 5.0).then(|| "2,4".to_owned()));
    std::fs::write(log.join("ranges.csv"), "node,stop,range_m\nn1,s1,2\nn1,s2,3\n").expect("there is room");
    let map = || {
        let words = ["--tiles", "2", "--profile", "trapezoid:p0=0.8,plateau_m=0,range_m=6", "--format", "json"];
        sextant().arg("map").arg(&log).args(words).output().expect("it starts")
    };
    let notes = map().json()["notes"].to_string();
    assert!(notes.contains("measured ranges are not used, because the log is mapped part by part"), "{notes}");
    std::fs::remove_file(log.join("receptions.csv")).expect("it is there");
    let refused = map().refusal();
    assert!(refused.contains("tiles are made of receptions") && refused.contains("receptions.csv"), "{refused}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_the_temporary_file_is_an_error_and_leaves_nothing() {
    let run = Recorded::of("smoke.toml");
    std::os::unix::fs::symlink("/dev/full", run.file("refused.csv.tiles.part")).expect("there is room");
    let error = run.refused(&["--tiles", "2"]);
    assert!(error.contains("refused.csv.tiles.part") && error.contains("No space left on device"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_program_that_is_killed_leaves_no_temporary_file() {
    use std::io::Read;
    use std::time::Duration;

    let run = Recorded::of("smoke.toml");
    for name in ["-KILL", "-INT"] {
        let mut command = sextant();
        command.arg("map").arg(run.file("run.mcap")).arg("--out").arg(run.file("map.csv")).args(["--tiles", "2"]);
        command.args(["--set", "maps.0.algorithm.ml_tm.grid_step_m=0.0003", "--set", POSTERIOR]);
        command.args(["--set", "maps.0.algorithm.ml_tm.max_memory_mb=100000"]);
        let mut child = command.spawn().expect("it starts");
        let mut told = [0; 64];
        child.stderr.as_mut().expect("a pipe").read_exact(&mut told).expect("it tells the tiles first");
        std::thread::sleep(Duration::from_millis(300));
        crate::program::signal(&child, name);
        child.wait().expect("it ends");
        assert_eq!(files(run.folder.path()), ["run.mcap"], "{name}");
    }
}

#[test]
fn tiles_that_are_kept_by_several_processes_give_the_map_of_one() {
    let recorded = Recorded::of("ml-tm/circular.toml");
    // The map of the scenario, and another one.
    let own: &[&str] = &[];
    for words in [own, &["--algorithm", "packet-centroid"]] {
        let maps = TempDir::new().expect("there is room");
        let kept = maps.path().to_str().expect("UTF-8");
        let make = |tiles: &str| {
            let mut command = sextant();
            command.arg("map").arg(recorded.file("run.mcap")).args(words).args(["--tiles", "6"]);
            command.args(["--keep-tiles", kept, "--only-tiles", tiles]).output().expect("it starts")
        };
        let (map, summary) = recorded.mapped(words);
        assert_eq!(make("2..5").printed(), "2..5 of 6 tiles are kept\n", "{words:?}");
        assert!(make("0..3").status.success(), "a tile may be asked for twice");
        let all = [words, &["--tiles", "6", "--keep-tiles", kept]].concat();
        let (joined, of_joined) = recorded.mapped(&all);
        assert!(joined == map, "{words:?}: the map is another one");
        assert_eq!(of_joined, summary, "{words:?}");
        let message = make("5..7").refusal();
        assert!(message.contains("there are no tiles 5..7"), "{message}");
    }
}

#[test]
fn tiles_of_other_settings_are_refused() {
    let recorded = Recorded::of("smoke.toml");
    let kept = recorded.folder.path().join("kept");
    let words = ["--algorithm", "ml-tm", "--tiles", "2", "--keep-tiles", kept.to_str().expect("UTF-8")];
    assert!(recorded.map("a.csv", &words).status.success());
    let other = [&words[..], &["--set", "maps.0.algorithm.ml_tm.grid_step_m=0.4"]].concat();
    let message = recorded.map("b.csv", &other).refusal();
    assert!(message.contains("cannot be used as a finished tile"), "{message}");
    let tile = kept.join("ml-tm/000001.csv");
    let text = std::fs::read_to_string(&tile).expect("a tile");
    std::fs::write(&tile, text.replacen("\n0,", "\nx,", 1)).expect("there is room");
    let output = recorded.map("c.csv", &words);
    assert!(!output.status.success() && !recorded.file("c.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_tile_of_another_place_and_one_that_is_no_file_are_refused() {
    use std::fs;
    use std::os::unix::fs::symlink;

    let recorded = Recorded::of("smoke.toml");
    let kept = recorded.folder.path().join("kept");
    let words = ["--algorithm", "ml-tm", "--tiles", "2", "--keep-tiles", kept.to_str().expect("UTF-8")];
    assert!(recorded.map("a.csv", &words).status.success());
    let [first, second] = ["000000.csv", "000001.csv"].map(|name| kept.join("ml-tm").join(name));
    let honest = fs::read_to_string(&second).expect("a tile");
    let row = honest.lines().nth(1).expect("a node").to_owned();
    let place = row.split(',').nth(1).expect("a place").to_owned();
    let write = |text: String| fs::write(&second, text).expect("there is room");
    let changes: [(&str, &dyn Fn()); 6] = [
        ("it is another tile", &|| write(fs::read_to_string(&first).expect("a tile"))),
        ("of a node that it has before", &|| write(format!("{honest}{row}\n"))),
        ("is broken", &|| write(honest.replacen(&place, "nan", 1))),
        ("is a link", &|| symlink("000000.csv", &second).expect("there is room")),
        ("is a link", &|| symlink("/dev/zero", &second).expect("there is room")),
        ("is not a file", &|| {
            let made = std::process::Command::new("mkfifo").arg(&second).status().expect("it starts");
            assert!(made.success());
        }),
    ];
    for (expected, change) in changes {
        fs::remove_file(&second).expect("it is there");
        change();
        let message = recorded.map("b.csv", &words).refusal();
        assert!(message.contains(expected), "{expected}: {message}");
    }
    fs::remove_file(&second).expect("it is there");
    assert!(recorded.map("b.csv", &words).status.success());
    assert_eq!(fs::read(recorded.file("a.csv")).expect("a map"), fs::read(recorded.file("b.csv")).expect("a map"));
}
