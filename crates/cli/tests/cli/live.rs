//! The live view, seen by a client that speaks the Foxglove WebSocket protocol.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::Child;

use serde_json::{Value, json};
use sextant_recording::mcap_file::{Piece, scan};
use tempfile::TempDir;
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, connect};

use crate::program::{Said, scenario, sextant, signal};

type Socket = tungstenite::WebSocket<tungstenite::stream::MaybeTlsStream<std::net::TcpStream>>;
/// Times and octets of the messages of each topic.
type Messages = BTreeMap<String, Vec<(u64, Vec<u8>)>>;

/// Few messages, so that no viewer is too slow.
const FEW: [&str; 2] = ["--set", "recording.frames=false"];

/// A run of a small survey into `out` that is shown, and the address of the view.
fn shown(out: &Path, flags: &[&str]) -> (Child, String) {
    let mut command = sextant();
    command.arg("run").arg(scenario("smoke.toml")).args(FEW).arg("--out").arg(out);
    command.args(["--live=foxglove", "--port", "0"]).args(flags);
    let mut child = command.spawn().expect("it starts");
    let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
    let mut note = String::new();
    while !note.contains("ws://") {
        note.clear();
        assert!(stderr.read_line(&mut note).expect("a pipe") > 0, "it ended early");
    }
    let address = note.split_whitespace().find(|word| word.starts_with("ws://")).expect("an address");
    (child, address.trim_end_matches([',', ';', '.']).to_owned())
}

/// A viewer that has connected.
struct Viewer {
    socket: Socket,
    info: Value,
    /// The topic of each channel. The number of a subscription is that of its channel.
    topics: BTreeMap<u64, String>,
    services: BTreeMap<String, u64>,
    messages: Messages,
    /// The last time that the server told (ns).
    time_ns: u64,
}

impl Viewer {
    fn connect(address: &str) -> Self {
        let mut request = address.into_client_request().expect("an address");
        let protocol = HeaderValue::from_static("foxglove.sdk.v1");
        request.headers_mut().insert("Sec-WebSocket-Protocol", protocol.clone());
        let (socket, response) = connect(request).expect("a server");
        assert_eq!(response.headers().get("Sec-WebSocket-Protocol"), Some(&protocol));
        let (topics, services, messages) = (BTreeMap::new(), BTreeMap::new(), Messages::new());
        Self { socket, info: Value::Null, topics, services, messages, time_ns: 0 }
    }

    /// Takes one message of the server; subscribes to each channel that it advertises. `None` when the server has gone.
    fn next(&mut self) -> Option<Option<(u32, Value)>> {
        match self.socket.read().ok()? {
            Message::Text(text) => {
                let message: Value = serde_json::from_str(&text).expect("JSON");
                match message["op"].as_str().expect("an operation") {
                    "serverInfo" => self.info = message,
                    "advertise" => self.subscribe(&message),
                    "advertiseServices" => {
                        for service in message["services"].as_array().expect("services") {
                            let name = service["name"].as_str().expect("a name").to_owned();
                            self.services.insert(name, service["id"].as_u64().expect("a number"));
                        }
                    }
                    _ => {}
                }
                Some(None)
            }
            Message::Binary(octets) => Some(self.binary(&octets)),
            Message::Close(_) => None,
            _ => Some(None),
        }
    }

    fn subscribe(&mut self, message: &Value) {
        let mut subscriptions = Vec::new();
        for channel in message["channels"].as_array().expect("channels") {
            assert_eq!(channel["encoding"], "protobuf", "{channel}");
            assert!(channel["schema"].as_str().is_some_and(|schema| !schema.is_empty()), "{channel}");
            let id = channel["id"].as_u64().expect("a number");
            self.topics.insert(id, channel["topic"].as_str().expect("a topic").to_owned());
            subscriptions.push(json!({ "id": id, "channelId": id }));
        }
        let subscribe = json!({ "op": "subscribe", "subscriptions": subscriptions });
        self.socket.send(Message::text(subscribe.to_string())).expect("a server");
    }

    /// Takes a binary message; returns the answer of a service, if it is one.
    fn binary(&mut self, octets: &[u8]) -> Option<(u32, Value)> {
        let number = |at: usize| u32::from_le_bytes(octets[at..at + 4].try_into().expect("four octets"));
        let time = |at: usize| u64::from_le_bytes(octets[at..at + 8].try_into().expect("eight octets"));
        match octets[0] {
            1 => {
                let topic = self.topics[&u64::from(number(1))].clone();
                let message = (time(5), octets[13..].to_vec());
                let messages = self.messages.entry(topic).or_default();
                // The last message before a subscription may come twice.
                if messages.last() != Some(&message) || messages.len() > 1 {
                    messages.push(message);
                }
                None
            }
            2 => {
                self.time_ns = time(1);
                None
            }
            3 => {
                let start = 13 + number(9) as usize;
                assert_eq!(&octets[13..start], b"json");
                Some((number(5), serde_json::from_slice(&octets[start..]).expect("JSON")))
            }
            other => panic!("an unknown message {other}"),
        }
    }

    /// Calls a service and waits for its answer.
    fn call(&mut self, service: &str) -> Value {
        while !self.services.contains_key(service) {
            self.next().expect("the server is there");
        }
        let id = u32::try_from(self.services[service]).expect("a small number");
        let mut octets = vec![2];
        for number in [id, 7, 4] {
            octets.extend_from_slice(&number.to_le_bytes());
        }
        octets.extend_from_slice(b"json{}");
        self.socket.send(Message::binary(octets)).expect("a server");
        loop {
            if let Some((7, answer)) = self.next().expect("the server is there") {
                return answer;
            }
        }
    }

    fn count(&self) -> usize {
        self.messages.values().map(Vec::len).sum()
    }
}

/// The messages of a recording.
fn recorded(path: &Path) -> Messages {
    let mut messages = Messages::new();
    let damage = scan::<sextant_recording::RecordingError>(path, &mut |piece| {
        if let Piece::Message { channel, header, data } = piece {
            messages.entry(channel.topic.clone()).or_default().push((header.log_time, data.to_vec()));
        }
        Ok(())
    });
    assert_eq!(damage.expect("a recording"), None);
    messages
}

#[test]
fn a_viewer_pauses_steps_and_sees_what_is_recorded() {
    let folder = TempDir::new().expect("there is room");
    let [live, plain] = ["live.mcap", "plain.mcap"].map(|name| folder.path().join(name));
    let (child, address) = shown(&live, &["--paused", "--speed", "max"]);
    let mut viewer = Viewer::connect(&address);
    let paused = viewer.call("sextant.pause");
    assert_eq!(paused, json!({ "paused": true, "time_s": 0.0 }));
    assert_eq!(viewer.info["name"], "sextant smoke");
    let capabilities = viewer.info["capabilities"].as_array().expect("capabilities");
    assert!(
        ["time", "services"].iter().all(|capability| capabilities.contains(&json!(capability))),
        "{capabilities:?}"
    );
    // The world is there, and time stands still until the first step.
    while !viewer.messages.contains_key("/world/nodes") {
        viewer.next().expect("the server is there");
    }
    assert_eq!(viewer.time_ns, 0);
    assert_eq!(viewer.call("sextant.step")["paused"], true);
    while viewer.time_ns == 0 {
        viewer.next().expect("the server is there");
    }
    let stepped = viewer.call("sextant.pause")["time_s"].as_f64().expect("a time");
    assert!((stepped - viewer.time_ns as f64 * 1e-9).abs() < 1e-9, "{stepped} s, {} ns", viewer.time_ns);
    assert_eq!(viewer.call("sextant.resume")["paused"], false);
    while viewer.next().is_some() {}
    assert!(child.wait_with_output().expect("it ends").status.success());

    let mut plain_run = sextant();
    let run = plain_run.arg("run").arg(scenario("smoke.toml")).args(FEW).arg("--out").arg(&plain).output();
    run.expect("it starts").printed();
    assert_eq!(
        std::fs::read(&live).expect("a file"),
        std::fs::read(&plain).expect("a file"),
        "the recording is the same"
    );
    let expected = recorded(&plain);
    assert_eq!(viewer.messages.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    assert!(viewer.count() > 1000, "{}", viewer.count());
    for (topic, messages) in &expected {
        // A viewer that subscribes when a channel is new may miss what came between its first and its next message.
        let seen = &viewer.messages[topic];
        let mut rest = messages.iter();
        assert!(seen.iter().all(|message| rest.any(|other| other == message)), "{topic} has other messages");
        assert_eq!(seen.last(), messages.last(), "{topic} does not end as in the recording");
    }
    // Stops come after the viewer is there: it misses none.
    assert_eq!(viewer.messages["/stops"].len(), expected["/stops"].len());
}

#[test]
fn a_run_that_is_paused_ends_with_ctrl_c_and_its_recording_is_complete() {
    let folder = TempDir::new().expect("there is room");
    let out = folder.path().join("run.mcap");
    let (child, address) = shown(&out, &["--paused"]);
    let mut viewer = Viewer::connect(&address);
    assert_eq!(viewer.call("sextant.pause")["paused"], true);
    signal(&child, "-INT");
    assert_eq!(child.wait_with_output().expect("it ends").status.code(), Some(130));
    assert!(!recorded(&out).is_empty());
}

#[test]
fn a_port_that_is_in_use_is_named_with_a_remedy() {
    let folder = TempDir::new().expect("there is room");
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("a port").port().to_string();
    let out = folder.path().join("run.mcap");
    let mut command = sextant();
    command.arg("run").arg(scenario("smoke.toml")).arg("--out").arg(&out).args(["--live=foxglove", "--port", &port]);
    let output = command.output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr).replace('\n', " ");
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains(&format!("127.0.0.1:{port}")) && text.contains("--port 0"), "{text}");
    assert!(!out.exists());
}
