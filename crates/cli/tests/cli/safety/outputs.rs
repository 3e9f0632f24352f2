//! An output never replaces an input, and only outputs of this program are replaced without being asked for.

use super::Bench;

/// Commands that would destroy `file`.
fn spares(bench: &Bench, file: &str, lines: &[&str]) {
    let before = bench.read(file);
    for line in lines {
        let said = bench.refused(line);
        assert!(said.contains("an output never replaces an input"), "{line}: {said}");
        assert_eq!(bench.read(file), before, "{line}");
    }
}

#[test]
fn runs_spare_the_scenario_and_all_that_it_names() {
    let bench = Bench::new();
    bench.write("nodes.csv", "node,x_m,y_m\na,0,0\nb,4,0\nc,0,4\n");
    bench.write(
        "own.toml",
        "extends = \"a.toml\"\nname = \"own\"\nrecording.likelihood = []\nworld = { nodes = { csv = { file = \"nodes.csv\" } } }\n",
    );
    bench.done("check own.toml");
    std::fs::hard_link(bench.path("a.toml"), bench.path("hard")).unwrap();
    std::fs::create_dir(bench.path("below")).unwrap();
    let mut lines = vec![
        "run own.toml --out own.toml",
        "run own.toml --summary own.toml --force",
        "run own.toml --pcap a.toml",
        "run own.toml --out nodes.csv --force",
        "run own.toml --out below/../a.toml",
        "run own.toml --out hard",
        "sweep own.toml --out nodes.csv --force",
    ];
    if cfg!(unix) {
        std::process::Command::new("ln").args(["-s", "a.toml"]).arg(bench.path("soft")).status().unwrap();
        lines.push("run own.toml --out soft");
    }
    for file in ["a.toml", "own.toml", "nodes.csv"] {
        let of_file: Vec<&str> = lines.clone();
        spares(&bench, file, &of_file);
    }
    let shared = bench.refused("run own.toml --out x --summary ./x");
    assert!(shared.contains("are the same file"), "{shared}");
    assert!(!bench.path("x").exists());
    bench.write("s.csv", "extends = \"a.toml\"\n");
    spares(&bench, "s.csv", &["sweep s.csv --out s.csv", "sweep s.csv --force"]);
}

#[test]
fn commands_on_recordings_spare_them() {
    let bench = Bench::recorded();
    spares(
        &bench,
        "a.mcap",
        &[
            "map a.mcap --out a.mcap --force",
            "map a.mcap --summary a.mcap",
            "report a.mcap --out a.mcap --force",
            "recover a.mcap --out ./a.mcap --force",
        ],
    );
    bench.write("book.csv", "sector,azimuth_deg,elevation_deg,gain_dbi\n");
    spares(&bench, "book.csv", &["antenna convert book.csv book.csv --force"]);
    std::fs::create_dir(bench.path("tables")).unwrap();
    std::fs::hard_link(bench.path("a.mcap"), bench.path("tables/stations.csv")).unwrap();
    spares(&bench, "a.mcap", &["export a.mcap --out tables --force"]);
}

#[test]
fn maps_spare_the_tables_of_a_log_and_the_truth() {
    let bench = Bench::new();
    bench.done("init log");
    for table in ["log/stops.csv", "log/receptions.csv", "log/nodes.csv"] {
        spares(
            &bench,
            table,
            &[
                &format!("map log --truth log/nodes.csv --out {table} --force"),
                &format!("map log --summary {table} --force"),
            ],
        );
    }
    spares(&bench, "log/stops.csv", &["report log --out log/stops.csv --force"]);
    for _ in 0..2 {
        bench.done("map log --algorithm packet-centroid --out log/map.csv --quiet");
    }
    spares(&bench, "log/map.csv", &["map log --truth log/map.csv --out log/map.csv --force"]);
}

#[test]
fn outputs_of_this_program_are_replaced_and_told() {
    let bench = Bench::recorded();
    for (line, file, what) in [
        ("run a.toml --out a.mcap", "a.mcap", "an earlier recording"),
        ("run a.toml --out b.mcap --summary a.json", "a.json", "an earlier summary"),
        ("recover a.mcap --out b.mcap", "b.mcap", "an earlier recording"),
        ("run a.toml --out b.mcap --pcap a.pcap", "a.pcap", "an earlier capture of a simulation"),
        ("map a.mcap --out map.csv", "map.csv", "an earlier map"),
        ("report a.mcap --out a.html", "a.html", "an earlier report"),
        ("figure a.mcap --out pictures", "pictures/network.svg", "an earlier picture"),
    ] {
        bench.done(line);
        let said = bench.done(line);
        let is_told = said.contains(&format!("`{file}`")) && said.contains("replaced") && said.contains(what);
        assert!(is_told, "{line}: {said}");
        bench.write(file, "years of work");
        let said = bench.refused(line);
        assert!(said.contains(&format!("exists, and is not {what}")) && said.contains("--force"), "{line}: {said}");
        assert_eq!(bench.read(file), b"years of work", "{line}");
        assert!(bench.done(&format!("{line} --force")).contains("is replaced"), "{line}");
        assert_ne!(bench.read(file), b"years of work", "{line}");
    }
    assert!(!bench.done("run a.toml --out a.mcap --quiet").contains("replaced"));
}

#[test]
fn texts_that_people_change_are_kept() {
    let bench = Bench::recorded();
    for _ in 0..2 {
        bench.done("figure a.mcap --layout --out layout");
    }
    bench.write("layout/a.foxglove.json", "{}");
    let said = bench.refused("figure a.mcap --layout --out layout");
    assert!(said.contains("is not the same text"), "{said}");
    bench.write("mine.txt", "mine");
    let said = bench.refused("reproduce 3.2 --out .");
    assert!(said.contains("has files") && said.contains("--force"), "{said}");
}

#[test]
fn a_plan_does_not_clear_away_its_own_scenario() {
    let bench = Bench::new();
    bench.done("sweep a.toml --runs 1 --plan plan --no-trial");
    let files: Vec<_> =
        std::fs::read_dir(bench.path("plan/files")).unwrap().map(|file| file.unwrap().path()).collect();
    let name = files[0].strip_prefix(bench.folder()).unwrap().display().to_string();
    spares(&bench, &name, &[&format!("sweep {name} --runs 1 --plan plan --no-trial --force")]);
}

#[test]
fn an_output_without_a_place_is_refused_before_the_work() {
    let bench = Bench::recorded();
    std::fs::create_dir(bench.path("folder")).unwrap();
    for (line, why) in [
        ("run a.toml --out a.toml/b.mcap", "there is no folder `a.toml`"),
        ("run a.toml --out b.mcap --summary folder", "it is a folder"),
        ("run a.toml --out b.mcap --summary no/b.json", "there is no folder `no`"),
        ("run a.toml --out b.mcap --summary no/../b.json", "there is no folder `no/..`"),
        ("run a.toml --out b.mcap --pcap a.toml/b.pcap", "there is no folder `a.toml`"),
        ("map a.mcap --out folder", "it is a folder"),
        ("map a.mcap --summary no/b.json", "there is no folder `no`"),
        ("report a.mcap --out folder --force", "it is a folder"),
    ] {
        let said = bench.refused(line);
        assert!(said.contains(why), "{line}: {said}");
    }
    assert!(!bench.path("b.mcap").exists() && !bench.path("b.mcap.part").exists());
}

#[test]
fn an_output_does_not_have_the_temporary_name_of_another_one() {
    let bench = Bench::new();
    for line in [
        "run a.toml --out r.mcap.part --pcap r.mcap",
        "run a.toml --out r.mcap --pcap r.mcap.part",
        "run a.toml --out r.mcap --summary ./r.mcap.part --force",
    ] {
        let said = bench.refused(line);
        assert!(said.contains("are the same file"), "{line}: {said}");
    }
}

#[test]
fn nothing_is_added_to_a_plan() {
    let bench = Bench::new();
    bench.done("sweep a.toml --runs 1 --plan plan --no-trial");
    bench.done("sweep plan --cells 0..1 --quiet");
    for table in ["plan/table.csv", "plan/parts/x.csv", "plan/no/../../plan/x.csv"] {
        let said = bench.refused(&format!("sweep plan --collect --quiet --force --out {table}"));
        assert!(said.contains("an output never replaces an input"), "{table}: {said}");
    }
    bench.done("sweep plan --collect --quiet --out table.csv");
}

#[cfg(unix)]
#[test]
fn a_pipe_that_no_process_reads_does_not_hold_the_program() {
    let bench = Bench::recorded();
    std::process::Command::new("mkfifo").arg(bench.path("pipe")).status().unwrap();
    let said = bench.refused("run a.toml --out pipe");
    assert!(said.contains("a device or a pipe") && !bench.path("pipe").is_file(), "{said}");
    let output = bench.run("run a.toml --out b.mcap --summary pipe --quiet");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("`pipe` cannot be written: it is a pipe that no process reads"), "{said}");
    // A reader that is there gets all.
    let pipe = bench.path("pipe");
    let reader = std::thread::spawn(move || std::fs::read(pipe).unwrap());
    bench.done("map a.mcap --out pipe --quiet");
    assert!(reader.join().unwrap().starts_with(b"node,x_m,y_m,z_m"));
}
