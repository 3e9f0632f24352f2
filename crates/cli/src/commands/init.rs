//! `sextant init`: a scenario to begin with.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::diagnostic::Failure;
use crate::terminal::stdout;
use sextant::shell;
use sextant::template::{Template, TemplateFile};
use sextant_recording::output::{open_folder, write_file};

/// Arguments of `sextant init`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// Which one
    #[arg(value_name = "TEMPLATE", default_value = "survey", value_parser = PossibleValuesParser::new(Template::all().iter().map(|template| template.name)))]
    pub(crate) template: String,
    /// Where it is written; `-` prints a scenario [default: TEMPLATE.toml, or a folder `log` or `track`]. An existing file is never
    /// overwritten
    #[arg(long, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// List the templates
    #[arg(long, conflicts_with = "out")]
    pub(crate) list: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.list {
        let mut stdout = stdout();
        for template in Template::all() {
            writeln!(stdout, "{:<12} {}", template.name, template.summary)?;
        }
        return Ok(());
    }
    let template = Template::named(&arguments.template)
        .ok_or_else(|| Failure::bad_input(format!("there is no template `{}`", arguments.template)))?;
    match (template.scenario(), &arguments.out) {
        (Some(scenario), Some(path)) if path == Path::new("-") => Ok(write!(stdout(), "{}", scenario.text)?),
        (Some(scenario), path) => write_scenario(scenario, path.as_deref().unwrap_or(Path::new(scenario.name))),
        (None, Some(path)) if path == Path::new("-") => {
            Err(Failure::bad_input(format!("the template `{}` is a folder, so it cannot be printed", template.name)))
        }
        (None, path) => write_folder(template, path.as_deref().unwrap_or(Path::new(template.name))),
    }
}

fn write_scenario(scenario: TemplateFile, path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        let help = format!("name a file in it: --out {}", shell::path(&path.join(scenario.name)));
        return Err(Failure::bad_input_with_help(format!("`{}` is a folder, not a file", path.display()), help));
    }
    if path.symlink_metadata().is_ok() {
        return Err(exists(path));
    }
    write_file(path, scenario.text_at(path).as_bytes())?;
    let (shown, file) = (path.display(), shell::path(path));
    let recording = shell::path(&path.with_extension("mcap"));
    writeln!(
        stdout(),
        "wrote {shown}\n\nGo on with:\n  sextant check {file}\n  sextant run {file} --out {recording}\n  sextant figure {recording} \
         --out pictures\n\nThe file explains each of its tables, and `sextant explain KEY` any key."
    )?;
    Ok(())
}

fn write_folder(template: &Template, path: &Path) -> Result<(), Failure> {
    let is_empty = || path.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    if path.symlink_metadata().is_ok() && !is_empty() {
        return Err(exists(path));
    }
    open_folder(path)?;
    for file in template.files {
        write_file(&path.join(file.name), file.text.as_bytes())?;
    }
    let (shown, commands) = (path.display(), template.commands_at(path).join("\n  "));
    let names: Vec<&str> = template.files.iter().map(|file| file.name).collect();
    writeln!(stdout(), "wrote {shown}: {}\n\nGo on with:\n  {commands}", names.join(", "))?;
    Ok(())
}

/// The error that something is there.
fn exists(path: &Path) -> Failure {
    let help = "nothing is overwritten: choose another --out, or remove it first";
    Failure::bad_input_with_help(format!("`{}` exists", path.display()), help)
}
