use std::path::Path;

use serde::Deserialize;
use sextant_kernel::SettingError;

use super::ScenarioError;
use super::deserialize::deserialize;
use super::document::Document;
use super::document::layers;

#[derive(Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Toy {
    #[serde(default)]
    seed: u64,
    size: Option<Size>,
    shape: Option<Shape>,
    #[serde(default)]
    robots: Vec<Robot>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "`[x, y]` or `[x, y, z]`")]
enum Size {
    Planar([f64; 2]),
    Spatial([f64; 3]),
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Shape {
    Disc(Disc),
    Square { side_m: f64 },
    Everything,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Disc {
    radius_m: f64,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Robot {
    name: String,
    #[serde(default)]
    speed_m_per_s: f64,
}

/// Reads `files` (name, text), the last of which is the scenario, with the flags `set`.
fn document(files: &[(&str, &str)], set: &[&str]) -> Result<Document, ScenarioError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let set: Vec<_> = set.iter().map(ToString::to_string).collect();
    let path = folder.path().join(files.last().unwrap().0);
    let document = layers::read(&path).and_then(|mut document| {
        document.override_by(&set, None, &layers::folder_of(&path))?;
        Ok(document)
    });
    let strip = |name: &str| name.replace(&format!("{}/", folder.path().display()), "");
    document
        .map(|mut document| {
            for source in &mut document.sources {
                source.name = strip(&source.name);
            }
            document
        })
        .map_err(|error| {
            let place = error.place().map(|place| strip(&place)).unwrap_or_default();
            ScenarioError::new(format!("{place} {}", strip(&error.to_string())))
        })
}

fn toy(files: &[(&str, &str)], set: &[&str]) -> Result<Toy, String> {
    let document = document(files, set).map_err(|error| error.to_string())?;
    deserialize(&document).map_err(|error| format!("{} {error}", error.place().unwrap_or_default()))
}

fn refused(text: &str) -> String {
    toy(&[("a.toml", text)], &[]).unwrap_err()
}

#[test]
fn choices_may_be_texts_or_tables() {
    let shape = |text| toy(&[("a.toml", text)], &[]).unwrap().shape;
    assert_eq!(shape("shape = \"everything\""), Some(Shape::Everything));
    assert_eq!(shape("[shape.everything]"), Some(Shape::Everything));
    assert_eq!(shape("shape.disc.radius_m = 2"), Some(Shape::Disc(Disc { radius_m: 2.0 })));
    assert_eq!(shape("[shape.square]\nside_m = 2"), Some(Shape::Square { side_m: 2.0 }));
    assert_eq!(shape("seed = 1"), None);
}

#[test]
fn errors_point_at_the_key_or_value() {
    for (text, expected) in [
        ("seed = 1\nsede = 2", "a.toml:2:1 unknown key `sede` in the scenario"),
        ("[shape.disc]\nradius = 2.0", "a.toml:2:1 unknown key `radius` in `shape.disc`"),
        ("[shape.square]\nside = 2.0", "a.toml:2:1 unknown key `side` in `shape.square`"),
        ("[shape.disk]\nradius_m = 2.0", "a.toml:1:8 unknown choice `disk` for `shape`"),
        ("shape = \"disk\"", "a.toml:1:9 unknown choice `disk` for `shape`"),
        ("\n[shape.disc]", "a.toml:2:8 `radius_m` is missing in `shape.disc`"),
        ("shape = \"disc\"", "a.toml:1:1 `radius_m` is missing in `shape.disc`"),
        ("seed = -1", "a.toml:1:8 `seed` is the integer -1; allowed: a whole number, 0 or above"),
        ("seed = 1.5", "a.toml:1:8 `seed` is the number 1.5; allowed: a whole number, 0 or above"),
        ("seed = \"x\"", "a.toml:1:8 `seed` is the text \"x\"; allowed: a whole number, 0 or above"),
        ("robots = [1]", "a.toml:1:11 `robots[0]` is the integer 1; allowed: a table"),
        ("shape.disc = [2.0]", "a.toml:1:14 `shape.disc` is an array; allowed: a table"),
        ("shape.disc.radius_m = true", "a.toml:1:23 `shape.disc.radius_m` is the boolean true; allowed: a number"),
        ("shape = 3", "a.toml:1:9 `shape` is the integer 3; allowed: one of `disc`, `square`, `everything`"),
        ("size = [1]", "a.toml:1:8 `size`: `[x, y]` or `[x, y, z]`"),
        (
            "[[robots]]\nname = \"a\"\n[[robots]]\nname = 3",
            "a.toml:4:8 `robots[1].name` is the integer 3; allowed: a text in quotes",
        ),
        ("[[robots]]\nname = \"a\"\n[[robots]]\n", "a.toml:3:1 `name` is missing in `robots[1]`"),
        ("[robots]\nname = \"a\"", "a.toml:1:2 `robots` is a table; allowed: an array"),
        (
            "[shape.disc]\nradius_m = 1\n[shape.square]\nside_m = 1",
            "a.toml:1:2 `shape`: only one of `disc`, `square` is allowed",
        ),
        ("seed = 99999999999999999999999", "a.toml:1:8 this integer does not fit into 64 bits"),
        ("seed = 1979-05-27", "a.toml:1:8 `seed` is the date 1979-05-27; allowed: a whole number, 0 or above"),
        ("seed = 1\nseed = 2", "a.toml:2:1 a.toml is not valid TOML: duplicate key"),
        ("seed = ", "a.toml:1:8 a.toml is not valid TOML: string values must be quoted, expected literal string"),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}

#[test]
fn the_seed_takes_all_64_bits() {
    assert_eq!(toy(&[("a.toml", "seed = 18446744073709551615")], &[]).unwrap().seed, u64::MAX);
    assert_eq!(toy(&[("a.toml", "seed = 0xFF_FF")], &[]).unwrap().seed, 0xFFFF);
}

#[test]
fn a_file_overrides_the_one_that_it_extends() {
    let files = [
        (
            "base.toml",
            "seed = 1\nsize = [1, 2]\n[shape.disc]\nradius_m = 1.0\n[[robots]]\nname = \"a\"\n[[robots]]\nname = \"b\"",
        ),
        ("middle.toml", "extends = \"base.toml\"\nsize = [1, 2, 3]\nshape.disc.radius_m = 2.0"),
        ("top.toml", "extends = \"middle.toml\"\nseed = 3\n[[robots]]\nname = \"c\""),
    ];
    let toy = toy(&files, &[]).unwrap();
    assert_eq!(toy.seed, 3);
    assert_eq!(toy.size, Some(Size::Spatial([1.0, 2.0, 3.0])));
    assert_eq!(toy.shape, Some(Shape::Disc(Disc { radius_m: 2.0 })));
    assert_eq!(toy.robots, [Robot { name: "c".into(), speed_m_per_s: 0.0 }]);
}

#[test]
fn a_later_choice_replaces_an_earlier_one() {
    let files = [
        ("base.toml", "[shape.disc]\nradius_m = 1.0"),
        ("top.toml", "extends = \"base.toml\"\n[shape.square]\nside_m = 4.0"),
    ];
    assert_eq!(toy(&files, &[]).unwrap().shape, Some(Shape::Square { side_m: 4.0 }));
    assert_eq!(toy(&files, &["shape.disc.radius_m=7"]).unwrap().shape, Some(Shape::Disc(Disc { radius_m: 7.0 })));
    assert_eq!(toy(&files, &["shape=everything"]).unwrap().shape, Some(Shape::Everything));
}

#[test]
fn errors_name_the_layer_that_is_wrong() {
    let base = ("base.toml", "\nseed = \"one\"");
    let top = |text| ("top.toml", text);
    let wrong = "`seed` is the text \"one\"; allowed: a whole number, 0 or above";
    assert_eq!(toy(&[base, top("extends = \"base.toml\"")], &[]).unwrap_err(), format!("base.toml:2:8 {wrong}"));
    assert!(toy(&[base, top("extends = \"base.toml\"\nseed = 2")], &[]).is_ok());
    assert_eq!(
        toy(&[base, top("extends = \"none.toml\"")], &[]).unwrap_err(),
        "top.toml:1:11 there is no file `none.toml`"
    );
    assert_eq!(
        toy(&[("base.toml", "extends = \"top.toml\""), top("extends = \"base.toml\"")], &[]).unwrap_err(),
        "base.toml:1:11 `extends` forms a circle: top.toml -> base.toml -> top.toml"
    );
    assert!(toy(&[top("extends = 3")], &[]).unwrap_err().starts_with("top.toml:1:11 `extends` is not a text"));
}

#[test]
fn flags_override_files() {
    let file = ("a.toml", "seed = 1\n[[robots]]\nname = \"a\"\n[[robots]]\nname = \"b\"");
    let toy = toy(
        &[file],
        &["seed = 9", "robots.1.speed_m_per_s=2", "robots[0].name=c", "shape.disc.radius_m=3", "size=[1,2]"],
    )
    .unwrap();
    assert_eq!(toy.seed, 9);
    assert_eq!(toy.robots[0].name, "c");
    assert_eq!(toy.robots[1].name, "b");
    assert!((toy.robots[1].speed_m_per_s - 2.0).abs() < 1e-12);
    assert_eq!(toy.shape, Some(Shape::Disc(Disc { radius_m: 3.0 })));
    assert_eq!(toy.size, Some(Size::Planar([1.0, 2.0])));
}

#[test]
fn errors_of_flags_point_into_the_flag() {
    let file = ("a.toml", "seed = 1\n[[robots]]\nname = \"a\"");
    for (flag, expected) in [
        ("seed", "setting:1:1 setting seed has no `=`"),
        ("a..b=1", "setting:1:3 setting: a key is missing here"),
        ("=1", "setting:1:1 setting: a key is missing here"),
        ("seed=", "setting:1:6 setting: `` is not a TOML value"),
        ("size=[1", "setting:1:6 setting: `[1` is not a TOML value"),
        ("seed=x", "setting:1:6 `seed` is the text \"x\"; allowed: a whole number, 0 or above"),
        ("sede=2", "setting:1:1 unknown key `sede` in the scenario"),
        ("shape.disk.radius_m=2", "setting:1:7 unknown choice `disk` for `shape`"),
        ("shape.disc.radius=2", "setting:1:12 unknown key `radius` in `shape.disc`"),
        ("robots.1.name=b", "setting:1:8 setting: `robots` has 1 entry"),
        ("robots.first.name=b", "setting:1:8 setting: `robots` has 1 entry"),
        ("shape[0].name=b", "setting:1:6 setting: `shape` is a table, not an array"),
        ("seed.x=1", "setting:1:1 `seed` is a table; allowed: a whole number, 0 or above"),
    ] {
        assert_eq!(toy(&[file], &[flag]).unwrap_err(), expected, "{flag}");
    }
}

#[test]
fn an_error_of_a_value_is_placed_by_its_path() {
    let text = "[shape.disc]\nradius_m = -1\n[[robots]]\nname = \"a\"\n[[robots]]\nname = \"b\"\nspeed_m_per_s = nan";
    let document = document(&[("a.toml", text)], &[]).unwrap();
    let place = |key: &str| document.outside(&SettingError::new(key, -1, "more")).place().unwrap();
    assert_eq!(place("shape.disc.radius_m"), "a.toml:2:12");
    assert_eq!(place("robots[1].speed_m_per_s"), "a.toml:7:17");
    assert_eq!(place("robots[0].speed_m_per_s"), "a.toml:3:1", "absent: the table that would hold it");
    assert_eq!(place("robots[1]"), "a.toml:5:1");
    assert_eq!(place("shape"), "a.toml:1:2");
    assert_eq!(place("elsewhere.x"), "a.toml:1:1");
}

#[test]
fn files_that_are_not_text_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path| {
        let message = layers::read(path).unwrap_err().to_string();
        message.replace(&folder.path().display().to_string(), "DIR")
    };
    assert_eq!(refused(&folder.path().join("none.toml")), "there is no file `DIR/none.toml`");
    assert_eq!(refused(folder.path()), "`DIR` is a folder, not a scenario");
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [0x73, 0xFF, 0xFE]).unwrap();
    assert_eq!(refused(&binary), "`DIR/binary.toml` is not UTF-8 text");
}

#[test]
fn the_merged_text_means_the_same_as_the_layers() {
    let base = ("base.toml", "size = [1, 2.5]\n[shape.square]\nside_m = 1e-6\n[[robots]]\nname = \"a \\\" b\"");
    let top = ("top.toml", "extends = \"base.toml\"\nseed = 18446744073709551615");
    let layered = document(&[base, top], &["shape={ square = { side_m = inf } }"]).unwrap();
    let expected = [
        "# Merged settings of base.toml, top.toml, --set \"shape={ square = { side_m = inf } }\"",
        "robots = [{ name = 'a \" b' }]",
        "seed = 18446744073709551615",
        "shape.square.side_m = inf",
        "size = [1, 2.5]\n",
    ];
    assert_eq!(layered.text, expected.join("\n"));
    let again = document(&[("a.toml", &layered.text)], &[]).unwrap();
    assert_eq!(again.text, layered.text, "one file is kept as it is");
    assert_eq!(deserialize::<Toy>(&again).unwrap(), deserialize::<Toy>(&layered).unwrap());
}
