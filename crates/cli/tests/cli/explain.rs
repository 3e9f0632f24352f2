//! `sextant explain` and `sextant explain-link`: what a key means, and what a link consists of.

use serde_json::Value;

use crate::program::{Said, scenario, sextant};

/// What a command prints, and what it tells on standard error if it fails with exit code 2.
fn told(words: &[&str]) -> Result<String, String> {
    match sextant().args(words).output().expect("it starts").all() {
        (0, printed, _) => Ok(printed),
        (code, _, message) => {
            assert_eq!(code, 2, "{words:?}");
            Err(message)
        }
    }
}

fn json(words: &[&str]) -> Value {
    serde_json::from_str(&told(&[words, &["--format", "json"]].concat()).expect("it is explained")).expect("JSON")
}

#[test]
fn a_key_is_explained_with_its_unit_its_default_and_an_example() {
    let text = told(&["explain", "robots.0.speed_m_per_s"]).expect("a key");
    for part in
        ["robots[].speed_m_per_s", "How fast it drives (m/s).", "m/s", "1.0", "[[robots]]", "speed_m_per_s = "]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let key = &json(&["explain", "robots.0.speed_m_per_s"])["keys"][0];
    assert_eq!([&key["kind"], &key["unit"], &key["default"]], ["number", "m/s", "1.0"]);
}

#[test]
fn a_choice_lists_what_may_be_chosen_and_a_table_its_keys() {
    let text = told(&["explain", "robots.controller"]).expect("a key");
    assert!(["automated_s", "spiral", "hilbert", "waypoints"].iter().all(|name| text.contains(name)), "{text}");
    let text = told(&["explain", "channel.environment"]).expect("a key");
    assert!(text.contains("\"heavy-tree\"") && text.contains("Heavy tree density"), "{text}");
    let text = told(&["explain", "maps.algorithm.ml_tm"]).expect("a key");
    assert!(text.contains("grid_step_m") && text.contains("required"), "{text}");
}

#[test]
fn the_names_of_materials_are_printed() {
    for key in ["world.walls.material", "world.obstacles.material", "channel.reflections.ground_material"] {
        let text = told(&["explain", key]).expect("a key");
        assert!(["\"concrete\"", "\"itu-concrete\"", "\"glass\""].iter().all(|name| text.contains(name)), "{text}");
        assert!(text.contains("choices (a name in quotes)\n") && !text.contains("\n\n\n"), "{text}");
    }
}

#[test]
fn the_end_of_a_path_finds_keys_and_no_key_lists_the_tables() {
    let text = told(&["explain", "exponent"]).expect("keys");
    assert!(
        text.contains("keys end in `exponent`") && text.contains("channel.path_loss.close_in.exponent"),
        "{text}"
    );
    let text = told(&["explain"]).expect("tables");
    assert!(["world", "robots", "channel", "sweep"].iter().all(|table| text.contains(table)), "{text}");
}

#[test]
fn a_number_of_a_summary_is_told_apart_from_a_key() {
    let text = told(&["explain", "maps.ml-tm.position_error_m.mean"]).expect("a measure");
    assert!(text.contains("Not a key of a scenario") && text.contains("metres"), "{text}");
    let text = told(&["explain", "throughput"]).expect("a measure");
    assert!(text.contains("mac.throughput_bit_per_s") && text.contains("bits per second"), "{text}");
}

#[test]
fn unknown_keys_name_similar_ones_and_no_text_is_a_panic() {
    let why = told(&["explain", "channel.path_loss.log_distance.exponnent"]).expect_err("no key");
    assert!(why.contains("similar keys: `channel.path_loss.log_distance.exponent`"), "{why}");
    for odd in ["", " ", ".", "..", "a..b", "[", "[]", "[0]", "maps[", "\"", "0", "maps.0.0.0", "é.ß", "NAME", "-"]
    {
        let _ = told(&["explain", "--", odd]);
    }
}

#[test]
fn the_rays_of_a_link_are_told_as_a_table_as_json_and_as_csv() {
    let file = scenario("smoke.toml").display().to_string();
    let ground = "channel.reflections={ground_z_m=-1, ground_material=\"itu-concrete\"}";
    let link = ["explain-link", &file, "0,-1", "3,-1", "--set", ground];
    let text = told(&link).expect("a link");
    for part in ["departs", "straight", "1 reflection", "The sum of their fields has a gain of"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let found = json(&link);
    let rays = found["rays"].as_array().expect("a list of rays");
    assert_eq!((rays.len(), rays[1]["bounces"].as_u64()), (2, Some(1)));
    // Down to 1 m below, half way: the mirror image is 2 m lower.
    let delay_s = rays[1]["delay_s"].as_f64().expect("a number");
    assert!((delay_s * 299_792_458.0 - 13_f64.sqrt()).abs() < 1e-9, "{delay_s}");
    let elevation = rays[1]["departure_rad"][1].as_f64().expect("an angle");
    assert!((elevation + (2.0_f64 / 3.0).atan()).abs() < 1e-12, "{elevation}");
    let csv = told(&[&link[..], &["--rays"]].concat()).expect("rays");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((lines.len(), lines[0].len(), lines[2].len()), (3, 10, 10), "{csv}");
    assert_eq!(lines[2][1].parse::<f64>().ok(), rays[1]["gain_db"].as_f64());
}

#[test]
fn a_link_is_explained_item_by_item() {
    let file = scenario("smoke.toml").display().to_string();
    let text = told(&["explain-link", &file, "n0", "3,1"]).expect("a link");
    for part in ["link n0 - 3,1 in smoke (seed 1)", "transmit power", "distance, exponent 3.6", "margin above it"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // The block of concrete stands between these places: 20 dB per metre, 2 m thick; and the radius is 6 m.
    let link = json(&["explain-link", &file, "4.5,5", "7.5,5"]);
    let (block, direction) = (&link["path"]["obstacles"][0], &link["directions"][0]);
    assert_eq!((&block["name"], block["length_m"].as_f64()), (&Value::from("block"), Some(2.0)));
    let number = |value: &Value| value.as_f64().expect("a number");
    let losses = ["reference_loss_db", "distance_loss_db", "obstacle_loss_db"].map(|key| number(&link["path"][key]));
    let sum = number(&direction["tx_power_dbm"]) - losses.iter().sum::<f64>();
    assert!((sum - number(&direction["received_dbm"])).abs() < 1e-9, "{link:#}");
    let far = told(&["explain-link", &file, "-5,-5", "20,20"]).expect("a link");
    assert!(far.contains("no link: the radius of communication is 6 m"), "{far}");
}

#[test]
fn wrong_ends_of_a_link_are_refused() {
    let file = scenario("smoke.toml").display().to_string();
    for (a, b, why) in [
        ("survyor", "n0", "did you mean `surveyor`?"),
        ("n0", "n0", "named twice"),
        ("1,2", "1,2,0", "same place"),
        ("n0", "nan,0", "finite"),
        ("n0", "1,2,3,4", "`1,2,3,4` is not a place"),
    ] {
        let told = told(&["explain-link", &file, a, b]).expect_err("no link");
        assert!(told.replace("\n  │ ", " ").contains(why), "{a} {b}: {told}");
    }
    let why = told(&["explain-link", &file, "n0", "n1", "--network", "rf"]).expect_err("no network");
    assert!(why.contains("there is no network `rf`"), "{why}");
}
