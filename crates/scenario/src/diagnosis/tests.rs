use proptest::prelude::*;

use crate::{Scenario, ScenarioError};

/// A valid scenario.
const GOOD: &str = r#"name = "good"
seed = 1

[world.nodes.explicit]
positions_m = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]

[[world.obstacles]]
name = "wall"
material = "concrete"
[world.obstacles.shape.box]
center_m = [5.0, 5.0, 0.0]
size_m = [2.0, 1.0, 3.0]

[radio]
tx_power_dbm = -50.0
sensitivity_dbm = -90.0

[channel]
environment = "suburban"
[channel.path_loss.log_distance]
exponent = 3.0
min_distance_m = 0.1

[traffic.beacon]
interval_s = 1.0

[[robots]]
name = "first"
start_m = [-3.0, 0.0]
listen_s = 1.2
[robots.controller.automated_s]
step_m = 1.0
lane_spacing_m = 5.0

[[robots]]
name = "second"
start_m = [-3.0, 1.0]
speed_m_per_s = 1.0
[robots.controller.waypoints]
places_m = [[0.0, 3.0]]

[[robots]]
name = "third"
start_m = [-3.0, 2.0]
[robots.controller.waypoints]
places_m = [[0.0, 4.0]]

[[maps]]
name = "a"
[maps.algorithm.ml_tm]
grid_step_m = 0.25
counts = "at_least_one"
[maps.algorithm.ml_tm.profile.trapezoid]
p0 = 0.95
plateau_m = 2.0
range_m = 10.0
"#;

/// Mistakes that do not depend on each other: what is replaced by what.
const MISTAKES: &[(&str, &str)] = &[
    // An unknown key.
    ("seed = 1", "seed = 1\nfrequency = 2.4"),
    // A wrong type in a list.
    ("[2.0, 0.0]]", "\"x\"]"),
    // An unknown name.
    ("\"concrete\"", "\"cheese\""),
    // A value that is not allowed, in a list.
    ("size_m = [2.0, 1.0, 3.0]", "size_m = [2.0, 0.0, 3.0]"),
    // A wrong type of a key that is needed.
    ("tx_power_dbm = -50.0", "tx_power_dbm = \"strong\""),
    // A typo in a key that is needed.
    ("sensitivity_dbm", "sensitivty_dbm"),
    // An unknown choice.
    ("\"suburban\"", "\"moon\""),
    // Two values that are not allowed, of which one hides behind the other.
    ("exponent = 3.0", "exponent = -3.0"),
    ("min_distance_m = 0.1", "min_distance_m = -1.0"),
    // A typo in a table, and a value in it that is not allowed.
    ("[traffic.beacon]", "[trafic.beacon]"),
    ("interval_s = 1.0", "interval_s = 0.0"),
    // A wrong type of a key that has a default.
    ("listen_s = 1.2", "listen_s = \"long\""),
    // Two choices.
    ("lane_spacing_m = 5.0", "lane_spacing_m = 5.0\n[robots.controller.random_walk]"),
    // A key that is missing.
    ("name = \"second\"\n", ""),
    // A truth where a number belongs.
    ("speed_m_per_s = 1.0", "speed_m_per_s = true"),
    // A choice with a wrong name.
    ("[robots.controller.waypoints]\nplaces_m = [[0.0, 4.0]]", "[robots.controller.zigzag]\nplaces_m = [[0.0, 4.0]]"),
    // A place with one coordinate.
    ("start_m = [-3.0, 2.0]", "start_m = [-3.0]"),
    // A table where a text belongs.
    ("name = \"a\"", "name = {}"),
    // A number where a choice belongs.
    ("counts = \"at_least_one\"", "counts = 3"),
    // A value that is not allowed, in a choice.
    ("p0 = 0.95", "p0 = 1.5"),
];

fn with(mistakes: impl IntoIterator<Item = usize>) -> String {
    mistakes.into_iter().fold(GOOD.to_owned(), |text, i| {
        let (from, to) = MISTAKES[i];
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    })
}

fn errors_of(text: &str) -> Vec<ScenarioError> {
    Scenario::parse(text).err().map(|errors| errors.errors().to_vec()).unwrap_or_default()
}

/// All that is printed of an error but its place.
fn told(error: &ScenarioError) -> String {
    let label = error.excerpt().map(|excerpt| excerpt.label.clone()).unwrap_or_default();
    // The keys in a table with a typo are those of the table that was meant.
    format!("{error} | {label} | {}", error.advice().unwrap_or_default())
}

fn all_told(text: &str) -> Vec<String> {
    let mut told: Vec<_> = errors_of(text).iter().map(told).collect();
    told.sort();
    told
}

#[test]
fn the_scenario_without_mistakes_is_valid() {
    assert_eq!(all_told(GOOD), [""; 0]);
}

#[test]
fn each_mistake_alone_gives_one_error() {
    for (i, (_, to)) in MISTAKES.iter().enumerate() {
        let errors = errors_of(&with([i]));
        assert_eq!(errors.len(), 1, "{to}: {:?}", errors.iter().map(told).collect::<Vec<_>>());
    }
}

#[test]
fn all_mistakes_are_found_at_once_in_the_order_of_the_file() {
    let errors = errors_of(&with(0..MISTAKES.len()));
    let starts: Vec<_> =
        errors.iter().filter_map(|error| error.excerpt().map(|excerpt| excerpt.span.start)).collect();
    assert!(starts.is_sorted() && starts.len() == errors.len(), "{starts:?}");
    let mut alone: Vec<_> = (0..MISTAKES.len()).flat_map(|i| all_told(&with([i]))).collect();
    alone.sort();
    assert_eq!(all_told(&with(0..MISTAKES.len())), alone);
}

#[test]
fn what_was_likely_meant_is_checked_too() {
    let text = GOOD.replace("[radio]", "[radios]").replace("tx_power_dbm", "tx_power_dbn").replace("-90.0", "nan");
    let errors: Vec<_> = errors_of(&text).iter().map(ToString::to_string).collect();
    let expected = [
        "unknown key `radios` in the scenario",
        "unknown key `tx_power_dbn` in `radio`",
        "`radio.sensitivity_dbm` is NaN; allowed: -200 to 100",
    ];
    assert_eq!(errors, expected);
}

#[test]
fn what_follows_from_a_mistake_is_no_mistake() {
    // Without the robot there would be no survey, without the node no name, and without the world nothing.
    for (from, to, expected) in [
        ("\n[[robots]]\nname = \"first\"", "\n[[robots]]\nname = 1", 1),
        ("positions_m = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]", "positions_m = 3", 1),
        ("[world.nodes.explicit]", "[world.nodes.exotic]", 1),
        ("[traffic.beacon]\ninterval_s = 1.0", "[traffic]", 1),
        ("[radio]\ntx_power_dbm = -50.0\nsensitivity_dbm = -90.0", "[radio]", 2),
        // A mesh has a file or vertices.
        (
            "[world.obstacles.shape.box]\ncenter_m = [5.0, 5.0, 0.0]\nsize_m = [2.0, 1.0, 3.0]",
            "[world.obstacles.shape.mesh]\nfile = \"none.obj\"",
            1,
        ),
    ] {
        assert_eq!(GOOD.matches(from).count(), 1, "{from}");
        let told = all_told(&GOOD.replace(from, to));
        assert_eq!(told.len(), expected, "{to}: {told:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn several_mistakes_give_the_errors_that_each_gives_alone(
        chosen in proptest::sample::subsequence((0..MISTAKES.len()).collect::<Vec<_>>(), 2..7),
    ) {
        let mut alone: Vec<_> = chosen.iter().flat_map(|i| all_told(&with([*i]))).collect();
        alone.sort();
        prop_assert_eq!(all_told(&with(chosen)), alone);
    }
}
