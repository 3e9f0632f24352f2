//! Options of the library in the words of the command line.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use clap::CommandFactory;

use super::Cli;

/// The names of the options that flags of `map` set. They are asked for once: a log may have thousands of notes.
static OPTIONS: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let command = Cli::command();
    let map = command.find_subcommand("map").expect("there is the command `map`");
    let flags = map.get_arguments().filter(|argument| argument.get_long().is_some());
    flags.map(|argument| argument.get_id().to_string()).collect()
});

/// The text with the options of the library as flags: `` option `skip_no_fix` `` becomes `` `--skip-no-fix` ``, and
/// `` `packet_delay=auto` `` becomes `` `--packet-delay auto` ``.
pub(crate) fn with_flags(text: &str) -> String {
    let is_option = |name: &str| OPTIONS.contains(name);
    let flag = |name: &str| format!("--{}", name.replace('_', "-"));
    let mut spoken = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, quoted)) = rest.split_once('`')
        && let Some((quoted, after)) = quoted.split_once('`')
    {
        match (quoted.split_once('='), before.strip_suffix("option ").or_else(|| before.strip_suffix("Option "))) {
            (Some((name, value)), _) if is_option(name) => spoken += &format!("{before}`{} {value}`", flag(name)),
            (None, Some(before)) if is_option(quoted) => spoken += &format!("{before}`{}`", flag(quoted)),
            _ => spoken += &format!("{before}`{quoted}`"),
        }
        rest = after;
    }
    spoken + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_become_flags_and_nothing_else_changes() {
        for (text, spoken) in [
            (
                "give `packet_delay=auto`, or leave option `skip_no_fix` out",
                "give `--packet-delay auto`, or leave `--skip-no-fix` out",
            ),
            ("option `packet_fields` has `t_s=time`", "`--packet-fields` has `t_s=time`"),
            ("`path` is a column, and ` is alone", "`path` is a column, and ` is alone"),
        ] {
            assert_eq!(with_flags(text), spoken);
        }
    }
}
