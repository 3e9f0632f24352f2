//! What is recorded of a run, and its maps so far.

use std::io;

use sextant::mapping::Input;
use sextant_recording::RecordingSoFar;
use sextant_report::{Report, ReportError};
use tempfile::TempDir;

use super::documents::{Document, Story};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::Watcher;

/// The story of a run. Until the run has its maps, those of the stops so far are shown.
pub(super) struct RunStory {
    so_far: RecordingSoFar,
    /// Records in the last document.
    told: usize,
    /// Where the recording so far is written, to be read as any other.
    folder: TempDir,
    interrupt: Interrupt,
}

impl RunStory {
    pub(super) fn new(so_far: RecordingSoFar, interrupt: Interrupt) -> io::Result<Self> {
        Ok(Self { so_far, told: 0, folder: TempDir::with_prefix("sextant-live-")?, interrupt })
    }

    fn report(&self, is_last: bool) -> Result<Report, ReportError> {
        let path = self.folder.path().join("run.mcap");
        self.so_far.write(&path)?;
        let mut report = Report::of_recording(&path)?;
        // That it goes on is told beside it.
        report.notes.clear();
        let has_maps = report.world.as_ref().is_some_and(|world| !world.maps.is_empty());
        if !is_last
            && !has_maps
            && report.summary.is_none()
            && let Ok(Some(mapped)) = self.mapped(&path)
            && let (Some(world), Some(of_log)) = (&mut report.world, mapped.world)
            && world.frame == of_log.frame
        {
            world.maps = of_log.maps;
            report.summary = mapped.summary;
        }
        Ok(report)
    }

    /// The maps of the stops so far, as those of the whole survey will be made; none if no map can be made yet.
    fn mapped(&self, path: &std::path::Path) -> Result<Option<Report>, Failure> {
        let mut input = Input::read(path, None, &sextant_logs::ReadOptions::default())?;
        if input.log().stops().is_empty() {
            return Ok(None);
        }
        let settings = input.map_settings(None, None, None, &[])?;
        let watcher = Watcher::new(&self.interrupt, true);
        let mapped = Report::of_log("run.mcap", &mut input, &settings, str::to_owned, &watcher)?;
        Ok(mapped.map(|(report, _)| report))
    }
}

impl Story for RunStory {
    fn has_more(&mut self) -> bool {
        self.so_far.records() > self.told
    }

    fn document(&mut self, is_last: bool) -> Result<Option<Document>, String> {
        self.told = self.so_far.records();
        match self.report(is_last) {
            Ok(report) => Ok(Some(Document { text: report.to_json(), news: None })),
            // Nothing has happened yet.
            Err(ReportError::Empty { .. }) => Ok(None),
            Err(error) => Err(error.to_string()),
        }
    }
}
