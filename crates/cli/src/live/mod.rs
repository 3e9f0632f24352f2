//! The live view of a run: what is recorded is shown while simulated time passes as the wall clock says.

mod browser;
#[cfg(feature = "foxglove")]
mod foxglove;
mod keys;
mod pace;
mod speed;

use std::sync::Arc;

use sextant_recording::Relay;

use self::browser::RunView;
pub(crate) use self::browser::{APART, BrowserView, Document, Place, SHARE, Story};
#[cfg(feature = "foxglove")]
use self::foxglove::FoxgloveView;
use self::pace::Pace;
pub(crate) use self::speed::Speed;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;

/// Who looks at a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Viewer {
    /// A browser, which shows the page of a report
    Browser,
    /// Foxglove, or another program that speaks its WebSocket protocol
    Foxglove,
}

/// Where a live view is, and how fast time passes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Who looks.
    pub(crate) viewer: Viewer,
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
pub(crate) enum LiveView {
    Browser(RunView),
    #[cfg(feature = "foxglove")]
    Foxglove(FoxgloveView),
}

impl LiveView {
    /// Starts the server, and reads keys if there is a terminal.
    pub(crate) fn start(settings: &Settings, interrupt: &Interrupt) -> Result<Self, Failure> {
        let pace = Arc::new(Pace::new(settings.speed, settings.is_paused, interrupt.clone()));
        let view = match settings.viewer {
            Viewer::Browser => Self::Browser(RunView::start(settings, &pace, interrupt)?),
            #[cfg(feature = "foxglove")]
            Viewer::Foxglove => Self::Foxglove(FoxgloveView::start(settings, &pace)?),
            #[cfg(not(feature = "foxglove"))]
            Viewer::Foxglove => {
                return Err(Failure::bad_input_with_help(
                    "this program was built without the server of Foxglove's protocol",
                    "`cargo install sextant-cli --features foxglove` builds it in; `--live` alone shows the run in a browser",
                ));
            }
        };
        if keys::has_keys() {
            keys::listen(&pace);
        }
        Ok(view)
    }

    /// What hands on the messages of the recording.
    pub(crate) fn relay(&self) -> Box<dyn Relay> {
        match self {
            Self::Browser(view) => view.relay(),
            #[cfg(feature = "foxglove")]
            Self::Foxglove(view) => view.relay(),
        }
    }

    /// What to tell the user.
    pub(crate) fn note(&self, host: &str) -> String {
        let keys = if keys::has_keys() { format!("; {}", keys::HELP) } else { String::new() };
        let shown = match self {
            Self::Browser(view) => view.note(host),
            #[cfg(feature = "foxglove")]
            Self::Foxglove(view) => view.note(host),
        };
        format!("the run is shown at {shown}{keys}")
    }

    /// Ends the view when the run is over; viewers get the last messages before.
    pub(crate) fn finish(self, interrupt: &Interrupt) {
        match self {
            Self::Browser(view) => view.finish(interrupt),
            #[cfg(feature = "foxglove")]
            Self::Foxglove(view) => view.finish(interrupt),
        }
    }
}

/// The address cannot be used.
fn unavailable(host: &str, port: u16, error: &dyn std::fmt::Display) -> Failure {
    Failure::bad_input_with_help(
        format!("the live view cannot use `{host}:{port}`: {error}"),
        "`--port` chooses another port, and `--port 0` any that is free",
    )
}
