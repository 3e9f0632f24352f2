//! Options of the library in the words of the command line.

use clap::CommandFactory;

use super::Cli;

/// The text with the options of the library as flags: `` option `skip_no_fix` `` becomes `` `--skip-no-fix` ``, and
/// `` `packet_delay=auto` `` becomes `` `--packet-delay auto` ``.
pub(crate) fn with_flags(text: &str) -> String {
    let command = Cli::command();
    let map = command.find_subcommand("map").expect("there is the command `map`");
    let is_option =
        |name: &str| map.get_arguments().any(|argument| argument.get_long().is_some() && argument.get_id() == name);
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
