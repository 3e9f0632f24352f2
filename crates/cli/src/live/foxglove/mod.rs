//! The view of Foxglove: a server of its WebSocket protocol that sends what is recorded.

mod feed;

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use foxglove::websocket::Capability;
use foxglove::websocket::service::{Request, Service, ServiceSchema};
use foxglove::{Context, WebSocketServer, WebSocketServerHandle};
use sextant_recording::Relay;

use self::feed::{Channels, Feed};
use super::pace::{Pace, Progress};
use super::{Settings, unavailable};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;

/// Messages that wait for a slow viewer; it misses the oldest ones beyond that.
const BACKLOG: usize = 16_384;
/// Viewers get this much time for the last messages: they subscribe to the maps first.
const LAST: Duration = Duration::from_secs(2);
/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);

/// A server that shows a run.
pub(crate) struct FoxgloveView {
    server: Arc<WebSocketServerHandle>,
    context: Arc<Context>,
    channels: Arc<Channels>,
    pace: Arc<Pace>,
}

impl FoxgloveView {
    /// Starts the server.
    pub(super) fn start(settings: &Settings, pace: &Arc<Pace>) -> Result<Self, Failure> {
        let Settings { host, port, name, .. } = settings;
        let (context, channels) = (Context::new(), Arc::new(Channels::default()));
        let server = WebSocketServer::new()
            .name(format!("sextant {name}"))
            .bind(host, *port)
            .context(&context)
            .capabilities([Capability::Time, Capability::Services])
            .supported_encodings(["json"])
            .services(services(pace))
            .listener(Arc::clone(&channels) as _)
            .message_backlog_size(BACKLOG)
            .start_blocking()
            .map_err(|error| unavailable(host, *port, &error))?;
        Ok(Self { server: Arc::new(server), context, channels, pace: Arc::clone(pace) })
    }

    /// What hands on the messages of the recording.
    pub(super) fn relay(&self) -> Box<dyn Relay> {
        Box::new(Feed {
            server: Arc::clone(&self.server),
            context: Arc::clone(&self.context),
            channels: Arc::clone(&self.channels),
            pace: Arc::clone(&self.pace),
        })
    }

    /// Where it is.
    pub(super) fn note(&self, host: &str) -> String {
        format!("ws://{host}:{}, for Foxglove: Open connection", self.server.port())
    }

    /// Ends the view when the run is over; viewers get the last messages before.
    pub(super) fn finish(self, interrupt: &Interrupt) {
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
            let Progress { is_paused, time, .. } = act(&pace);
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
