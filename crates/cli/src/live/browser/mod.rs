//! The view of a browser: the page of a report, on a server of this machine, that goes on with the run.

mod documents;
mod feed;
mod run;
mod server;

use std::hash::{BuildHasher as _, RandomState};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use sextant_recording::{RecordingSoFar, Relay};

use self::documents::Documents;
pub(crate) use self::documents::{APART, Document, SHARE, Story};
use self::feed::Feed;
use self::run::RunStory;
use self::server::Server;
use super::pace::Pace;
use super::{Settings, unavailable};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;

/// Browsers get this much time for the last document.
const LAST: Duration = Duration::from_secs(5);
/// A signal is noticed this often.
const LOOK: Duration = Duration::from_millis(50);

/// A server that shows what goes on.
pub(crate) struct BrowserView {
    server: Server,
    documents: Arc<Documents>,
}

/// The address of a view, and what it is called.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<'a> {
    /// Name or address of this machine.
    pub(crate) host: &'a str,
    /// The port; 0 for any that is free.
    pub(crate) port: u16,
    /// The title of the page.
    pub(crate) title: &'a str,
}

impl BrowserView {
    /// Shows a story. With a `pace`, the page can pause it and change its speed.
    pub(crate) fn start(place: Place<'_>, story: impl Story, pace: Option<&Arc<Pace>>) -> Result<Self, Failure> {
        let documents = Arc::new(Documents::default());
        let problem = |error: &dyn std::fmt::Display| unavailable(place.host, place.port, error);
        let server = Server::start(place, &token(), &documents, pace.cloned()).map_err(|error| problem(&error))?;
        documents::make(&documents, story).map_err(|error| problem(&error))?;
        Ok(Self { server, documents })
    }

    /// Where it is. The word in the address keeps other users of this machine, and pages from elsewhere, out.
    pub(crate) fn address(&self, host: &str) -> String {
        format!("http://{host}:{}{}", self.server.port(), self.server.folder())
    }

    /// Ends the view. A browser that looks at it gets the last document before.
    pub(super) fn finish(self, interrupt: &Interrupt) {
        self.documents.end();
        let mut left = LAST;
        while self.documents.is_awaited() && !left.is_zero() && !interrupt.is_requested() {
            thread::sleep(LOOK);
            left = left.saturating_sub(LOOK);
        }
    }
}

/// A view of a run.
pub(crate) struct RunView {
    view: BrowserView,
    so_far: RecordingSoFar,
    pace: Arc<Pace>,
}

impl RunView {
    /// Starts the server.
    pub(super) fn start(settings: &Settings, pace: &Arc<Pace>, interrupt: &Interrupt) -> Result<Self, Failure> {
        let Settings { host, port, name, .. } = settings;
        let so_far = RecordingSoFar::default();
        let story =
            RunStory::new(so_far.clone(), interrupt.clone()).map_err(|error| unavailable(host, *port, &error))?;
        let view = BrowserView::start(Place { host, port: *port, title: name }, story, Some(pace))?;
        Ok(Self { view, so_far, pace: Arc::clone(pace) })
    }

    /// What hands on the messages of the recording.
    pub(super) fn relay(&self) -> Box<dyn Relay> {
        Box::new(Feed { so_far: self.so_far.clone(), pace: Arc::clone(&self.pace) })
    }

    /// Where it is.
    pub(super) fn note(&self, host: &str) -> String {
        self.view.address(host)
    }

    /// Ends the view when the run is over.
    pub(super) fn finish(self, interrupt: &Interrupt) {
        self.view.finish(interrupt);
    }
}

/// A word that nobody can guess: 128 bits that follow from the secret keys which the standard library takes from the system.
fn token() -> String {
    let keys = RandomState::new();
    format!("{:016x}{:016x}", keys.hash_one(0_u8), keys.hash_one(1_u8))
}
