//! The robots and sinks of a recording by their names in its scenario.

use sextant_recording::{RecordedRun, SCENARIO_ATTACHMENT};

/// The robots and sinks of a scenario (TOML), as `robot` or `sink` and name. Robots come first.
pub(super) fn of_scenario(toml: &[u8]) -> Vec<(&'static str, String)> {
    let table = std::str::from_utf8(toml).ok().and_then(|text| text.parse::<toml::Table>().ok()).unwrap_or_default();
    let named = |kind: &'static str, key: &str| {
        let list = table.get(key).and_then(toml::Value::as_array);
        let name = |station: &toml::Value| Some((kind, station.get("name")?.as_str()?.to_owned()));
        list.into_iter().flatten().filter_map(name).collect::<Vec<_>>()
    };
    [named("robot", "robots"), named("sink", "sinks")].concat()
}

/// The names of all stations of a recorded run, by index: nodes come first, then robots, then sinks.
#[must_use]
pub fn station_names(run: &RecordedRun) -> Vec<String> {
    let scenario = run.attachment(SCENARIO_ATTACHMENT).map_or(&[][..], |attachment| &attachment.data);
    let others = of_scenario(scenario).into_iter().map(|(_, name)| name);
    run.log().names().iter().cloned().chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_come_before_sinks() {
        let toml = b"[[sinks]]\nname = \"s\"\n[[robots]]\nname = \"a\"\n[[robots]]\nname = \"b\"\n";
        let found = of_scenario(toml);
        let found: Vec<_> = found.iter().map(|(kind, name)| (*kind, name.as_str())).collect();
        assert_eq!(found, [("robot", "a"), ("robot", "b"), ("sink", "s")]);
        assert_eq!(of_scenario(b"no = "), []);
    }
}
