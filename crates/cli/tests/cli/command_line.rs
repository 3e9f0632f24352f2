//! Arguments and standard output of the program.

use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin_cmd;

use crate::program::{Said, sextant};

fn stdout(words: &[&str]) -> String {
    sextant().args(words).output().expect("the program starts").printed()
}

#[test]
fn wrong_usage_exits_with_two_and_help_with_zero() {
    let code = |words: &[&str], code: i32| {
        cargo_bin_cmd!("sextant").args(words).assert().code(code);
    };
    code(&[], 2);
    code(&["fly"], 2);
    code(&["run"], 2);
    code(&["run", "a.toml", "--seed", "-1"], 2);
    code(&["run", "a.toml", "--threads", "0"], 2);
    code(&["run", "a.toml", "--set", "seed"], 2);
    code(&["run", "a.toml", "--format", "xml"], 2);
    code(&["check"], 2);
    code(&["recover", "a.mcap"], 2);
    code(&["completions", "basic"], 2);
    code(&["--help"], 0);
    code(&["run", "--help"], 0);
    code(&["--version"], 0);
}

#[test]
fn files_that_do_not_exist_exit_with_two() {
    for words in [
        &["run", "none.toml"][..],
        &["check", "none.toml"],
        &["inspect", "none.mcap"],
        &["recover", "none.mcap", "--out", "good.mcap"],
        &["map", "none.mcap"],
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = cargo_bin_cmd!("sextant").args(words).current_dir(folder.path()).output().unwrap();
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{words:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains("none.") && !message.contains("panicked"), "{message}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "{words:?} leaves nothing behind");
    }
}

#[test]
fn completions_of_all_shells_contain_all_commands() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = stdout(&["completions", shell]);
        for command in ["run", "map", "check", "inspect", "recover", "schema", "completions", "man"] {
            assert!(script.contains(command), "{shell}: {command}");
        }
    }
}

#[test]
fn the_manual_page_has_every_command_and_flag() {
    let page = stdout(&["man"]);
    assert!(page.contains(".TH sextant 1"), "{page}");
    for command in ["RUN", "MAP", "CHECK", "INSPECT", "RECOVER", "SCHEMA", "COMPLETIONS", "MAN"] {
        assert!(page.contains(&format!(".SH \"SEXTANT {command}\"")), "{command}");
    }
    for flag in ["out", "summary", "seed", "threads", "set", "format", "quiet", "profile", "truth"] {
        assert!(page.contains(&format!("\\-\\-{flag}")), "{flag}");
    }
    assert!(page.contains(".SH \"EXIT STATUS\""));
}

#[test]
fn each_command_has_a_manual_page_of_its_own() {
    for (words, title, flags) in [
        (&["man", "run"][..], ".TH sextant-run 1", &["summary", "pcap"][..]),
        (&["man", "antenna"], ".TH sextant-antenna 1", &[]),
        (&["man", "antenna", "show"], ".TH sextant-antenna-show 1", &["force"]),
    ] {
        let page = stdout(words);
        assert!(page.contains(title) && page.contains("sextant(1)"), "{words:?}: {page}");
        for flag in flags {
            assert!(page.contains(&format!("\\-\\-{flag}")), "{words:?}: {flag}");
        }
        assert!(!page.contains("SEXTANT MAP"), "{words:?}: only one command");
    }
    assert!(stdout(&["man", "antenna"]).contains("sextant\\-antenna\\-show(1)"), "the parts of a command are named");
}

#[test]
fn a_manual_page_of_an_unknown_command_is_refused_with_those_that_there_are() {
    for (words, expected) in [
        (&["man", "rum"][..], "`sextant` has no command `rum`; it has `init`, `run`,"),
        (&["man", "run", "fast"], "`run` has no commands of its own, but `fast` was found after it"),
    ] {
        let message = cargo_bin_cmd!("sextant").args(words).output().unwrap().refusal();
        assert!(message.contains(expected), "{words:?}: {message}");
    }
}

#[test]
fn the_schema_documents_every_key() {
    let schema: serde_json::Value = serde_json::from_str(&stdout(&["schema"])).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let properties = schema["properties"].as_object().unwrap();
    let keys: Vec<_> = properties.keys().map(String::as_str).collect();
    for key in
        ["extends", "name", "seed", "world", "radio", "channel", "mac", "traffic", "reception", "robots", "maps"]
    {
        assert!(keys.contains(&key), "{key} is not in {keys:?}");
    }
    let mut undocumented = Vec::new();
    find_undocumented(&schema, "", &mut undocumented);
    // What a file without `extends` needs is said apart, by key alone.
    undocumented.retain(|path| !path.starts_with("/$defs/Whole"));
    assert!(undocumented.is_empty(), "keys without a description: {undocumented:#?}");
}

/// Collects the properties without a description.
fn find_undocumented(schema: &serde_json::Value, path: &str, found: &mut Vec<String>) {
    match schema {
        serde_json::Value::Object(object) => {
            // The only property of a choice is described by the choice.
            let is_choice = object.contains_key("description") && object.get("required").is_some();
            if let Some(properties) = object.get("properties").and_then(|properties| properties.as_object()) {
                for (key, property) in properties {
                    if property.get("description").is_none() && !(is_choice && properties.len() == 1) {
                        found.push(format!("{path}/{key}"));
                    }
                }
            }
            for (key, value) in object {
                find_undocumented(value, &format!("{path}/{key}"), found);
            }
        }
        serde_json::Value::Array(items) => items.iter().for_each(|item| find_undocumented(item, path, found)),
        _ => {}
    }
}

#[test]
fn a_closed_standard_output_is_not_an_error() {
    for words in [&["schema"][..], &["man"], &["completions", "bash"]] {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("sextant"))
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{words:?}");
    }
}
