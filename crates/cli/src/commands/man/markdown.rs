//! The reference of all commands in Markdown.

use std::collections::BTreeMap;

use clap::builder::{PossibleValue, StyledStr};
use clap::{Arg, Command};

const PREFACE: &str = "# Reference of commands\n\n\
    Here is every command of the program with all of its arguments. `sextant COMMAND --help` prints the same.\n\n\
    `sextant man --format markdown` wrote this page.\n\n\
    Exit codes: 0 done, 1 failed, 2 usage or bad input, 130 interrupted.\n";

/// The reference of the program and all of its commands.
pub(super) fn page(program: &Command) -> String {
    let list = program.get_subcommands().map(|command| {
        let name = command.get_name();
        format!("| [`{name}`](#sextant-{name}) | {} |\n", cell(&text(command.get_about())))
    });
    let list: String = list.collect();
    let sections: String = program.get_subcommands().map(section).collect();
    format!("{PREFACE}\n| command | does |\n| --- | --- |\n{list}{sections}")
}

/// The section of one command: its purpose, its synopsis, its arguments and its options by heading.
fn section(command: &Command) -> String {
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").split_whitespace().collect::<Vec<_>>().join(" ");
    let about = text(command.get_long_about().or_else(|| command.get_about()));
    let mut section = format!("\n## sextant {}\n\n{}.\n\n`{usage}`\n", command.get_name(), escaped(&about));
    let mut headings: Vec<&str> = Vec::new();
    let mut tables: BTreeMap<&str, String> = BTreeMap::new();
    let arguments = command.get_arguments().filter(|argument| !argument.is_hide_set() && argument.get_id() != "help");
    for argument in arguments {
        let usual = if argument.is_positional() { "Arguments" } else { "Options" };
        let heading = argument.get_help_heading().unwrap_or(usual);
        if !headings.contains(&heading) {
            headings.push(heading);
        }
        tables.entry(heading).or_default().push_str(&row(argument));
    }
    for heading in headings {
        let title = heading.split(' ').next().unwrap_or(heading);
        section.push_str(&format!(
            "\n**{heading}**\n\n| {} | meaning |\n| --- | --- |\n",
            title.trim_end_matches('s').to_lowercase()
        ));
        section.push_str(&tables.remove(heading).unwrap_or_default());
    }
    section
}

/// The row of one argument: how it is written, its meaning, its values and its default.
fn row(argument: &Arg) -> String {
    let value = argument.get_value_names().filter(|_| argument.get_action().takes_values());
    let value: Vec<&str> = value.unwrap_or_default().iter().map(|name| name.as_str()).collect();
    let name = match (argument.get_long(), argument.get_short()) {
        (Some(long), Some(short)) => format!("-{short}, --{long}"),
        (Some(long), None) => format!("--{long}"),
        (None, Some(short)) => format!("-{short}"),
        (None, None) => String::new(),
    };
    let value = if value.is_empty() { String::new() } else { format!("<{}>", value.join("> <")) };
    let written = format!("{name} {value}");
    let mut meaning = cell(&text(argument.get_long_help().or_else(|| argument.get_help())));
    if !meaning.ends_with('.') {
        meaning.push('.');
    }
    if !argument.is_hide_possible_values_set() && argument.get_action().takes_values() {
        let values: Vec<PossibleValue> = argument.get_possible_values();
        for value in values.iter().filter(|value| !value.is_hide_set()) {
            let help = value.get_help().map_or_else(String::new, |help| format!(": {}", cell(&help.to_string())));
            meaning.push_str(&format!("<br>`{}`{help}", value.get_name()));
        }
    }
    let defaults: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if !defaults.is_empty() && argument.get_action().takes_values() {
        meaning.push_str(&format!("<br>Default: `{}`", defaults.join(" ")));
    }
    format!("| `{}` | {meaning} |\n", written.trim().replace('|', "\\|"))
}

fn text(styled: Option<&StyledStr>) -> String {
    styled.map(ToString::to_string).unwrap_or_default()
}

/// A text as a cell of a table: one line.
fn cell(text: &str) -> String {
    escaped(&text.split_whitespace().collect::<Vec<_>>().join(" ")).replace('|', "\\|")
}

/// A text in which nothing but code marks is markup.
fn escaped(text: &str) -> String {
    let part = |(i, part): (usize, &str)| {
        if i % 2 == 1 {
            return format!("`{part}`");
        }
        part.replace('<', "&lt;").replace('*', "\\*").replace('_', "\\_").replace('[', "\\[")
    };
    text.split('`').enumerate().map(part).collect()
}
