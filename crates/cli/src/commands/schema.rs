//! `sextant schema`: the JSON schema of scenario files, for editors and programs.

use std::io::{self, Write};

use crate::diagnostic::Failure;
use crate::terminal::stdout;
use sextant::scenario::schema_of_files;

pub(crate) fn execute() -> Result<(), Failure> {
    let mut stdout = stdout();
    serde_json::to_writer_pretty(&mut stdout, &schema_of_files()).map_err(io::Error::from)?;
    writeln!(stdout)?;
    Ok(())
}
