//! The server of a live view.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use foxglove::websocket::Capability;
use foxglove::websocket::service::{Request, Service, ServiceSchema};
use foxglove::{Context, FoxgloveError, WebSocketServer, WebSocketServerHandle};
use sextant_recording::Relay;

use super::feed::{Channels, Feed};
use super::keys;
use super::pace::{Pace, Progress};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;

/// Messages that wait for a slow viewer; it misses the oldest ones beyond that.
const BACKLOG: usize = 16_384;
/// Viewers get this much time for the last messages: they subscribe to the maps first.
const LAST: Duration = Duration::from_secs(2);
/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);

/// Where a live view is, and how fast time passes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Name or address of this machine.
    pub(crate) host: String,
    /// The port; 0 for any that is free.
    pub(crate) port: u16,
    /// Simulated seconds in a second; `None` for as fast as possible.
    pub(crate) speed: Option<f64>,
    /// Whether time begins to pass only when somebody says so.
    pub(crate) is_paused: bool,
    /// Name of the scenario.
    pub(crate) name: String,
}

/// A server that shows a run.
pub(crate) struct LiveView {
    server: Arc<WebSocketServerHandle>,
    context: Arc<Context>,
    channels: Arc<Channels>,
    pace: Arc<Pace>,
}

impl LiveView {
    /// Starts the server, and reads keys if there is a terminal.
    pub(crate) fn start(settings: &Settings, interrupt: &Interrupt) -> Result<Self, Failure> {
        let Settings { host, port, speed, is_paused, name } = settings;
        let pace = Arc::new(Pace::new(*speed, *is_paused, interrupt.clone()));
        let (context, channels) = (Context::new(), Arc::new(Channels::default()));
        let server = WebSocketServer::new()
            .name(format!("sextant {name}"))
            .bind(host, *port)
            .context(&context)
            .capabilities([Capability::Time, Capability::Services])
            .supported_encodings(["json"])
            .services(services(&pace))
            .listener(Arc::clone(&channels) as _)
            .message_backlog_size(BACKLOG)
            .start_blocking()
            .map_err(|error| unavailable(host, *port, &error))?;
        if keys::has_keys() {
            keys::listen(&pace);
        }
        Ok(Self { server: Arc::new(server), context, channels, pace })
    }

    /// What hands on the messages of the recording.
    pub(crate) fn relay(&self) -> Box<dyn Relay> {
        Box::new(Feed {
            server: Arc::clone(&self.server),
            context: Arc::clone(&self.context),
            channels: Arc::clone(&self.channels),
            pace: Arc::clone(&self.pace),
        })
    }

    /// What to tell the user.
    pub(crate) fn note(&self, host: &str) -> String {
        let port = self.server.port();
        let keys = if keys::has_keys() { format!("; {}", keys::HELP) } else { String::new() };
        format!("the run is shown at ws://{host}:{port}, for Foxglove: Open connection{keys}")
    }

    /// Ends the view when the run is over; viewers get the last messages before.
    pub(crate) fn finish(self, interrupt: &Interrupt) {
        let mut left = LAST;
        while self.server.client_count() > 0 && !left.is_zero() && !interrupt.is_requested() {
            thread::sleep(LOOK);
            left = left.saturating_sub(LOOK);
        }
        if let Ok(server) = Arc::try_unwrap(self.server) {
            server.stop().wait_blocking();
        }
    }
}

/// The services with which a viewer pauses, resumes and steps. Each answers whether time stands still, and the time.
fn services(pace: &Arc<Pace>) -> Vec<Service> {
    let service = |name: &str, act: fn(&Pace) -> Progress| {
        let pace = Arc::clone(pace);
        Service::builder(name, ServiceSchema::new(name)).handler_fn(move |_: Request| {
            let Progress { is_paused, time } = act(&pace);
            let answer = serde_json::json!({ "paused": is_paused, "time_s": time.as_secs_f64() });
            Ok::<_, String>(answer.to_string())
        })
    };
    vec![
        service("sextant.pause", Pace::pause),
        service("sextant.resume", Pace::resume),
        service("sextant.step", Pace::step),
    ]
}

fn unavailable(host: &str, port: u16, error: &FoxgloveError) -> Failure {
    Failure::bad_input_with_help(
        format!("the live view cannot use `{host}:{port}`: {error}"),
        "`--port` chooses another port, and `--port 0` any that is free",
    )
}
