//! `sextant recover`: copies the readable part of a broken recording.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::options::Printing;
use super::outputs::{Replacing, admit, keep_logs};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use sextant_kernel::SimTime;
use sextant_recording::admission::OutputKind;
use sextant_recording::{Gap, recover, unfinished_copy};

/// Arguments of `sextant recover`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The broken recording; RUN.mcap.part after a crash
    #[arg(value_name = "BROKEN.mcap")]
    pub(crate) broken: PathBuf,
    /// The recording to write
    #[arg(long, value_name = "GOOD.mcap")]
    pub(crate) out: PathBuf,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut outputs = arguments.replacing.outputs();
    outputs.reads(&arguments.broken).writes("--out", &arguments.out, OutputKind::RecoveredRecording);
    admit(&outputs, None)?;
    keep_logs(None, [("--out", arguments.out.as_path())])?;
    let _temporary = interrupt.temporary(&unfinished_copy(&arguments.out));
    let recovery = recover(&arguments.broken, &arguments.out, interrupt)?;
    let (messages, out) = (recovery.messages, arguments.out.display());
    let mut text = format!("{messages} messages copied to {out}; ");
    match &recovery.damage {
        Some(damage) => text += &format!("the recording is broken at byte {}: {}", damage.at_byte, damage.why),
        None => text += "the recording was not broken",
    }
    for Gap { from_byte, to_byte, from_ns, to_ns, .. } in &recovery.gaps {
        let at = |time: &Option<u64>, end: &str| time.map_or_else(|| end.to_owned(), seconds);
        let (from, to) = (at(from_ns, "the start"), at(to_ns, "the end"));
        text += &format!("\nmissing: bytes {from_byte} to {to_byte}, messages from {from} to {to}");
    }
    Ok(arguments.printing.print(&recovery, |stdout| writeln!(stdout, "{text}"))?)
}

fn seconds(nanos: u64) -> String {
    format!("{:.3} s", SimTime::from_nanos(nanos).as_secs_f64())
}
