//! The crate alone maps a log: what only files and obstacles need is behind Cargo features.

use std::process::Command;

/// The crates that this one depends on with `features` alone.
fn dependencies(features: &str) -> String {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--package", "sextant-mapper", "--no-default-features", "--features", features])
        .args(["--edges", "normal", "--prefix", "none", "--offline", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs, as it runs this test");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("names of crates")
}

#[test]
fn without_features_no_settings_library_and_no_geometry_library_is_needed() {
    let named = |tree: &str| ["serde ", "schemars ", "parry3d-f64 "].map(|name| tree.contains(&format!("\n{name}")));
    assert_eq!(named(&dependencies("")), [false; 3]);
    assert_eq!(named(&dependencies("config")), [true, false, false]);
    assert_eq!(named(&dependencies("schema")), [true, true, false]);
    assert_eq!(named(&dependencies("obstacles")), [false, false, true]);
}
