//! `sextant map` with what the user knows of the places of nodes.

use std::path::Path;

use crate::program::{Said, call, folder, unwrapped};

/// A log of two nodes and three stops.
fn log() -> tempfile::TempDir {
    folder(&[
        ("stops.csv", "stop,t_s,x_m,y_m\n0,0,0,0\n1,1,2,0\n2,2,4,1\n"),
        ("receptions.csv", "node,stop,received,sent\na,0,3,5\na,1,5,5\nb,1,2,5\nb,2,5,5\n"),
        ("area.csv", "x_m,y_m\n-1,-1\n5,-1\n5,3\n"),
        ("line.csv", "x_m,y_m\n0,0\n1,1\n2,2\n"),
    ])
}

/// Exit code and standard error of `sextant map . WORDS` in `folder`.
fn map(folder: &Path, words: &[&str]) -> (i32, String) {
    let (code, _, message) = call(folder, &[&["map", "."], words].concat()).all();
    (code, unwrapped(&message))
}

#[test]
fn an_algorithm_that_cannot_use_an_area_is_rejected_and_those_that_can_are_named() {
    let folder = log();
    for words in [["--area", "-1,-1,5,3"], ["--area", "area.csv"], ["--near-stops", "2"]] {
        let (code, message) = map(folder.path(), &[&["--algorithm", "self-calibrated"], &words[..]].concat());
        assert_eq!(code, 2, "{message}");
        assert!(message.contains(": `self-calibrated` cannot use"), "{message}");
        assert!(message.contains("algorithms that can: `auto`, `link-model`"), "{message}");
    }
}

#[test]
fn an_invalid_area_or_length_is_rejected_with_what_was_found() {
    let folder = log();
    for (words, expected) in [
        (["--area", "5,0,1,3"], "the area is `5,0,1,3`; allowed: four numbers x0,y0,x1,y1"),
        (["--area", "1,2,3"], "the area is `1,2,3`; allowed: four numbers"),
        (["--area", "1,2,3,nan"], "allowed: four numbers"),
        (["--area", "nowhere.csv"], "the area is `nowhere.csv`, and there is no such file"),
        (["--area", "line.csv"], "a polygon without area"),
        (["--area", "receptions.csv"], "receptions.csv"),
        (["--near-stops", "0"], "the distance to the stops is 0; allowed: a finite number above 0"),
        (["--near-stops", "-3"], "the distance to the stops is -3"),
    ] {
        let (code, message) = map(folder.path(), &words);
        assert_eq!(code, 2, "{message}");
        assert!(message.contains(expected), "{words:?}: {message}");
    }
}
