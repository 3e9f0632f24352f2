//! `sextant inspect`: the contents of a recording, or of the log of a robot.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::options::{Printing, start_threads, threads};
use super::reading::Reading;
use super::with_flags;
use crate::diagnostic::Failure;
use sextant::mapping::Contents;
use sextant_logs::{self as robot_log, CaptureContents, Source};
use sextant_recording::{self as recording, Inspection};

/// Arguments of `sextant inspect`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// A recording of `run`; or the log of a robot, as for `map`. For a log, it also prints what is odd in it, what that costs, and
    /// what corrects it
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Number of threads [default: one per core]. The results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
    /// How the log of a robot is read.
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// What is inside the log of a robot.
#[derive(Serialize)]
struct Inside {
    /// The file itself, if the log is a single bag.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    file: Option<Inspection>,
    /// The capture, if the log is one that cannot be mapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    capture: Option<CaptureContents>,
    /// The log; absent if the file is no log that can be mapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    log: Option<Contents>,
    /// Why it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_log: Option<String>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    start_threads(arguments.threads)?;
    let (path, options) = (&arguments.log, arguments.reading.options());
    let Some(source) = Source::of(path) else {
        robot_log::refuse_options(path, &options)?;
        let inspection = recording::inspect(path)?;
        return Ok(arguments.printing.print(&inspection, |stdout| write!(stdout, "{inspection}"))?);
    };
    let file = if source == Source::Bag && path.is_file() { recording::inspect(path).ok() } else { None };
    let file = file.map(|file| Inspection { is_simulated: false, ..file });
    let read = robot_log::read(path, &options);
    // Without a path a capture is no log, and has contents all the same.
    let capture = (source == Source::Captures && read.is_err())
        .then(|| robot_log::inspect_capture(path, &options.sniffer).ok())
        .flatten();
    let (log, no_log) = match read {
        Ok(read) => (Some(spoken(Contents::of(&read))), None),
        // So has a bag that cannot be mapped.
        Err(why) if file.is_some() || capture.is_some() => (None, Some(with_flags(&why.to_string()))),
        Err(why) => return Err(why.into()),
    };
    let inside = Inside { file, capture, log, no_log };
    Ok(arguments.printing.print(&inside, |stdout| {
        if let Some(file) = &inside.file {
            write!(stdout, "{file}")?;
        }
        if let Some(capture) = &inside.capture {
            write!(stdout, "{capture}")?;
        }
        if let Some(log) = &inside.log {
            write!(stdout, "{log}")?;
        }
        if let Some(why) = &inside.no_log {
            writeln!(stdout, "it cannot be mapped as it is: {why}")?;
        }
        Ok(())
    })?)
}

/// The contents with the words of the command line.
fn spoken(mut contents: Contents) -> Contents {
    contents.notes.iter_mut().for_each(|note| *note = with_flags(note));
    for finding in &mut contents.findings {
        finding.remedy = with_flags(&finding.remedy);
    }
    contents
}
