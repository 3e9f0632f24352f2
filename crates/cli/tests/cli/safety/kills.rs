//! Commands that are killed at any instant: what has its final name is whole, and the same command, given again, ends as if
//! nothing had happened. `SEXTANT_KILLS=1000 cargo test -p sextant-cli --test cli -- kills` kills more often.

use std::path::Path;
use std::time::{Duration, Instant};

use sextant_kernel::{Purpose, Seed};

use super::Bench;
use crate::program::sextant;

/// Kills, unless more are asked for.
const USUAL: u64 = 14;

/// A command that is killed, and what it makes.
struct Victim {
    line: &'static str,
    /// What is added if the first attempt left something.
    again: fn(&Bench) -> &'static str,
    /// Files that are the same each time.
    makes: &'static [&'static str],
}

const VICTIMS: [Victim; 7] = [
    Victim {
        line: "run a.toml --seed 2 --out b.mcap --summary b.json --pcap b.pcap",
        again: |_| "",
        makes: &["b.mcap", "b.pcap"],
    },
    Victim {
        line: "sweep a.toml --runs 6 --out t.csv",
        again: |bench| {
            // Beside a finished table the folder of finished runs may be left.
            let is_begun = bench.path("t.csv.parts/fingerprint").exists();
            if is_begun { " --resume" } else { " --force" }
        },
        makes: &["t.csv"],
    },
    Victim {
        line: "sweep a.toml --runs 4 --plan plan --no-trial",
        again: |bench| if bench.path("plan/plan.json").exists() { " --force" } else { "" },
        makes: &["plan/plan.json", "plan/work.jsonl"],
    },
    Victim { line: "sweep done --cells 0..4", again: |_| "", makes: &["done/work.jsonl"] },
    Victim {
        line: "map a.mcap --algorithm ml-tm --tiles 3 --keep-tiles kept --out m.csv",
        again: |_| "",
        makes: &["m.csv"],
    },
    Victim {
        line: "export a.mcap --out tables",
        again: |_| " --force",
        makes: &["tables/stops.csv", "tables/mac_frames.csv"],
    },
    Victim { line: "recover broken.mcap --out whole.mcap", again: |_| "", makes: &["whole.mcap"] },
];

/// A folder with a scenario, its recording, whole and broken, and a plan.
fn prepared() -> Bench {
    let bench = Bench::recorded();
    let recording = bench.read("a.mcap");
    std::fs::write(bench.path("broken.mcap"), &recording[..recording.len() * 3 / 4]).expect("there is room");
    bench.done("sweep a.toml --runs 4 --plan done --no-trial");
    bench
}

/// A copy of `bench`.
fn copy(bench: &Bench) -> Bench {
    fn copy_folder(from: &Path, to: &Path) {
        for entry in std::fs::read_dir(from).expect("there is room") {
            let path = entry.expect("an entry").path();
            let new = to.join(path.file_name().expect("a name"));
            if path.is_dir() {
                std::fs::create_dir_all(&new).expect("there is room");
                copy_folder(&path, &new);
            } else {
                std::fs::copy(&path, &new).expect("there is room");
            }
        }
    }
    let copy = Bench::empty();
    copy_folder(bench.folder(), copy.folder());
    copy
}

#[test]
fn a_command_that_was_killed_can_be_given_again() {
    let kills = std::env::var("SEXTANT_KILLS").map_or(USUAL, |text| text.parse().expect("a number"));
    let prepared = prepared();
    let whole: Vec<(Duration, Vec<Vec<u8>>)> = VICTIMS
        .iter()
        .map(|victim| {
            let bench = copy(&prepared);
            #[expect(clippy::disallowed_methods, reason = "the instants of the kills are within this time")]
            let start = Instant::now();
            bench.done(victim.line);
            (start.elapsed(), victim.makes.iter().map(|name| bench.read(name)).collect())
        })
        .collect();
    let mut ended_before = 0;
    for kill in 0..kills {
        let at = usize::try_from(kill).unwrap() % VICTIMS.len();
        let (victim, (duration, files)) = (&VICTIMS[at], &whole[at]);
        let bench = copy(&prepared);
        let line = victim.line;
        let mut child = sextant().args(line.split(' ')).current_dir(bench.folder()).spawn().unwrap();
        std::thread::sleep(duration.mul_f64(Seed(kill).uniform(Purpose::new(1), [kill, 0, 0])));
        child.kill().unwrap();
        ended_before += u64::from(child.wait_with_output().unwrap().status.success());
        let check = |when: &str| {
            for (name, content) in victim.makes.iter().zip(files) {
                let found = std::fs::read(bench.path(name)).ok();
                let is_allowed = found.as_ref() == Some(content) || found.is_none() && when == "after the kill";
                assert!(is_allowed, "kill {kill} of `{line}`: `{name}` is not whole {when}");
            }
        };
        check("after the kill");
        check_part(&bench);
        bench.done(&format!("{line}{}", (victim.again)(&bench)));
        check("after the second attempt");
    }
    assert!(ended_before < kills, "no command was killed");
}

/// Checks that what a killed run left can be recovered, if it has got as far as a header.
fn check_part(bench: &Bench) {
    let part = bench.path("b.mcap.part");
    if std::fs::metadata(&part).is_ok_and(|part| part.len() > 100) {
        bench.done("recover b.mcap.part --out c.mcap");
        bench.done("inspect c.mcap");
    }
}
