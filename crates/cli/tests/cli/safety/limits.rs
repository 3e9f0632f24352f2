//! Inputs that are too large for their purpose are refused with clear words, before the work.

use super::Bench;

#[test]
fn a_sweep_of_too_many_cells_or_runs_is_refused() {
    let bench = Bench::new();
    let values: Vec<String> = (0..20_000).map(|i| format!("{i}")).collect();
    let values = values.join(", ");
    bench.write(
        "bomb.toml",
        &format!("extends = \"a.toml\"\n[sweep.product]\nseed_a = [{values}]\nseed_b = [{values}]\n"),
    );
    let said = bench.refused("check bomb.toml");
    assert!(said.contains("a sweep of 400000000 cells; allowed: at most 1000000 cells"), "{said}");
    let said = bench.refused("sweep a.toml --runs 4000000000");
    assert!(said.contains("allowed: at most 10000000"), "{said}");
}

#[test]
fn too_many_threads_are_refused() {
    let said = Bench::new().refused("run a.toml --threads 100000");
    assert!(said.contains("expected 1 to 1024"), "{said}");
}

#[cfg(unix)]
#[test]
fn files_without_end_are_refused() {
    let bench = Bench::new();
    bench.write("extends.toml", "extends = \"/dev/zero\"\n");
    bench.write("nodes.toml", "extends = \"a.toml\"\n[world.nodes]\ncsv = { file = \"/dev/zero\" }\n");
    for line in ["check /dev/zero", "run /dev/zero", "check extends.toml", "check nodes.toml"] {
        let said = bench.refused(line);
        assert!(said.contains("is larger than"), "{line}: {said}");
    }
    std::fs::create_dir(bench.path("log")).unwrap();
    bench.write("log/receptions.csv", "node,stop,received\n");
    std::os::unix::fs::symlink("/dev/zero", bench.path("log/stops.csv")).unwrap();
    let said = bench.refused("map log");
    assert!(said.contains("longer than 64 MB"), "{said}");
}

#[test]
fn a_value_of_a_megabyte_is_not_repeated() {
    let bench = Bench::new();
    let long = "x".repeat(1_000_000);
    bench.write("cell.csv", &format!("node,x_m,y_m\na,{long},0\n"));
    bench.write("cell.toml", "extends = \"a.toml\"\n[world.nodes]\ncsv = { file = \"cell.csv\" }\n");
    bench.write("text.toml", &format!("extends = \"a.toml\"\nseed = \"{long}\"\n"));
    bench.write("key.toml", &format!("extends = \"a.toml\"\n{long} = 1\n"));
    bench.done("init log");
    bench.write("log/stops.csv", &format!("stop,t_s,x_m,y_m\n0,{long},0,0\n"));
    for line in ["check cell.toml", "check text.toml", "check key.toml", "map log"] {
        let said = bench.refused(line);
        assert!(said.len() < 3000, "{line}: {} octets", said.len());
    }
}

#[test]
fn numbers_that_nobody_can_mean_are_refused_at_their_key() {
    let bench = Bench::new();
    for (setting, allowed) in [
        ("robots.0.speed_m_per_s=1e-300", "1e-9 to 1e9 m/s"),
        ("robots.0.speed_m_per_s=1e300", "1e-9 to 1e9 m/s"),
        ("robots.0.start_m=[0,1e300]", "1e-9 to 1e9 m"),
        ("robots.0.start_m=[1e9,0]", "of a node"),
        ("channel.max_range_m=1e300", "1e-9 to 1e9 m"),
        ("robots.0.controller={waypoints={places_m=[[0,0],[1e300,0]]}}", "1e-9 to 1e9 m"),
        ("sinks=[{name=\"s\",position_m=[1e300,0]}]", "1e-9 to 1e9 m"),
        ("radio.tx_power_dbm=1e300", "1e-30 to 1e30"),
        (
            "robots.0.controller={waypoints={places_m=[[0,0],[1e7,0]]}} --set robots.0.speed_m_per_s=0.001",
            "a path of at most 1e9 s",
        ),
    ] {
        let said = bench.refused(&format!("check a.toml --set {setting}"));
        let key = setting.split('=').next().unwrap().split('.').next_back().unwrap();
        assert!(said.contains(allowed), "{setting}: {said}");
        assert!(said.contains(key) || said.contains("controller"), "{setting}: {said}");
    }
}

#[test]
fn a_path_of_many_keys_is_refused() {
    let bench = Bench::new();
    let deep = vec!["a"; 20_000].join(".");
    bench.write("deep.toml", &format!("extends = \"a.toml\"\n[sweep.product]\n\"{deep}\" = [1, 2]\n"));
    let half = vec!["a"; 40].join(".");
    bench.write("joined.toml", &format!("extends = \"a.toml\"\n[sweep.product.\"{half}\"]\n\"{half}\" = [1, 2]\n"));
    let set = format!("check a.toml --set {deep}=1");
    for line in ["check deep.toml", "sweep deep.toml --dry-run", "check joined.toml", &set] {
        let said = bench.refused(line);
        assert!(said.contains("at most 64 keys") && said.len() < 3000, "{}: {said}", &line[..20.min(line.len())]);
    }
}
