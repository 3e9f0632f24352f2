//! The documents of what goes on: one after another, each with all that there is until then.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Between two documents at least.
pub(crate) const APART: Duration = Duration::from_secs(1);
/// A document that takes long leaves the processor to others for so many times its own time.
pub(crate) const SHARE: u32 = 5;
/// A browser that has asked within this time looks at the run.
const LOOKS: Duration = Duration::from_secs(3);

/// What documents are made of.
pub(crate) trait Story: Send + 'static {
    /// Whether there is something that the last document does not have.
    fn has_more(&mut self) -> bool;

    /// Whether it is told elsewhere too, as on a terminal: then documents are made while no browser looks, too.
    fn is_told_elsewhere(&self) -> bool {
        false
    }

    /// How long the processor is left to others after a document that took so long.
    fn rest(&self, took: Duration) -> Duration {
        APART.max(took * SHARE)
    }

    /// A document of all that there is (JSON), with a sentence on what is new if there is one to say. `is_last` if nothing
    /// follows. `None` if there is nothing to show yet.
    ///
    /// # Errors
    /// Why there is no document now: what is told beside the last one.
    fn document(&mut self, is_last: bool) -> Result<Option<Document>, String>;
}

/// A document of a story.
pub(crate) struct Document {
    /// JSON.
    pub(crate) text: String,
    /// What is new in it.
    pub(crate) news: Option<String>,
}

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
    /// What is new in it, or why there is no newer one.
    news: Option<String>,
    /// Whether the run is over, and then whether the last document is made.
    is_over: bool,
    is_last: bool,
    /// When a browser asked last.
    asked: Option<Instant>,
}

/// What a browser is told.
pub(super) struct Told {
    pub(super) number: u64,
    pub(super) news: Option<String>,
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
        Told { number: state.number, news: state.news.clone(), is_last: state.is_last }
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

    fn made(&self, made: Result<Option<Document>, String>, is_last: bool) {
        let mut state = self.state();
        match made {
            Ok(Some(Document { text, news })) => {
                (state.text, state.news) = (text.into(), news);
                state.number += 1;
            }
            Ok(None) => {}
            Err(problem) => state.news = Some(problem),
        }
        state.is_last = is_last;
    }

    /// Waits until a document of the story is wanted; whether the run is over then. `None` if the run is over and nobody looks.
    fn wanted(&self, story: &mut dyn Story) -> Option<bool> {
        let mut state = self.state();
        loop {
            if state.is_over {
                return state.is_watched().then_some(true);
            }
            if (state.is_watched() || story.is_told_elsewhere()) && story.has_more() {
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

/// Makes documents of a story while somebody looks, in a thread of its own.
pub(super) fn make(documents: &Arc<Documents>, mut story: impl Story) -> io::Result<()> {
    let documents = Arc::clone(documents);
    thread::Builder::new().name("live documents".to_owned()).spawn(move || {
        while let Some(is_last) = documents.wanted(&mut story) {
            let began = now();
            documents.made(story.document(is_last), is_last);
            if is_last {
                break;
            }
            documents.rest(story.rest(began.elapsed()));
        }
    })?;
    Ok(())
}

fn now() -> Instant {
    #[expect(clippy::disallowed_methods, reason = "a live view follows the wall clock")]
    Instant::now()
}
