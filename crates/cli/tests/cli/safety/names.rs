//! Names of others on terminals, in pictures and in spreadsheets, and the content of files that a scenario names.

use super::Bench;

/// A log with two nodes of these names.
fn log_of(bench: &Bench, names: [&str; 2]) {
    bench.done("init log");
    let receptions = String::from_utf8(bench.read("log/receptions.csv")).expect("UTF-8");
    let mut known: Vec<&str> = receptions.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    known.dedup();
    let quoted = |name: &str| format!("\"{}\",", name.replace('"', "\"\""));
    let renamed = |line: &str| {
        let rename = |line: String, (old, new): (&&str, &str)| {
            let old = format!("{old},");
            if line.starts_with(&old) { line.replacen(&old, &quoted(new), 1) } else { line }
        };
        known.iter().zip(names).fold(line.to_owned(), rename) + "\n"
    };
    bench.write("log/receptions.csv", &receptions.lines().map(renamed).collect::<String>());
    std::fs::remove_file(bench.path("log/nodes.csv")).expect("a file");
}

/// A command that maps the log by an algorithm that takes little time: names are the same in all.
fn mapped(words: &str) -> String {
    format!("map log --algorithm ml-tm {words}")
}

#[test]
fn names_cannot_move_the_cursor_or_break_a_picture() {
    let bench = Bench::new();
    log_of(&bench, ["\u{1b}[2Jclear", "bell\u{7}"]);
    for line in [&mapped("--figure pictures --out map.csv"), "inspect log", &mapped("--truth log/stops.csv")] {
        let output = bench.run(line);
        for text in [output.stdout, output.stderr] {
            let text = String::from_utf8(text).unwrap();
            assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{line}: {text:?}");
        }
    }
    for file in std::fs::read_dir(bench.path("pictures")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        assert!(!text.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t')));
    }
    let name = "robots.0.name=\u{1b}[31mred";
    let output =
        crate::program::sextant().args(["check", "a.toml", "--set", name]).current_dir(bench.folder()).output();
    assert!(!output.unwrap().stderr.contains(&0x1b));
}

#[test]
fn a_name_cannot_reverse_the_letters_around_it() {
    let bench = Bench::new();
    log_of(&bench, ["\u{202e}edon", "\u{2067}other\u{2028}"]);
    let is_hidden = |c: char| matches!(c, '\u{2028}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    for line in [&mapped("--figure pictures --out map.csv"), "inspect log", &mapped("--truth log/stops.csv")] {
        let output = bench.run(line);
        for text in [output.stdout, output.stderr] {
            let text = String::from_utf8(text).unwrap();
            assert!(!text.contains(is_hidden), "{line}: {text:?}");
        }
    }
    for file in std::fs::read_dir(bench.path("pictures")).unwrap() {
        assert!(!std::fs::read_to_string(file.unwrap().path()).unwrap().contains(is_hidden));
    }
    // Tables keep the names.
    assert!(String::from_utf8(bench.read("map.csv")).unwrap().contains("\n\u{202e}edon,"));
    bench.write("own.toml", "extends = \"a.toml\"\nseed = \"\u{202e}1\" # \u{202d}\n");
    assert!(!bench.refused("check own.toml").contains(is_hidden));
}

#[test]
fn a_name_that_looks_like_a_formula_reads_back_equal() {
    let bench = Bench::new();
    log_of(&bench, ["=HYPERLINK(\"http://x\")", "''=1+1"]);
    bench.done(&mapped("--out map.csv --quiet"));
    let map = String::from_utf8(bench.read("map.csv")).unwrap();
    assert!(map.contains("\n\"'=HYPERLINK(\"\"http://x\"\")\",") && map.contains("\n''=1+1,"), "{map}");
    assert!(map.contains(",-") && !map.contains(",'-"), "numbers stay numbers: {map}");
    // The map is the truth of the next one: all names are known.
    let output = bench.run(&mapped("--truth map.csv --format json"));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["maps"][0]["position_error_m"]["max"].as_f64().unwrap() < 1e-9, "{json}");
    let truth = bench.run(&mapped("--truth map.csv"));
    assert!(!String::from_utf8(truth.stderr).unwrap().contains("unknown"));
}

#[test]
fn the_content_of_files_outside_the_folder_of_a_scenario_is_not_shown() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("below")).unwrap();
    bench.write("secret.txt", "root:x:0:0\nhunter2,1\n");
    bench.write("secret.csv", "node,x_m,y_m\na,hunter2,0\n");
    let outside = [
        "extends = \"../secret.txt\"\n",
        "extends = \"../a.toml\"\n[world.nodes]\ncsv = { file = \"../secret.txt\" }\n",
        "extends = \"../a.toml\"\n[world.nodes]\ncsv = { file = \"../secret.csv\" }\n",
    ];
    for text in outside {
        bench.write("below/own.toml", text);
        let said = bench.refused("check below/own.toml");
        assert!(!said.contains("hunter2") && !said.contains("root"), "{said}");
        assert!(said.contains("secret") && said.contains("is not shown"), "{said}");
    }
    bench.write("own.toml", "extends = \"a.toml\"\n[world.nodes]\ncsv = { file = \"secret.csv\" }\n");
    let said = bench.refused("check own.toml");
    assert!(said.contains("hunter2") && said.contains("line 2"), "{said}");
}
