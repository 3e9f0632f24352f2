//! Names of others: the data have each letter as it is, and the frame of the page has none that changes the text around it.

use base64::Engine as _;
use serde_json::{Value, json};
use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::{FileRecorder, Origin};
use sextant_report::Report;
use sha2::{Digest as _, Sha256};

use super::{document, file, folder, seconds};

/// Characters that order the letters around them (Unicode Standard Annex 9), without the marks of honest names.
const ORDERING: [char; 9] =
    ['\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}', '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}'];

/// A name for each letter that programs treat in some way of their own.
fn names() -> Vec<String> {
    let others = ['\u{61c}', '\u{200d}', '\u{200e}', '\u{200f}', '\u{2028}', '\u{2029}', '\u{feff}', '\u{fffd}'];
    // The letters beside those that are no characters, and the last ones.
    let edges = ['\u{d7ff}', '\u{e000}', '\u{fffe}', '\u{ffff}', '\u{1f469}', '\u{10ffff}'];
    let letters = ('\0'..='\u{ff}').chain(ORDERING).chain(others).chain(edges);
    let texts = ["</script><!--", "\\u{202e}", "\\u202e", "\u{200f}שלום", "مرحبا\u{61c}", "👩‍🔬", "-->", "]]>", ""];
    let long = "\u{202e}é".repeat(20_000);
    letters.map(|letter| format!("a{letter}b")).chain(texts.map(str::to_owned)).chain([long]).collect()
}

/// A report of a recording with these names for all that has one.
fn report(names: &[String]) -> Report {
    let folder = folder();
    let path = folder.path().join("run.mcap");
    let mut recorder = FileRecorder::create(&path).expect("a folder");
    recorder.origin(Origin { scenario: &names.concat(), seed: 3, version: "1.2.3" }).expect("room");
    let stop = Stop { time: seconds(1), ..Stop::at(Position::default()) };
    let heard = |node| Reception::heard(node, 0, 1, 1);
    let heard = (0..names.len()).map(|node| heard(NodeId::from_index(node))).collect();
    let log = ReceptionLog::new(names.to_vec(), vec![stop], heard, Vec::new()).expect("a sound log");
    recorder.log(&log).expect("room");
    for name in names.iter().filter(|name| !name.is_empty()) {
        recorder.map(SimTime::ZERO, name, &[]).expect("room");
    }
    recorder.scenario(&names.join("\n")).expect("room");
    recorder.summary(&summary(names).to_string()).expect("room");
    recorder.finish().expect("room");
    Report::of_recording(&path).expect("a sound recording")
}

/// A summary in which these names are values and keys.
fn summary(names: &[String]) -> Value {
    let keys: serde_json::Map<String, Value> = names.iter().map(|name| (name.clone(), json!(name))).collect();
    json!({ "maps": names, "keys": keys })
}

#[test]
fn the_data_have_each_name_as_it_is() {
    let names = names();
    let document = document(&report(&names).to_html());
    assert_eq!(document["world"]["names"], json!(names));
    assert_eq!(document["title"], json!(names.concat()));
    assert_eq!(document["scenario"], json!(names.join("\n")));
    let inner: Value = serde_json::from_str(document["summary"].as_str().expect("a text")).expect("JSON within JSON");
    assert_eq!(inner, summary(&names));
    let maps = document["world"]["maps"].as_array().expect("maps").iter().map(|map| map["name"].clone());
    let mut maps: Vec<Value> = maps.collect();
    let mut expected: Vec<Value> = names.iter().filter(|name| !name.is_empty()).map(|name| json!(name)).collect();
    maps.sort_by_key(ToString::to_string);
    expected.sort_by_key(ToString::to_string);
    assert_eq!(maps, expected);
}

#[test]
fn no_letter_of_a_name_changes_the_frame_of_the_page() {
    // As many in one title as it shows.
    for some in names().chunks(50) {
        let html = report(some).to_html();
        let (head, _) = html.split_once("<style>").expect("a style");
        let (_, body) = html.split_once("<body>").expect("a body");
        let (body, _) = body.split_once("<script").expect("data");
        let title = head.split_once("<title>").expect("a title").1;
        let isolates = |c: char| matches!(c, '\u{2068}' | '\u{2069}');
        for frame in [title.trim_start_matches(isolates).replacen('\u{2069}', "", 1), body.to_owned()] {
            let harmful = |c: char| c.is_control() && c != '\n' && c != '\t' || ORDERING.contains(&c);
            assert!(!frame.contains(harmful) && !frame.contains(['\u{2028}', '\u{2029}']), "{some:?}: {frame}");
            assert!(!frame.contains("<!--") && frame.len() < 4000, "{some:?}: {frame}");
        }
    }
}

#[test]
fn names_in_tables_come_back_as_they_are() {
    // A line feed ends a row for the readers of tables, and quotes are doubled.
    let names: Vec<String> = names().into_iter().filter(|name| !name.contains(['\n', '\r', '"'])).collect();
    let quoted = |name: &String| format!("\"{name}\"");
    let rows: String = (0..).zip(&names).map(|(i, name)| format!("{i},0,1,{},m,,0.5\n", quoted(name))).collect();
    let folder = folder();
    let path = file(&folder, "t.csv", &format!("cell,replicate,seed,a.kind,map,error,mac.prr\n{rows}"));
    let sweep = document(&Report::of_sweep(&path).expect("a sweep").to_html());
    assert_eq!(sweep["sweep"]["settings"][0]["values"]["texts"]["words"], json!(names));
    let rows: String = names.iter().map(|name| format!("{0},{0},m,1,0,1,{0},{0}\n", quoted(name))).collect();
    let header = "what,published,unit,mean,half_width_95,runs,result,source\n";
    let path = file(&folder, "3.6.csv", &format!("{header}{rows}"));
    let read = document(&Report::of_reproduction(&path, &[].into()).expect("a reproduction").to_html());
    let cells = read["reproduction"]["experiments"][0]["rows"].as_array().expect("rows").iter();
    assert_eq!(
        cells.map(|row| row[0].clone()).collect::<Vec<_>>(),
        names.iter().map(|n| json!(n)).collect::<Vec<_>>()
    );
}

#[test]
fn the_policy_names_the_code_and_the_style_of_the_page_and_allows_no_other() {
    let html = report(&["node".to_owned()]).to_html();
    let (_, policy) = html.split_once("Content-Security-Policy\" content=\"").expect("a policy");
    let (policy, _) = policy.split_once('"').expect("its end");
    for (name, start, end) in [("script", "<script>", "</script>"), ("style", "<style>", "</style>")] {
        let (text, _) = html.split_once(start).and_then(|(_, rest)| rest.split_once(end)).expect(name);
        let hash = base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text));
        assert!(policy.contains(&format!("; {name}-src 'sha256-{hash}';")), "{policy}");
        assert_eq!(html.matches(start).count(), 1 + text.matches(start).count(), "one {name}");
    }
    assert!(policy.starts_with("default-src 'none'") && !policy.contains("unsafe"), "{policy}");
    let (head, rest) = html.split_once("<style>").expect("a style");
    let (body, _) = rest.split_once("</style>").and_then(|(_, rest)| rest.split_once("<script")).expect("data");
    assert!(![head, body].iter().any(|frame| frame.contains(" style=") || frame.contains(" on")), "{head}{body}");
}

#[test]
fn a_summary_that_a_browser_could_not_read_is_left_out() {
    let folder = folder();
    let path = folder.path().join("run.mcap");
    for summary in ["{\"maps\": ", &"[".repeat(100_000), &format!("{}{}", "[".repeat(5000), "]".repeat(5000))] {
        let mut recorder = FileRecorder::create(&path).expect("a folder");
        recorder.map(SimTime::ZERO, "m", &[]).expect("room");
        recorder.summary(summary).expect("room");
        recorder.finish().expect("room");
        let report = Report::of_recording(&path).expect("maps are left");
        assert_eq!(report.summary, None);
    }
}
