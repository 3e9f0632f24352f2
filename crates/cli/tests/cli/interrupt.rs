//! Ctrl-C and SIGTERM: each command ends with exit code 130 and keeps finished results.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Output};
use std::time::{Duration, Instant};

use sextant_recording as recording;
use tempfile::TempDir;

use crate::program::{Said, scenario, sextant, signal, summary};
use crate::recording::sample;

/// A program that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(20);
/// The second map, `slow`, has such a fine grid that it takes minutes.
const SLOW: &str = "extends = \"SMOKE\"\n\
    [[maps]]\n\
    name = \"quick\"\n\
    algorithm.ml_tm = { grid_step_m = 0.5, profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 } }\n\
    [[maps]]\n\
    name = \"slow\"\n\
    algorithm.ml_tm = { grid_step_m = 0.0003, estimate = \"posterior_mean\", max_memory_mb = 100000, \
    profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 } }\n";

/// The output of `child`, which must end in time.
pub(crate) fn ended(mut child: Child) -> Output {
    #[expect(clippy::disallowed_methods, reason = "a program that hangs must fail the test")]
    let start = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().expect("a child");
            panic!("it did not end within {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("a child")
}

/// A scenario with two maps, of which the second takes minutes.
fn slow(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("slow.toml");
    let smoke = scenario("smoke.toml").canonicalize().expect("it is there");
    std::fs::write(&path, SLOW.replace("SMOKE", &smoke.display().to_string())).expect("there is room");
    path
}

/// Waits until a note on standard error says that the slow map has begun.
fn wait_for_note(stderr: &mut ChildStderr) {
    let mut text = String::new();
    let mut byte = [0; 1];
    while !text.contains("operations") {
        assert!(stderr.read(&mut byte).expect("a pipe") == 1, "it ended early: {text}");
        text.push(byte[0].into());
    }
}

#[test]
fn a_signal_during_the_survey_leaves_a_complete_recording() {
    for name in ["-INT", "-TERM"] {
        let folder = TempDir::new().expect("there is room");
        let out = folder.path().join("cut.mcap");
        let mut command = sextant();
        // One stop takes minutes here, so the run must end within a stop.
        command.arg("run").arg(scenario("smoke.toml")).args(["--set", "robots.0.listen_s=1000000", "--out"]);
        let child = command.arg(&out).spawn().expect("it starts");
        while !out.with_extension("mcap.part").exists() {
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(300));
        signal(&child, name);
        let output = ended(child);
        assert_eq!(output.status.code(), Some(130), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!out.with_extension("mcap.part").exists(), "{name}");
        sextant().arg("inspect").arg(&out).output().expect("it starts").printed();
    }
}

#[test]
fn a_signal_during_mapping_keeps_the_survey_and_the_finished_maps() {
    for name in ["-INT", "-TERM"] {
        let folder = TempDir::new().expect("there is room");
        let (out, json) = (folder.path().join("cut.mcap"), folder.path().join("cut.json"));
        let mut command = sextant();
        command.arg("run").arg(slow(folder.path())).arg("--out").arg(&out).arg("--summary").arg(&json);
        let mut child = command.spawn().expect("it starts");
        wait_for_note(child.stderr.as_mut().expect("a pipe"));
        signal(&child, name);
        assert_eq!(ended(child).status.code(), Some(130), "{name}");
        let summary = summary(&json);
        assert_eq!(summary["interrupted"], true, "{summary:#}");
        let maps = summary["maps"].as_array().expect("maps");
        assert_eq!((maps.len(), &maps[0]["name"]), (1, &"quick".into()), "{summary:#}");
        let inspected = sextant().arg("inspect").arg(&out).output().expect("it starts");
        let text = String::from_utf8_lossy(&inspected.stdout).into_owned();
        assert!(inspected.status.success() && text.contains("/map/quick") && !text.contains("/map/slow"), "{text}");
        let log = recording::read_log(&out).expect("a whole recording").logs.first().clone();
        assert_eq!(summary["gathering"]["stops"].as_u64(), Some(log.stops().len() as u64));
    }
}

#[test]
fn a_signal_while_a_recording_is_mapped_keeps_the_finished_maps() {
    let folder = TempDir::new().expect("there is room");
    let file = |name: &str| folder.path().join(name);
    let run = sextant().arg("run").arg(scenario("smoke.toml")).arg("--out").arg(file("run.mcap")).output();
    assert!(run.expect("it starts").status.success());
    let mut command = sextant();
    command.arg("map").arg(file("run.mcap")).arg("--summary").arg(file("map.json"));
    command.args(["--set", "maps.0.algorithm.ml_tm.grid_step_m=0.0003"]);
    command.args(["--set", "maps.0.algorithm.ml_tm.max_memory_mb=100000"]);
    command.args(["--set", "maps.0.algorithm.ml_tm.estimate=posterior_mean"]);
    let mut child = command.spawn().expect("it starts");
    wait_for_note(child.stderr.as_mut().expect("a pipe"));
    signal(&child, "-TERM");
    assert_eq!(ended(child).status.code(), Some(130));
    let summary = summary(&file("map.json"));
    assert_eq!(summary["interrupted"], true, "{summary:#}");
    assert!(summary.get("maps").is_none() && summary["gathering"]["stops"].as_u64() > Some(10), "{summary:#}");
}

/// The octets of a recording up to the end of its first chunk, and that chunk alone.
fn first_chunk(recording: &[u8]) -> (&[u8], &[u8]) {
    const MAGIC: usize = 8;
    const CHUNK: u8 = 0x06;
    let mut start = MAGIC;
    loop {
        let length = u64::from_le_bytes(recording[start + 1..start + 9].try_into().expect("eight octets"));
        let end = start + 9 + usize::try_from(length).expect("a short record");
        if recording[start] == CHUNK {
            return (&recording[..end], &recording[start..end]);
        }
        start = end;
    }
}

/// The broken recording is long enough to be interrupted, and a pipe, which cannot be read twice, is refused.
#[test]
fn a_signal_during_recovery_leaves_neither_a_copy_nor_a_temporary_file() {
    let folder = TempDir::new().expect("there is room");
    let file = |name: &str| folder.path().join(name);
    sample::record_file(&file("whole.mcap"), &sample::log(1, 5, 50));
    let octets = std::fs::read(file("whole.mcap")).expect("a recording");
    let (start, chunk) = first_chunk(&octets);
    let chunks = 100_000_000 / chunk.len();
    std::fs::write(file("broken.mcap"), [start, &chunk.repeat(chunks)].concat()).expect("there is room");
    for name in ["-INT", "-TERM"] {
        let mut command = sextant();
        let child = command.arg("recover").arg(file("broken.mcap")).arg("--out").arg(file("good.mcap")).spawn();
        let child = child.expect("it starts");
        while !file("good.mcap.recovering").exists() {
            std::thread::sleep(Duration::from_millis(2));
        }
        #[expect(clippy::disallowed_methods, reason = "the time until a program ends is what is tested")]
        let signalled = Instant::now();
        signal(&child, name);
        assert_eq!(ended(child).status.code(), Some(130), "{name}");
        let time = signalled.elapsed();
        // The limit is one second; a busy machine gets more.
        assert!(time < Duration::from_secs(3), "{name}: {time:?}");
        let left =
            std::fs::read_dir(folder.path()).expect("a folder").map(|entry| entry.expect("a file").file_name());
        assert_eq!(left.collect::<BTreeSet<_>>(), ["broken.mcap", "whole.mcap"].map(Into::into).into(), "{name}");
    }
    assert!(Command::new("mkfifo").arg(file("pipe")).status().expect("mkfifo starts").success());
    let refused = sextant().arg("recover").arg(file("pipe")).arg("--out").arg(file("good.mcap")).output();
    let told = String::from_utf8_lossy(&refused.expect("it starts").stderr).into_owned();
    assert!(told.contains("it is no file that can be read twice"), "{told}");
}
