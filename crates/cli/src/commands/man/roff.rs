//! The manual pages.

use std::io::{self, Write};

use clap::Command;
use clap_mangen::Man;

const EXIT_STATUS: &str = ".SH \"EXIT STATUS\"\n0 done, 1 failed, 2 usage or bad input, 130 interrupted.";

/// One page for the program and all of its commands.
pub(super) fn page(command: Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    let main = Man::new(command.clone());
    main.render_title(&mut page)?;
    main.render_name_section(&mut page)?;
    main.render_synopsis_section(&mut page)?;
    main.render_description_section(&mut page)?;
    main.render_options_section(&mut page)?;
    for subcommand in command.get_subcommands() {
        section(subcommand, &mut page)?;
    }
    writeln!(page, "{EXIT_STATUS}")?;
    main.render_version_section(&mut page)?;
    Ok(page)
}

/// The page of one command. Its commands, if it has some, have pages of their own.
pub(super) fn page_of(command: &Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    let man = Man::new(command.clone().version(env!("CARGO_PKG_VERSION")));
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    writeln!(page, "{EXIT_STATUS}\n.SH \"SEE ALSO\"\nsextant(1)")?;
    Ok(page)
}

/// The section of one command: its purpose, its synopsis and its options.
fn section(command: &Command, page: &mut Vec<u8>) -> io::Result<()> {
    writeln!(page, ".SH \"SEXTANT {}\"", command.get_name().to_uppercase())?;
    if let Some(about) = command.get_about() {
        writeln!(page, "{about}.")?;
    }
    let man = Man::new(command.clone());
    let mut parts = Vec::new();
    man.render_synopsis_section(&mut parts)?;
    man.render_options_section(&mut parts)?;
    let parts = String::from_utf8_lossy(&parts).replace(".SH ", ".SS ");
    page.extend_from_slice(parts.as_bytes());
    Ok(())
}
