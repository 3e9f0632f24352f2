//! `sextant schema`: the JSON schema of scenario files, for editors and programs.

use std::io::{self, Write};

use crate::diagnostic::Failure;
use sextant::scenario::schema;

pub(crate) fn execute() -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    serde_json::to_writer_pretty(&mut stdout, &schema()).map_err(io::Error::from)?;
    writeln!(stdout)?;
    Ok(())
}
