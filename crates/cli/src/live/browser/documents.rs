//! The documents of a run that goes on: one after another, each with all that was recorded until then.

use std::io;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use sextant_recording::RecordingSoFar;
use sextant_report::{Report, ReportError};
use tempfile::TempDir;

/// Between two documents at least.
const APART: Duration = Duration::from_secs(1);
/// A document that takes long leaves the processor to the simulation for so many times its own time.
const SHARE: u32 = 10;
/// A browser that has asked within this time looks at the run.
const LOOKS: Duration = Duration::from_secs(3);

/// The last document, and who has it.
#[derive(Default)]
pub(super) struct Documents {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// JSON; empty before the first one.
    text: Arc<str>,
    /// How many there have been.
    number: u64,
    /// The number of the one that was given last.
    given: u64,
    /// Why there is no newer one.
    problem: Option<String>,
    /// Whether the run is over, and then whether the last document is made.
    is_over: bool,
    is_last: bool,
    /// When a browser asked last.
    asked: Option<Instant>,
}

/// What a browser is told.
pub(super) struct Told {
    pub(super) number: u64,
    pub(super) problem: Option<String>,
    /// Whether no document follows this one.
    pub(super) is_last: bool,
}

impl Documents {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A browser asks what there is.
    pub(super) fn ask(&self) -> Told {
        let mut state = self.state();
        state.asked = Some(now());
        self.changed.notify_all();
        Told { number: state.number, problem: state.problem.clone(), is_last: state.is_last }
    }

    /// A browser takes the last document.
    pub(super) fn take(&self) -> Arc<str> {
        let mut state = self.state();
        state.given = state.number;
        Arc::clone(&state.text)
    }

    /// The run is over: one more document follows, if somebody looks.
    pub(super) fn end(&self) {
        self.state().is_over = true;
        self.changed.notify_all();
    }

    /// Whether a browser looks that has not the last document.
    pub(super) fn is_awaited(&self) -> bool {
        let state = self.state();
        state.is_watched() && !(state.is_last && state.given == state.number)
    }

    fn made(&self, document: Result<String, ReportError>, is_last: bool) {
        let mut state = self.state();
        match document {
            Ok(text) => {
                (state.text, state.problem) = (text.into(), None);
                state.number += 1;
            }
            // Nothing has happened yet.
            Err(ReportError::Empty { .. }) => {}
            Err(error) => state.problem = Some(error.to_string()),
        }
        state.is_last = is_last;
    }

    /// Waits until a document is wanted that has more than `records` records; whether the run is over then. `None` if
    /// the run is over and nobody looks.
    fn wanted(&self, records: usize, so_far: &RecordingSoFar) -> Option<bool> {
        let mut state = self.state();
        loop {
            if state.is_over {
                return state.is_watched().then_some(true);
            }
            if state.is_watched() && so_far.records() > records {
                return Some(false);
            }
            state = self.changed.wait_timeout(state, APART).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Waits so long, or until the run is over.
    fn rest(&self, span: Duration) {
        let end = now() + span;
        let mut state = self.state();
        while !state.is_over && now() < end {
            state = self.changed.wait_timeout(state, APART).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl State {
    fn is_watched(&self) -> bool {
        self.asked.is_some_and(|asked| asked.elapsed() < LOOKS)
    }
}

/// Makes documents of what is recorded while a browser looks, in a thread of its own.
pub(super) fn make(documents: &Arc<Documents>, so_far: &RecordingSoFar) -> io::Result<()> {
    let folder = TempDir::with_prefix("sextant-live-")?;
    let (documents, so_far) = (Arc::clone(documents), so_far.clone());
    thread::Builder::new().name("live documents".to_owned()).spawn(move || {
        let path = folder.path().join("run.mcap");
        let mut records = 0;
        while let Some(is_last) = documents.wanted(records, &so_far) {
            records = so_far.records();
            let began = now();
            documents.made(document(&so_far, &path), is_last);
            if is_last {
                break;
            }
            documents.rest(APART.max(began.elapsed() * SHARE));
        }
    })?;
    Ok(())
}

fn document(so_far: &RecordingSoFar, path: &Path) -> Result<String, ReportError> {
    so_far.write(path)?;
    let mut report = Report::of_recording(path)?;
    // That it goes on is told beside it.
    report.notes.clear();
    Ok(report.to_json())
}

fn now() -> Instant {
    #[expect(clippy::disallowed_methods, reason = "a live view follows the wall clock")]
    Instant::now()
}
