//! Bad input: each error names the key, the value found and the values allowed.

use std::path::Path;

use sextant_channel::{ChannelConfig, ChannelLaw, Obstacle, ObstacleConfig};
use sextant_kernel::{Files, SettingError};

fn obstacle(text: &str) -> Result<Obstacle, SettingError> {
    toml::from_str::<ObstacleConfig>(text).unwrap_or_else(|error| panic!("{error}")).try_into()
}

fn channel(text: &str) -> Result<ChannelLaw, SettingError> {
    let config = toml::from_str::<ChannelConfig>(text).unwrap_or_else(|error| panic!("{error}"));
    ChannelLaw::try_from(config)
}

#[track_caller]
fn assert_flaw<T: std::fmt::Debug>(result: Result<T, SettingError>, key: &str, words: &str) {
    let error = result.expect_err("a flaw");
    assert_eq!(error.key, key, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

const TETRAHEDRON: &str = "vertices_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]";

#[test]
fn a_good_obstacle_of_each_shape_is_read() {
    for (shape, volume) in [
        ("box = {center_m = [0, 6], size_m = [4.5, 4, 3], yaw_deg = 30}", "box"),
        ("cylinder = {base_m = [0, 6, 1], radius_m = 2, height_m = 1}", "cylinder"),
        ("prism = {corners_m = [[0, 0], [1, 0], [0, 1], [0, 0]], height_m = 3}", "prism"),
        ("convex = {points_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1], [1, 0, 0]]}", "convex"),
        (&format!("mesh = {{{TETRAHEDRON}, triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}}"), "mesh"),
    ] {
        let good = obstacle(&format!("material = \"concrete\"\nshape.{shape}")).unwrap();
        assert!((good.absorption_per_m() - 4.6).abs() < 1e-12);
        assert!(good.mesh().1.len() >= 4, "{volume}");
    }
}

#[test]
fn an_obstacle_without_volume_is_rejected_with_its_key() {
    for (shape, key, words) in [
        ("box = {center_m = [0, 0], size_m = [1, 0, 3]}", "shape.box.size_m", "[1.0, 0.0, 3.0]"),
        ("box = {center_m = [0, 0], size_m = [1, -2, 3]}", "shape.box.size_m", "-2.0"),
        ("box = {center_m = [0, 0], size_m = [1, nan, 3]}", "shape.box.size_m", "NaN"),
        ("box = {center_m = [0, inf], size_m = [1, 2, 3]}", "shape.box.center_m", "inf"),
        ("box = {center_m = [0, 0], size_m = [1, 2, 3], yaw_deg = nan}", "shape.box.yaw_deg", "NaN"),
        ("cylinder = {base_m = [0, 0], radius_m = 0, height_m = 1}", "shape.cylinder.radius_m", "is 0"),
        ("cylinder = {base_m = [0, 0], radius_m = 1, height_m = -1}", "shape.cylinder.height_m", "is -1"),
        ("cylinder = {base_m = [nan, 0], radius_m = 1, height_m = 1}", "shape.cylinder.base_m", "NaN"),
        ("prism = {corners_m = [], height_m = 1}", "shape.prism.corners_m", "0 different corners"),
        ("prism = {corners_m = [[0, 0], [1, 1]], height_m = 1}", "shape.prism.corners_m", "2 different corners"),
        ("prism = {corners_m = [[0, 0], [1, 1], [3, 3]], height_m = 1}", "shape.prism.corners_m", "area of 0"),
        (
            "prism = {corners_m = [[0, 0], [4, 0], [1, 1], [0, 4]], height_m = 1}",
            "shape.prism.corners_m",
            "not convex",
        ),
        ("prism = {corners_m = [[0, 0], [1, 0], [0, nan]], height_m = 1}", "shape.prism.corners_m", "NaN"),
        ("prism = {corners_m = [[0, 0], [1, 0], [0, 1]], height_m = 0}", "shape.prism.height_m", "is 0"),
        (
            "prism = {corners_m = [[0, 0], [1, 0], [0, 1]], bottom_m = inf, height_m = 1}",
            "shape.prism.bottom_m",
            "inf",
        ),
        ("convex = {points_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}", "shape.convex.points_m", "3 different points"),
        ("convex = {points_m = [[0, 0], [1, 0], [0, 1], [1, 1], [2, 3]]}", "shape.convex.points_m", "four"),
        ("convex = {points_m = [[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]]}", "shape.convex.points_m", "four"),
        ("convex = {points_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, nan]]}", "shape.convex.points_m", "point 3"),
    ] {
        assert_flaw(obstacle(&format!("material = \"brick\"\nshape.{shape}")), key, words);
    }
}

#[test]
fn a_star_that_always_turns_left_is_not_convex() {
    let tips: Vec<_> = (0..5)
        .map(|i| (f64::from(i) * 0.8 * std::f64::consts::PI).sin_cos())
        .map(|(s, c)| format!("[{c}, {s}]"))
        .collect();
    let text = format!("material = \"brick\"\nshape.prism = {{corners_m = [{}], height_m = 1}}", tips.join(", "));
    assert_flaw(obstacle(&text), "shape.prism.corners_m", "not convex");
}

#[test]
fn a_mesh_that_is_not_closed_is_rejected() {
    let mesh =
        |triangles: &str| obstacle(&format!("material = \"brick\"\nshape.mesh = {{{TETRAHEDRON}, {triangles}}}"));
    assert_flaw(mesh("triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2]]"), "shape.mesh.triangles", "open or twisted");
    assert_flaw(
        mesh("triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 3, 2]]"),
        "shape.mesh.triangles",
        "edge from (",
    );
    assert_flaw(
        mesh("triangles = [[0, 2, 1], [0, 1, 7], [0, 3, 2], [1, 2, 3]]"),
        "shape.mesh.triangles",
        "names vertex 7 of 4",
    );
    assert_flaw(mesh("triangles = []"), "shape.mesh.triangles", "volume of 0");
    // Both sides of one triangle: closed, but flat.
    assert_flaw(mesh("triangles = [[0, 1, 2], [0, 2, 1]]"), "shape.mesh.triangles", "volume of 0");
    assert_flaw(mesh("file = \"a.obj\""), "shape.mesh.file", "conflicts with");
    assert_flaw(
        obstacle(&format!("material = \"brick\"\nshape.mesh = {{{TETRAHEDRON}}}")),
        "shape.mesh.triangles",
        "absent",
    );
    assert_flaw(obstacle("material = \"brick\"\nshape.mesh = {}"), "shape.mesh.vertices_m", "absent");
    assert_flaw(
        obstacle("material = \"brick\"\nshape.mesh = {vertices_m = [[0, 0, inf]], triangles = []}"),
        "shape.mesh.triangles",
        "vertex 0",
    );
}

#[test]
fn errors_in_a_mesh_file_name_their_lines() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mesh_files");
    std::fs::create_dir_all(&folder).unwrap();
    let read = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).unwrap();
        let config = format!("absorption_per_m = 1\nshape.mesh.file = \"{name}\"");
        Obstacle::read(toml::from_str(&config).unwrap(), &Files::of_folder(&folder))
    };
    let vertices = "# a tetrahedron\no t\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n";
    let good =
        read("good.obj", &format!("{vertices}f 1 3 2\nf 1//1 2//1 4//1\nf -4/1/1 -1/1/1 -2/1/1\nf 2 3 4\n")).unwrap();
    let centre = sextant_channel::Position::new(0.2, 0.2, 0.2);
    assert!(good.shape().contains(centre));
    assert_flaw(read("word.obj", "v 0 0 zero\n"), "shape.mesh.file", "line 1: `zero`");
    assert_flaw(read("short.obj", "v 0 0\n"), "shape.mesh.file", "line 1: a vertex");
    assert_flaw(read("two.obj", &format!("{vertices}f 1 2\n")), "shape.mesh.file", "line 8: a face with 2");
    assert_flaw(read("far.obj", &format!("{vertices}f 1 2 5\n")), "shape.mesh.file", "line 8: corner `5`");
    assert_flaw(read("zero.obj", &format!("{vertices}f 0 1 2\n")), "shape.mesh.file", "line 8: corner `0`");
    assert_flaw(read("open.obj", &format!("{vertices}f 1 2 3\n")), "shape.mesh.file", "open or twisted");
    let missing = toml::from_str("absorption_per_m = 1\nshape.mesh.file = \"missing.obj\"").unwrap();
    assert_flaw(Obstacle::read(missing, &Files::of_folder(&folder)), "shape.mesh.file", "cannot be read");
}

#[test]
fn exactly_one_of_material_and_absorption_is_allowed() {
    let cube = "shape.box = {center_m = [0, 0], size_m = [1, 1, 1]}";
    let with = |line: &str| obstacle(&format!("{line}\n{cube}"));
    assert_flaw(with("material = \"concret\""), "material", "\"concrete\", \"itu-concrete\", \"brick\"");
    assert_flaw(with(""), "material", "absorption_per_m");
    assert_flaw(with("material = \"brick\"\nabsorption_per_m = 2"), "absorption_per_m", "either");
    assert_flaw(with("absorption_per_m = -1"), "absorption_per_m", "is -1");
    assert_flaw(with("absorption_per_m = nan"), "absorption_per_m", "NaN");
    assert!(with("absorption_per_m = 0").is_ok());
}

#[test]
fn a_bad_channel_is_rejected_with_its_key() {
    for (text, key) in [
        ("", "environment"),
        ("path_loss.log_distance = {}", "path_loss.log_distance.exponent"),
        ("path_loss.log_distance.exponent = -2", "path_loss.log_distance.exponent"),
        (
            "path_loss.log_distance = {exponent = 2, reference_distance_m = 0}",
            "path_loss.log_distance.reference_distance_m",
        ),
        ("path_loss.log_distance = {exponent = 2, min_distance_m = -1}", "path_loss.log_distance.min_distance_m"),
        ("path_loss.log_distance.exponent = 2\nshadowing = {}", "shadowing.sigma_db"),
        ("environment = \"suburban\"\nshadowing.sigma_db = -1", "shadowing.sigma_db"),
        ("environment = \"suburban\"\nshadowing.sigma_db = nan", "shadowing.sigma_db"),
        (
            "environment = \"suburban\"\nshadowing.correlation.spatial.distance_m = 0",
            "shadowing.correlation.spatial.distance_m",
        ),
        ("environment = \"suburban\"\nmax_range_m = 0", "max_range_m"),
        ("environment = \"suburban\"\nmax_range_m = nan", "max_range_m"),
    ] {
        assert_flaw(channel(text), key, "allowed");
    }
}

#[test]
fn a_good_channel_is_read_in_each_way_of_writing_it() {
    for text in [
        "environment = \"suburban\"",
        "environment = \"heavy-tree\"\nmax_range_m = 10.0\nobstacles_attenuate = false",
        "environment = \"light-tree\"\nshadowing.correlation = \"per_link\"",
        "path_loss.log_distance.exponent = 2.0",
        "[path_loss.log_distance]\nexponent = 2.7\n[shadowing]\nsigma_db = 4\ncorrelation = \"per_packet\"",
        "environment = \"suburban\"\n[shadowing]\ncorrelation = {spatial = {distance_m = 5}}",
    ] {
        let read = channel(text);
        assert!(read.is_ok(), "{text}: {read:?}");
    }
    for text in
        ["environment = \"city\"", "max_range = 3", "shadowing.correlation = \"per_day\"", "path_loss.log = 1"]
    {
        assert!(toml::from_str::<ChannelConfig>(text).is_err(), "{text}");
    }
}

#[test]
fn bad_millimetre_wave_settings_are_rejected_with_their_key() {
    let close_in = |text: &str| channel(&format!("path_loss.close_in = {{ {text} }}"));
    assert!(close_in("carrier_ghz = 60, exponent = 2, gas = \"sea_level\"").is_ok());
    assert!(channel("environment = \"office-73-nlos\"\npath_loss.close_in = { gas = \"sea_level\" }").is_ok());
    assert_flaw(close_in("exponent = 2"), "path_loss.close_in.carrier_ghz", "absent");
    assert_flaw(close_in("carrier_ghz = 60"), "path_loss.close_in.exponent", "absent");
    assert_flaw(close_in("carrier_ghz = 0, exponent = 2"), "path_loss.close_in.carrier_ghz", "0.1 to 1000");
    assert_flaw(
        close_in("carrier_ghz = 140, exponent = 2, gas = \"sea_level\""),
        "path_loss.close_in.gas",
        "at most 100 GHz",
    );
    assert_flaw(
        close_in("carrier_ghz = 60, exponent = 2, gas = { db_per_km = -1 }"),
        "path_loss.close_in.gas.db_per_km",
        "is -1",
    );
    let reflections = |text: &str| channel(&format!("environment = \"suburban\"\nreflections = {{ {text} }}"));
    assert_flaw(reflections("loss_db = -1"), "reflections.loss_db", "is -1");
    assert_flaw(reflections("loss_db = 1, ground_z_m = inf"), "reflections.ground_z_m", "inf");
    assert_flaw(reflections("loss_db = 1, most = 0"), "reflections.most", "1 to 255");
}
