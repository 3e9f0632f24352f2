//! `sextant sweep DIR --cells A..B`.

use std::io::Write;

use super::super::sweep;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout};
use sextant::NumberRange;
use sextant_kernel::text::counted;
use sextant_study::campaign::{Campaign, CampaignError};

pub(super) fn execute(
    campaign: &Campaign,
    range: NumberRange,
    arguments: &sweep::Arguments,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let done = campaign.run(range, &watcher);
    watcher.clear();
    let done = match done {
        Err(CampaignError::Interrupted(_)) if interrupt.is_terminated() => return Err(Failure::Terminated),
        other => other?,
    };
    let before = range.len() - done;
    Ok(writeln!(stdout(), "{range}: {} done now, {before} before", counted(done, "run"))?)
}
