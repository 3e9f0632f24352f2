//! Applications that are refused, each with its key and what is allowed.

use super::{AGENT, FIELD, NODES, SEEKING, seeking};
use crate::program::check_text;

/// What `check` says of an invalid scenario, beside which there may be a file `map.csv`.
pub(super) fn refused(scenario: &str, map: Option<&str>) -> String {
    check_text(scenario, &map.map(|map| ("map.csv", map)).into_iter().collect::<Vec<_>>())
}

#[test]
fn invalid_applications_are_refused_at_their_key() {
    let good = seeking();
    let physical = "map.physical = {}";
    for (scenario, key, allowed) in [
        (
            good.replacen(physical, "map.computed = \"no-such\"", 1),
            "`applications[0].map.computed` is `no-such`",
            "`[[maps]]`, of which the scenario has none",
        ),
        (good.replace("count = 36", "count = 2"), "`applications[0].map` is a map of 2 nodes", "at least 3 nodes"),
        (good.replacen(&format!("{physical}\n"), "", 1), "`map` is missing in `applications[0]`", ""),
        (
            good.replacen(physical, &format!("{physical}\nrobots = [\"nobody\"]"), 1),
            "`applications[0].robots[0]` is `nobody`",
            "`agent`",
        ),
        (
            good.replacen(physical, &format!("{physical}\nrobots = [\"agent\", \"agent\"]"), 1),
            "`applications[0].robots[1]`",
            "each robot once",
        ),
        ([NODES, FIELD, SEEKING].concat(), "`applications[0].robots` is no robot", "role = \"agent\""),
        (
            [NODES, AGENT, SEEKING].concat(),
            "`applications[0].algorithm` is `gradient`, without fields",
            "[[world.fields]]",
        ),
        (
            good.replace("[sensors.fields]\ninterval_s = 1.0\n", ""),
            "`applications[0].algorithm` is `gradient`, without sensors of fields",
            "[sensors.fields]",
        ),
        (
            good.replacen("level = 9.0", "level = 11.0", 1),
            "`applications[0].algorithm.gradient.goal.level` is 11, which the field `gas` has nowhere",
            "at most 10",
        ),
        (
            good.replace("rx_on_when_idle = true", "rx_on_when_idle = false"),
            "`mac.csma_unslotted.rx_on_when_idle` is false",
            "at any time",
        ),
        (
            good.replacen(physical, &format!("{physical}\nnetwork = \"x\""), 1),
            "`applications[0].network` is `x`",
            "no name",
        ),
        (
            good.replacen("name = \"law\"", "name = \"gradient\"", 1),
            "the name of an earlier application",
            "a unique name",
        ),
        (good.replacen("name = \"law\"", "name = \"survey\"", 1), "the name of the first phase", "a unique name"),
        (good.replacen("duration_s = 60.0", "duration_s = 0.0", 1), "`applications[0].duration_s` is 0", ""),
        (
            good.replace("role = \"agent\"", "role = \"agent\"\ncontroller.waypoints.places_m = [[1.0, 2.0]]"),
            "`robots[0].controller` conflicts with `role = \"agent\"`",
            "applications drive",
        ),
        (
            good.replace("role = \"agent\"\n", ""),
            "`robots[0].controller` is missing",
            "`role = \"agent\"` for applications alone",
        ),
    ] {
        let said = refused(&scenario, None);
        assert!(said.contains(key) && said.contains(allowed), "{key}: {said}");
    }
}

#[test]
fn goals_and_estimates_are_refused_at_their_key() {
    let goal = "`applications[0].algorithm.gradient.goal`";
    let law = "applications[1].algorithm.level_set";
    let gradient = |goal: &str| seeking().replacen("{ goal = { level = 9.0 } }", &format!("{{ goal = {goal} }}"), 1);
    let level_set = |more: &str| seeking().replacen("delta = 0.5", &format!("delta = 0.5, {more}"), 1);
    for (scenario, key, allowed) in [
        (gradient("\"sources\""), format!("unknown choice `sources` for {goal}"), "did you mean `source`?"),
        (gradient("3"), format!("{goal} is the integer 3"), "allowed: \"source\", or a table with `level`"),
        (gradient("{ levl = 9.0 }"), format!("unknown key `levl` in {goal}"), "did you mean `level`?"),
        (gradient("\"level\""), format!("`level` is missing in {goal}"), ""),
        (
            level_set("estimate = { local_fit = {}, weights = \"equal\" }"),
            format!("`{law}.estimate.local_fit` conflicts with `weights`"),
            "set one of them",
        ),
        (
            level_set("poll = { ideal = true, interval_s = 1.0 }"),
            format!("`{law}.poll.interval_s` conflicts with `ideal = true`"),
            "or set `ideal = false`",
        ),
    ] {
        let said = refused(&scenario, None);
        assert!(said.contains(&key) && said.contains(allowed), "{key}: {said}");
    }
    let loud = level_set("estimate.weights = \"dbm_ratio\"");
    let radio = |line: &str| line.starts_with("tx_power_dbm = ").then_some("tx_power_dbm = 0.0");
    let loud: Vec<&str> = loud.lines().map(|line| radio(line).unwrap_or(line)).collect();
    let said = refused(&loud.join("\n"), None);
    assert!(said.contains(&format!("`{law}.estimate.weights`")) && said.contains("`equal` or `power`"), "{said}");
}

#[test]
fn maps_in_files_must_be_maps_of_the_nodes() {
    let scenario = seeking().replacen("map.physical = {}", "map.file = \"map.csv\"", 1);
    for (map, message) in [
        (None, "cannot read"),
        (Some("node,x_m\nn0,0\n"), "column `y_m` is missing"),
        (Some("node,x_m,y_m\nn0,0,0\nn1,1,0\nnobody,2,0\n"), "the node `nobody` has a place"),
        (Some("node,x_m,y_m\nn0,0,0\nn1,1,0\n"), "2 nodes; allowed: at least 3 nodes"),
        (Some("node,x_m,y_m\nn0,0,zero\n"), "found `zero`"),
    ] {
        let said = refused(&scenario, map);
        assert!(said.contains("`applications[0].map.file`") && said.contains(message), "{message}: {said}");
    }
}

#[test]
fn maps_of_receptions_need_a_survey() {
    let map = "[[maps]]\nname = \"heard\"\nalgorithm.ml_tm = { grid_step_m = 0.5, profile.fitted = {} }\n";
    let scenario = [&seeking().replace("map.physical = {}", "map.computed = \"heard\""), map].concat();
    let said = refused(&scenario, None);
    assert!(
        said.contains("`robots` is no surveying robot") && said.contains("`heard` is made from what robots hear"),
        "{said}"
    );
}

#[test]
fn applications_need_a_network_of_packets() {
    let sweeps = "
[networks.a.radio]
tx_power_dbm = 20.0
sensitivity_dbm = -60.0
[networks.a.channel]
environment = \"dmmtm-greenhouse\"
path_loss.close_in.carrier_ghz = 73.0
shadowing.correlation = \"per_link\"
[networks.a.mac.sector_sweep]
[networks.a.antenna.nodes.sectors]
azimuth_sectors = 8
[networks.a.antenna.robots.sectors]
azimuth_sectors = 8
";
    let (nodes, _) = NODES.split_once("[radio]").unwrap();
    let said = refused(&[nodes, sweeps, FIELD, AGENT, SEEKING].concat(), None);
    assert!(
        said.contains("`applications[0].network` is `a`, with sector sweeps") && said.contains("IEEE 802.15.4"),
        "{said}"
    );
}
