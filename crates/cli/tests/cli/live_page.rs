//! The live view in a browser, asked as its page does.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command};
use std::thread;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{Said, scenario, sextant, signal};

/// A page that a program shows.
struct Page {
    child: Child,
    host: String,
    folder: String,
    stderr: BufReader<std::process::ChildStderr>,
}

impl Page {
    fn of(command: &mut Command) -> Self {
        let mut child = command.spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("http://") {
            line.clear();
            assert!(stderr.read_line(&mut line).unwrap() > 0, "it ended early");
        }
        let address = line.split_whitespace().find_map(|word| word.strip_prefix("http://")).unwrap();
        let (host, folder) = address.trim_end_matches([';', '.', ',']).split_once('/').unwrap();
        Self { child, host: host.to_owned(), folder: format!("/{folder}"), stderr }
    }

    /// Head and body of the answer to a request of `what` on the server.
    fn asked(&self, method: &str, what: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let host = &self.host;
        write!(stream, "{method} {what} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: 0\r\n\r\n")
            .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.to_owned(), body.to_owned())
    }

    fn json(&self, method: &str, what: &str) -> Value {
        let (head, body) = self.asked(method, &format!("{}{what}", self.folder));
        assert!(head.starts_with("HTTP/1.1 200"), "{what}: {head}");
        serde_json::from_str(&body).unwrap()
    }

    /// The state when `done` holds.
    fn eventually(&self, done: impl Fn(&Value) -> bool) -> Value {
        for _ in 0..600 {
            let state = self.json("GET", "state");
            if done(&state) {
                return state;
            }
            thread::sleep(Duration::from_millis(50));
        }
        panic!("it never was: {}", self.json("GET", "state"));
    }
}

fn run(out: &Path, flags: &[&str]) -> Command {
    let mut command = sextant();
    command.arg("run").arg(scenario("smoke.toml")).arg("--out").arg(out).args(flags);
    command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped());
    command
}

#[test]
fn a_page_shows_a_run_from_its_first_stop_to_its_end_and_the_recording_is_the_same() {
    let folder = TempDir::new().unwrap();
    let [live, plain] = ["live.mcap", "plain.mcap"].map(|name| folder.path().join(name));
    let mut page = Page::of(&mut run(&live, &["--live", "--port", "0", "--paused", "--speed", "50"]));
    let (head, html) = page.asked("GET", &page.folder);
    assert!(head.contains("text/html") && head.contains("no-store"), "{head}");
    assert!(
        html.contains("<html lang=\"en\" data-live>") && html.contains("connect-src &#39;self&#39;")
            || html.contains("connect-src 'self'")
    );
    assert_eq!(
        page.json("GET", "state")["pace"],
        serde_json::json!({ "is_paused": true, "speed": 50.0, "time_s": 0.0 })
    );
    assert_eq!(page.json("POST", "resume")["pace"]["is_paused"], false);
    // Half of the survey: there is a map of the stops so far.
    let mapped =
        |page: &Page| page.json("GET", "document")["world"]["maps"].as_array().is_some_and(|maps| maps.len() == 1);
    page.eventually(|state| state["document"].as_u64() > Some(0) && mapped(&page));
    let state = page.json("POST", "pause");
    assert!(state["pace"]["time_s"].as_f64().unwrap() < 219.0, "{state}");
    assert_eq!(page.json("POST", "speed/max")["pace"]["speed"], Value::Null);
    page.json("POST", "resume");
    let end = page.eventually(|state| state["is_over"] == true);
    assert_eq!(end["news"], Value::Null);
    let document = page.json("GET", "document");
    let summary: Value = serde_json::from_str(document["summary"].as_str().unwrap()).unwrap();
    assert_eq!(summary["gathering"]["stops"], 100);
    assert_eq!(document["kind"], "run");
    let mut rest = String::new();
    page.stderr.read_to_string(&mut rest).unwrap();
    assert!(page.child.wait().unwrap().success(), "{rest}");
    assert!(run(&plain, &["--quiet"]).status().unwrap().success());
    assert!(fs::read(live).unwrap() == fs::read(plain).unwrap());
}

#[test]
fn who_does_not_know_the_word_in_the_address_gets_nothing() {
    let folder = TempDir::new().unwrap();
    let mut page = Page::of(&mut run(&folder.path().join("a.mcap"), &["--live", "--port", "0", "--paused"]));
    for what in ["/", "/state", "/document", "/0123456789abcdef0123456789abcdef/", "/../../etc/passwd"] {
        assert!(page.asked("GET", what).0.starts_with("HTTP/1.1 404"), "{what}");
    }
    let inside = |what: &str| format!("{}{what}", page.folder);
    for what in ["../../etc/passwd", "run.mcap", "speed/10"] {
        assert!(page.asked("GET", &inside(what)).0.starts_with("HTTP/1.1 404"), "{what}");
    }
    for what in ["speed/-1", "speed/x", "state", "stop"] {
        assert!(page.asked("POST", &inside(what)).0.starts_with("HTTP/1.1 404"), "{what}");
    }
    signal(&page.child, "-INT");
    assert_eq!(page.child.wait().unwrap().code(), Some(130));
}

/// The files of a log of `lamp` and `door` at its first `stops` of 36.
fn write_log(log: &Path, stops: u32) {
    let (mut places, mut heard) = ("stop,x_m,y_m\n".to_owned(), "node,stop,rssi_dbm\n".to_owned());
    for stop in 0..stops {
        let (x_m, y_m) = (f64::from(stop % 6) * 2.0, f64::from(stop / 6) * 2.0);
        places += &format!("{stop},{x_m},{y_m}\n");
        for (node, at) in [("lamp", [3.0, 1.0]), ("door", [8.0, 9.0])] {
            let far_m = libm::hypot(x_m - at[0], y_m - at[1]).max(0.5);
            if far_m < 8.0 {
                heard += &format!("{node},{stop},{:.1}\n", -50.0 - 20.0 * libm::log10(far_m));
            }
        }
    }
    fs::write(log.join("stops.csv"), &places).unwrap();
    fs::write(log.join("receptions.csv"), &heard).unwrap();
}

/// `sextant map --follow` of a log.
fn follow(log: &Path) -> Command {
    let mut command = sextant();
    command.arg("map").arg(log).args(["--follow", "--port", "0"]);
    command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped());
    command
}

#[test]
fn what_changed_is_told_on_the_terminal_while_no_browser_looks() {
    let log = TempDir::new().unwrap();
    write_log(log.path(), 12);
    let mut page = Page::of(&mut follow(log.path()));
    // The log as it was is mapped before the address is printed, and may be told before it.
    write_log(log.path(), 36);
    let mut line = String::new();
    while !line.starts_with("36 stops, 2 nodes on the map") {
        line.clear();
        assert!(page.stderr.read_line(&mut line).unwrap() > 0, "it ended before the second map");
    }
    signal(&page.child, "-INT");
    assert_eq!(page.child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_log_that_grows_is_mapped_again_and_what_changed_is_told() {
    let log = TempDir::new().unwrap();
    let log = log.path();
    write_log(log, 12);
    let mut page = Page::of(&mut follow(log));
    let first = page.eventually(|state| state["document"] == 1);
    assert!(first["news"].as_str().unwrap().starts_with("12 stops, "), "{first}");
    assert_eq!(first["pace"], Value::Null);
    write_log(log, 36);
    let later =
        page.eventually(|state| state["news"].as_str().is_some_and(|news| news.starts_with("36 stops, 2 nodes")));
    assert!(later["news"].as_str().unwrap().contains("moved by"), "{later}");
    assert!(later["news"].as_str().unwrap().ends_with("the whole one follows when the log rests"), "{later}");
    // What follows is as if the log had never been shorter.
    page.eventually(|state| state["news"].as_str().is_some_and(|news| !news.contains("quick map")));
    let mut anew = Page::of(&mut follow(log));
    anew.eventually(|state| state["document"] == 1);
    assert_eq!(page.json("GET", "document"), anew.json("GET", "document"));
    signal(&anew.child, "-INT");
    assert_eq!(anew.child.wait().unwrap().code(), Some(0));
    // A line that is not whole yet takes nothing away.
    fs::write(log.join("stops.csv"), "stop,x_m,y_m\n0,0").unwrap();
    page.eventually(|state| {
        state["news"].as_str().is_some_and(|news| news.contains("cannot be mapped as it is now"))
    });
    assert_eq!(page.json("GET", "document")["kind"], "log");
    signal(&page.child, "-INT");
    assert_eq!(page.child.wait().unwrap().code(), Some(0));
}

#[test]
fn flags_that_need_the_whole_log_are_refused_with_follow() {
    let message = sextant().args(["map", "log", "--follow", "--out", "map.csv"]).output().unwrap().refusal();
    assert!(message.contains("--out"), "{message}");
}
