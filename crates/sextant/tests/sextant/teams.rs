//! Teams of robots: an area is divided among them, and their maps are stitched.

use sextant::scenario::Scenario;
use sextant::summary::{MapSummary, Summary};
use sextant_kernel::Unwatched;

const TEXT: &str = include_str!("../../../../scenarios/teams/size.toml");

/// The shipped scenario in a third of its area, with these settings.
fn scenario(settings: &[(&str, &str)]) -> Scenario {
    let smaller = [
        ("world.nodes.random.count", "170"),
        ("world.nodes.random.region.rectangle.max_m", "[24.0, 22.0]"),
        ("team.controller.s_path.region.rectangle.max_m", "[24.0, 22.0]"),
    ];
    let shipped = Scenario::parse(TEXT).expect("a good scenario");
    smaller
        .iter()
        .chain(settings)
        .fold(shipped, |scenario, (key, value)| scenario.with(key, value).expect("a good setting"))
}

fn run(settings: &[(&str, &str)]) -> Summary {
    sextant::run(&scenario(settings), &mut (), &Unwatched).expect("a run").summary().clone()
}

fn map<'a>(summary: &'a Summary, name: &str) -> &'a MapSummary {
    summary.maps.iter().find(|map| map.name.as_deref() == Some(name)).expect("the map")
}

fn error_m(map: &MapSummary) -> f64 {
    map.position_error_m.expect("an error").mean
}

#[test]
fn robots_with_unknown_frames_make_one_map_together() {
    let summary = run(&[("team.robots", "3")]);
    let robots = &summary.gathering.as_ref().expect("a survey").robots;
    let names: Vec<&str> = robots.iter().map(|robot| robot.name.as_str()).collect();
    assert_eq!(names, ["surveyor-1", "surveyor-2", "surveyor-3"]);
    let times: Vec<f64> = robots.iter().map(|robot| robot.duration_s.expect("a time")).collect();
    let (least, most) =
        (times.iter().copied().fold(f64::INFINITY, f64::min), times.iter().copied().fold(0.0, f64::max));
    assert!(most < 1.35 * least, "{times:?}");
    let (stitched, apart) = (map(&summary, "stitched"), map(&summary, "apart"));
    let stitching = &stitched.learned.keys["stitching"];
    assert_eq!(stitching["joined"], 3, "{stitching:#}");
    assert!(error_m(stitched) < 0.6 && error_m(apart) > 5.0, "{} m, {} m", error_m(stitched), error_m(apart));
    assert!(!apart.learned.keys.contains_key("stitching") && apart.posterior_bound_m.is_none());
    // The first robot has the frame of the map.
    assert_eq!(stitching["robots"][0]["offset_m"], serde_json::json!([0.0, 0.0, 0.0]));
    assert!(stitching["robots"][2]["shared_nodes"].as_u64().expect("a number") > 20);
}

#[test]
fn robots_that_know_where_they_are_keep_their_frames() {
    let alone = run(&[("team.robots", "1")]);
    let (stitched, apart) = (map(&alone, "stitched"), map(&alone, "apart"));
    assert_eq!(stitched.position_error_m, apart.position_error_m);
    assert!(!stitched.learned.keys.contains_key("stitching"));
    let shared = run(&[("team.robots", "2"), ("team.frames", "shared")]);
    let (stitched, apart) = (map(&shared, "stitched"), map(&shared, "apart"));
    assert_eq!((stitched.position_error_m, stitched.coverage_95), (apart.position_error_m, apart.coverage_95));
    let robots = &stitched.learned.keys["stitching"]["robots"];
    assert!(robots[0]["known"] == true && robots[1]["known"] == true, "{robots:#}");
    // Whoever wants to know what the nodes tell says that no frame is known.
    let settings = [("team.robots", "2"), ("team.frames", "shared"), ("maps.0.stitch.known", "[]")];
    let found = run(&settings);
    let found = map(&found, "stitched");
    assert_eq!(found.learned.keys["stitching"]["robots"][1]["known"], false);
    assert_ne!(found.position_error_m, apart.position_error_m);
}

#[test]
fn a_robot_with_a_frame_of_its_own_is_joined_to_those_that_know_theirs() {
    // Of three robots of `[[robots]]` only the second one has a frame of its own.
    let robot = |name: &str, x_m: u32, frame: &str| {
        format!(
            "{{ name = \"{name}\", start_m = [{x_m}, 0], {frame} controller = {{ s_path = {{ lane_spacing_m = 2.0, \
             stop_spacing_m = 2.0, region = {{ rectangle = {{ min_m = [{x_m}, 0], max_m = [{}, 22] }} }} }} }} }}",
            x_m + 12
        )
    };
    let apart = "frame = { offset_m = [30, -7], turn_deg = 100, mirrored = true },";
    let robots = format!("[{}, {}, {}]", robot("a", 0, ""), robot("b", 6, apart), robot("c", 12, ""));
    let (before, team) = TEXT.split_once("[team]").expect("a team");
    let maps = &team[team.find("[[maps]]").expect("maps")..team.find("[sweep]").expect("a sweep")];
    let scenario = Scenario::parse(&format!("robots = {robots}\n{before}{maps}")).expect("a good scenario");
    let smaller = scenario
        .with("world.nodes.random.count", 170)
        .and_then(|scenario| scenario.with("world.nodes.random.region.rectangle.max_m", "[24.0, 22.0]"));
    let run = sextant::run(&smaller.expect("good settings"), &mut (), &Unwatched).expect("a run");
    let summary = run.summary();
    let stitched = map(summary, "stitched");
    let robots = &stitched.learned.keys["stitching"]["robots"];
    let known: Vec<bool> = (0..3).map(|robot| robots[robot]["known"] == true).collect();
    assert_eq!((known.as_slice(), &robots[1]["joined"]), (&[true, false, true][..], &true.into()), "{robots:#}");
    let errors_m = [stitched, map(summary, "apart")].map(error_m);
    assert!(errors_m[0] < 0.4 && errors_m[1] > 2.0 * errors_m[0], "{errors_m:?} m");
}

#[test]
fn teams_that_cannot_be_are_refused_at_their_keys() {
    let robot = "[{ name = \"surveyor-2\", start_m = [0, 0], controller = { waypoints = { places_m = [[1, 1]] } } }]";
    let shipped = Scenario::parse(TEXT).expect("a good scenario");
    for (key, value, expected) in [
        ("team.robots", "0", "`team.robots` is 0; allowed: 1 to 256"),
        ("team.robots", "257", "`team.robots` is 257; allowed: 1 to 256"),
        ("team.overlap_m", "-1", "`team.overlap_m` is -1"),
        ("team.name", "\"a b\"", "`team.name` is `a b-1`"),
        ("team.partition.balance", "\"luck\"", "luck"),
        ("team.controller.s_path.lane_spacing_m", "0", "`team.controller.s_path.lane_spacing_m` is 0"),
        ("robots", robot, "`team.name` is `surveyor-2`, the name of a node or of an earlier robot"),
        ("maps", "[{ stitch = {}, algorithm = { centroid = {} } }]", "`maps[0].stitch`"),
        ("maps.0.stitch.scale", "true", "unknown key `scale`"),
        (
            "maps.0.stitch.known",
            "[\"surveyor-9\"]",
            "`maps[0].stitch.known` is `surveyor-9`; allowed: names of robots",
        ),
    ] {
        let refused = shipped.with(key, value).map(drop).expect_err(key).to_string();
        assert!(refused.contains(expected), "{key}={value}: {refused}");
    }
    let wide = shipped.with("team.controller.s_path.stop_spacing_m", 100).expect("few stops");
    let refused = wide.with("team.robots", 100).map(drop).expect_err("too many robots").to_string();
    assert!(refused.contains("one for each stop of the whole path"), "{refused}");
    let paths =
        TEXT.replace("[team.controller.s_path]", "[team.controller.waypoints]\nplaces_m = [[1, 1]]\n[unused]");
    let paths = paths.split("[unused]").next().expect("the text before it");
    let refused = Scenario::parse(paths).map(drop).expect_err("no region").to_string();
    assert!(refused.contains("`team.controller` is a path that is not over a region"), "{refused}");
    let no_area = TEXT.replace("[team.controller.s_path]", "[team.controller.automated_s]\n[unused]");
    let no_area = no_area.split("[unused]").next().expect("the text before it");
    let refused = Scenario::parse(no_area).map(drop).expect_err("no area").to_string();
    assert!(refused.contains("team.controller.automated_s.area"), "{refused}");
}

#[test]
fn one_robot_without_a_team_has_nothing_to_stitch() {
    let smoke = Scenario::parse(include_str!("../../../../scenarios/smoke.toml")).expect("a good scenario");
    let refused = smoke.with("maps.0.stitch", "{}").map(drop).expect_err("one robot").to_string();
    assert!(refused.contains("maps[0].stitch") && refused.contains("one robot that surveys"), "{refused}");
    let world = smoke.with("robots.0.frame.turn_deg", 10).expect("a frame");
    assert!(!world.config().robots[0].frame.is_world());
    let refused = smoke.with("robots.0.frame.turn_deg", 400).map(drop).expect_err("too far").to_string();
    assert!(refused.contains("`robots[0].frame.turn_deg` is 400; allowed: -360 to 360"), "{refused}");
}
