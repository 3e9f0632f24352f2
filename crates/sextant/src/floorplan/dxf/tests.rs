//! Drawings that are written by hand.

use std::fs;

use super::*;

/// A drawing of groups `code value`, separated by commas, in its sections.
fn drawn(sections: &[(&str, &str)]) -> String {
    let groups = |text: &str| {
        let group = |group: &str| {
            let (code, value) = group.trim().split_once(' ').unwrap();
            format!("{code:>3}\n{value}\n")
        };
        text.split(',').filter(|group| !group.trim().is_empty()).map(group).collect::<String>()
    };
    let section = |(name, text): &(&str, &str)| format!("  0\nSECTION\n  2\n{name}\n{}  0\nENDSEC\n", groups(text));
    sections.iter().map(section).collect::<String>() + "  0\nEOF\n"
}

const IN_MM: (&str, &str) = ("HEADER", "9 $ACADVER, 1 AC1027, 9 $INSUNITS, 70 4");

fn read_text(text: &[u8], options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.dxf");
    fs::write(&path, text).unwrap();
    read(&path, options)
}

fn plan(sections: &[(&str, &str)]) -> FloorPlan {
    read_text(drawn(sections).as_bytes(), &FloorPlanOptions::default()).unwrap()
}

fn is_near(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    let off = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    let farthest_m = found.iter().zip(expected).map(off).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && farthest_m < 1e-3, "{found:?} instead of {expected:?}");
}

#[test]
fn lines_and_polylines_are_walls_in_metres() {
    let plan = plan(&[
        IN_MM,
        (
            "ENTITIES",
            "0 LINE, 8 outer, 10 0, 20 0, 11 4000, 21 0,\
             0 LWPOLYLINE, 8 inner, 90 3, 70 1, 10 1000, 20 1000, 10 2000, 20 1000, 10 2000, 20 3000,\
             0 POLYLINE, 8 outer, 66 1, 70 0, 0 VERTEX, 8 outer, 10 0, 20 5000, 0 VERTEX, 8 outer, 10 1500, 20 5000, 0 SEQEND,\
             0 TEXT, 8 outer, 1 kitchen, 0 TEXT, 8 outer, 1 bath, 0 SPLINE, 8 outer",
        ),
    ]);
    assert_eq!(plan.walls.len(), 3);
    is_near(&plan.walls[0].points_m, &[[0.0, 0.0], [4.0, 0.0]]);
    is_near(&plan.walls[1].points_m, &[[1.0, 1.0], [2.0, 1.0], [2.0, 3.0], [1.0, 1.0]]);
    is_near(&plan.walls[2].points_m, &[[0.0, 5.0], [1.5, 5.0]]);
    assert_eq!(plan.walls[1].name.as_deref(), Some("inner"));
    let notes = plan.notes.join("\n");
    for part in
        ["1 SPLINE, 2 TEXT", "all lines of 2 layers are walls: inner, outer", "in millimetres, as the drawing says"]
    {
        assert!(notes.contains(part), "{notes}");
    }
}

#[test]
fn arcs_are_short_straight_parts_within_a_centimetre() {
    let plan = plan(&[
        ("HEADER", "9 $INSUNITS, 70 6"),
        (
            "ENTITIES",
            "0 CIRCLE, 8 0, 10 1, 20 2, 40 3, 0 ARC, 8 0, 10 0, 20 0, 40 2, 50 270, 51 90,\
             0 LWPOLYLINE, 8 0, 70 0, 10 0, 20 0, 42 1, 10 4, 20 0, 0 ARC, 8 0, 10 5, 20 0, 40 2, 50 0, 51 90, 230 -1",
        ),
    ]);
    let length_m = |wall: usize| {
        let legs = plan.walls[wall].points_m.windows(2);
        legs.map(|leg| libm::hypot(leg[1][0] - leg[0][0], leg[1][1] - leg[0][1])).sum::<f64>()
    };
    let pi = std::f64::consts::PI;
    for (wall, expected_m) in [(0, 6.0 * pi), (1, 2.0 * pi), (2, 2.0 * pi), (3, pi)] {
        assert!((length_m(wall) / expected_m - 1.0).abs() < 0.01, "wall {wall}: {} m", length_m(wall));
    }
    let off = |center: [f64; 2], radius_m: f64, wall: usize| {
        let points = &plan.walls[wall].points_m;
        let middle = |leg: &[[f64; 2]]| [0, 1].map(|axis| 0.5 * (leg[0][axis] + leg[1][axis]));
        let off = |p: [f64; 2]| (libm::hypot(p[0] - center[0], p[1] - center[1]) - radius_m).abs();
        points.windows(2).map(|leg| off(middle(leg)).max(off(leg[0]))).fold(0.0, f64::max)
    };
    assert!(off([1.0, 2.0], 3.0, 0) < 0.0111 && off([0.0, 0.0], 2.0, 1) < 0.0111 && off([2.0, 0.0], 2.0, 2) < 0.0111);
    // From 270° to 90° an arc is on the right; a bulge of 1 is half a turn to the left, below its chord.
    assert!(plan.walls[1].points_m.iter().all(|[x, _]| *x > -1e-3));
    assert!(plan.walls[2].points_m.iter().all(|[_, y]| *y < 1e-3));
    // Seen from below, x goes the other way.
    is_near(&[plan.walls[3].points_m[0]], &[[-7.0, 0.0]]);
}

#[test]
fn blocks_are_drawn_where_they_are_inserted() {
    let plan = plan(&[
        ("HEADER", "9 $INSUNITS, 70 6"),
        ("TABLES", "0 TABLE, 2 LAYER, 0 LAYER, 2 off, 70 0, 62 -7, 0 ENDTAB"),
        (
            "BLOCKS",
            "0 BLOCK, 2 stub, 10 1, 20 0, 0 LINE, 8 0, 10 1, 20 0, 11 3, 21 0, 0 ENDBLK,\
             0 BLOCK, 2 two, 10 0, 20 0, 0 INSERT, 8 0, 2 stub, 10 0, 20 0, 70 2, 44 5, 0 ENDBLK",
        ),
        (
            "ENTITIES",
            "0 INSERT, 8 walls, 2 two, 10 10, 20 20, 50 90, 41 1, 42 1, 0 INSERT, 8 off, 2 stub, 10 0, 20 0,\
             0 INSERT, 8 walls, 2 gone, 10 0, 20 0, 0 LINE, 8 walls, 67 1, 10 0, 20 0, 11 1, 21 1",
        ),
    ]);
    assert_eq!(plan.walls.len(), 2);
    is_near(&plan.walls[0].points_m, &[[10.0, 20.0], [10.0, 22.0]]);
    is_near(&plan.walls[1].points_m, &[[10.0, 25.0], [10.0, 27.0]]);
    assert_eq!(
        plan.walls[0].name.as_deref(),
        Some("walls"),
        "what is on layer 0 of a block is on that of its insert"
    );
    let notes = plan.notes.join("\n");
    for part in ["hidden: off", "1 `gone`", "1 entity of paper space"] {
        assert!(notes.contains(part), "{notes}");
    }
}

#[test]
fn what_a_drawing_does_not_show_is_no_wall() {
    let sections = [
        ("HEADER", "9 $INSUNITS, 70 6"),
        ("TABLES", "0 TABLE, 2 LAYER, 0 LAYER, 2 ice, 70 1, 62 7, 0 LAYER, 2 dark, 70 0, 62 -7, 0 ENDTAB"),
        (
            "BLOCKS",
            "0 BLOCK, 2 stub, 10 0, 20 0, 0 LINE, 8 walls, 10 0, 20 0, 11 2, 21 0, 0 ENDBLK,\
             0 BLOCK, 2 other, 70 4, 10 0, 20 0, 1 other.dwg, 0 ENDBLK",
        ),
        (
            "ENTITIES",
            "0 INSERT, 8 Ice, 2 stub, 10 0, 20 0, 0 INSERT, 8 dark, 2 stub, 10 0, 20 5, 0 INSERT, 8 walls, 2 other, 10 0, 20 0,\
             0 LINE, 8 walls, 60 1, 10 0, 20 0, 11 9, 21 9",
        ),
    ];
    // What is inserted on a layer that is off keeps its own layer; on a frozen layer nothing is seen.
    let visible = plan(&sections);
    assert_eq!(visible.walls.len(), 1);
    is_near(&visible.walls[0].points_m, &[[0.0, 5.0], [2.0, 5.0]]);
    let notes = visible.notes.join("\n");
    for part in ["lines that are hidden: Ice", "1 `other`", "1 invisible entity"] {
        assert!(notes.contains(part), "{notes}");
    }
    let options = FloorPlanOptions { layers: vec!["walls".to_owned()], ..FloorPlanOptions::default() };
    assert_eq!(read_text(drawn(&sections).as_bytes(), &options).unwrap().walls.len(), 2);
}

#[test]
fn layers_and_units_are_chosen() {
    let lines = "0 LINE, 8 Walls, 10 0, 20 0, 11 10, 21 0, 0 LINE, 8 doors, 10 0, 20 0, 11 0, 21 1";
    let text = drawn(&[("ENTITIES", lines)]);
    let options = FloorPlanOptions {
        unit: Some(LengthUnit::Foot),
        layers: vec!["walls".to_owned()],
        origin_m: Some([100.0, 0.0]),
        ..FloorPlanOptions::default()
    };
    let plan = read_text(text.as_bytes(), &options).unwrap();
    assert_eq!(plan.walls.len(), 1);
    is_near(&plan.walls[0].points_m, &[[100.0, 0.0], [103.048, 0.0]]);
    assert!(plan.notes.iter().any(|note| note.contains("not chosen: doors")), "{:?}", plan.notes);
    let unknown = FloorPlanOptions { layers: vec!["roof".to_owned()], ..options };
    let error = read_text(text.as_bytes(), &unknown).unwrap_err().to_string();
    assert!(error.contains("option `layers` is roof; allowed: layers with lines: Walls, doors"), "{error}");
}

#[test]
fn units_of_surveys_are_known_and_those_of_no_building_are_named() {
    let of = |code: i64| {
        let header = format!("9 $INSUNITS, 70 {code}");
        read_text(
            drawn(&[("HEADER", &header), ("ENTITIES", "0 LINE, 8 0, 10 0, 20 0, 11 3937, 21 0")]).as_bytes(),
            &FloorPlanOptions::default(),
        )
    };
    for (code, length_m, name) in [
        (21, 1200.0, "US survey feet"),
        (22, 100.0, "US survey inches"),
        (23, 3600.0, "US survey yards"),
        (2, 1199.998, "feet"),
        (3, 6_335_987.328, "miles"),
        (9, 0.1, "mils"),
        (15, 39_370.0, "decametres"),
        (16, 393_700.0, "hectometres"),
    ] {
        let found = of(code);
        // A wall of a decimetre is shorter than thick, and one of kilometres is told.
        let Ok(plan) = found else { panic!("{code}: {found:?}") };
        assert!(plan.notes.iter().any(|note| note.contains(&format!("in {name}, as"))), "{:?}", plan.notes);
        assert!(plan.walls.is_empty() || (plan.length_m() - length_m).abs() < 0.01, "{code}: {}", plan.length_m());
    }
    for (code, said) in [
        (8, "in microinches ($INSUNITS is 8)"),
        (11, "in angstroms"),
        (20, "in parsecs"),
        (99, "$INSUNITS is 99, which"),
    ] {
        let error = of(code).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("option `unit`"), "{error}");
    }
}

#[test]
fn what_is_wrong_with_a_drawing_is_told() {
    let line = |x: &str| drawn(&[IN_MM, ("ENTITIES", &format!("0 LINE, 8 0, 10 0, 20 0, 11 {x}, 21 0"))]);
    let ring = drawn(&[
        IN_MM,
        ("BLOCKS", "0 BLOCK, 2 a, 10 0, 20 0, 0 INSERT, 8 0, 2 a, 10 0, 20 0, 0 ENDBLK"),
        ("ENTITIES", "0 INSERT, 8 0, 2 a, 10 0, 20 0"),
    ]);
    let bomb = drawn(&[
        IN_MM,
        ("BLOCKS", "0 BLOCK, 2 a, 10 0, 20 0, 0 LINE, 10 0, 20 0, 11 5, 21 5, 0 ENDBLK"),
        ("ENTITIES", "0 INSERT, 8 0, 2 a, 10 0, 20 0, 70 900000, 71 900000, 44 1, 45 1"),
    ]);
    let arc = drawn(&[IN_MM, ("ENTITIES", "0 ARC, 8 0, 10 0, 20 0, 40 1e300, 50 0, 51 90")]);
    let bulge = drawn(&[IN_MM, ("ENTITIES", "0 LWPOLYLINE, 8 0, 10 0, 20 0, 42 1, 10 1e300, 20 0")]);
    for (text, problem) in [
        (arc.into_bytes(), "an arc has a radius of 1.000e297 m: more than 1000000 corners"),
        (bulge.into_bytes(), "an arc has a radius of 5.000e296 m: more than 1000000 corners"),
        (b"AutoCAD Binary DXF\r\n\x1a\0".to_vec(), "it is a binary DXF; allowed: a DXF in text"),
        (drawn(&[("ENTITIES", "0 LINE, 8 0, 10 0, 20 0, 11 1, 21 0")]).into_bytes(), "does not say the unit"),
        (b"hello\nworld\n".to_vec(), "line 1 is no group code"),
        (Vec::new(), "it has no sections"),
        (b"  0\n".to_vec(), "it ends after the group code in line 1"),
        (line("nan").into_bytes(), "found `nan`, allowed: a finite number"),
        (line("1e400").into_bytes(), "found `1e400`, allowed: a finite number"),
        (line("1e14").into_bytes(), "is 1.000e11 m from zero; allowed: at most 1e9 m"),
        (ring.into_bytes(), "the block `a` is in blocks in blocks, or in itself"),
        (bomb.into_bytes(), "more than 1000000 corners and blocks"),
    ] {
        let error = read_text(&text, &FloorPlanOptions::default()).unwrap_err().to_string();
        assert!(error.contains(problem), "{error} instead of {problem}");
    }
    let far = read_text(line("5e9").as_bytes(), &FloorPlanOptions::default()).unwrap();
    assert!(far.notes.iter().any(|note| note.contains("5000 km away from zero")), "{:?}", far.notes);
    let empty = drawn(&[IN_MM, ("ENTITIES", "0 TEXT, 1 hall")]);
    assert!(read_text(empty.as_bytes(), &FloorPlanOptions::default()).unwrap().walls.is_empty());
}
