//! The view of a browser: the page of a report, on a server of this machine, that goes on with the run.

mod documents;
mod feed;
mod server;

use std::hash::{BuildHasher as _, RandomState};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use sextant_recording::{RecordingSoFar, Relay};

use self::documents::Documents;
use self::feed::Feed;
use self::server::Server;
use super::pace::Pace;
use super::{Settings, unavailable};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;

/// Browsers get this much time for the last document.
const LAST: Duration = Duration::from_secs(5);
/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);

/// A server that shows a run.
pub(crate) struct BrowserView {
    server: Server,
    documents: Arc<Documents>,
    so_far: RecordingSoFar,
    pace: Arc<Pace>,
}

impl BrowserView {
    /// Starts the server.
    pub(super) fn start(settings: &Settings, pace: &Arc<Pace>) -> Result<Self, Failure> {
        let Settings { host, port, name, .. } = settings;
        let so_far = RecordingSoFar::default();
        let documents = Arc::new(Documents::default());
        let server = Server::start((host, *port), &token(), name, &documents, pace)
            .map_err(|error| unavailable(host, *port, &error))?;
        documents::make(&documents, &so_far).map_err(|error| unavailable(host, *port, &error))?;
        Ok(Self { server, documents, so_far, pace: Arc::clone(pace) })
    }

    /// What hands on the messages of the recording.
    pub(super) fn relay(&self) -> Box<dyn Relay> {
        Box::new(Feed { so_far: self.so_far.clone(), pace: Arc::clone(&self.pace) })
    }

    /// Where it is. The word in the address keeps other users of this machine, and pages from elsewhere, out.
    pub(super) fn note(&self, host: &str) -> String {
        format!("http://{host}:{}{}", self.server.port(), self.server.folder())
    }

    /// Ends the view when the run is over. A browser that looks at it gets the last document before.
    pub(super) fn finish(self, interrupt: &Interrupt) {
        self.documents.end();
        let mut left = LAST;
        while self.documents.is_awaited() && !left.is_zero() && !interrupt.is_requested() {
            thread::sleep(LOOK);
            left = left.saturating_sub(LOOK);
        }
    }
}

/// A word that nobody can guess: 128 bits that follow from the secret keys which the standard library takes from the system.
fn token() -> String {
    let keys = RandomState::new();
    format!("{:016x}{:016x}", keys.hash_one(0_u8), keys.hash_one(1_u8))
}
