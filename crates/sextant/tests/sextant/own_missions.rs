//! Missions that stand in no file of a scenario.

use sextant::Scenario;
use sextant::scenario::{MissionMap, PlannedMission};
use sextant::sim::NetworkId;

fn case() -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/target/case-1.toml");
    Scenario::load(file).expect("a good scenario")
}

/// What is wrong with a mission that differs from one of the scenario by `change`: the key, and what is allowed.
fn refused(change: impl FnOnce(&mut PlannedMission)) -> Option<(String, String)> {
    let scenario = case();
    let mut mission = scenario.missions()[0].clone();
    mission.name = "another".to_owned();
    change(&mut mission);
    let error = scenario.with_mission(mission).err()?;
    Some((error.key.clone(), error.allowed().to_owned()))
}

#[test]
fn a_mission_that_the_scenario_cannot_have_is_refused_with_its_key() {
    assert_eq!(refused(|_| {}), None);
    let key = |change: fn(&mut PlannedMission)| refused(change).map(|(key, _)| key);
    assert_eq!(key(|mission| mission.name = "survey".to_owned()).as_deref(), Some("mission.name"));
    assert_eq!(key(|mission| mission.name = "detarsk-thesis".to_owned()).as_deref(), Some("mission.name"));
    assert_eq!(key(|mission| mission.name = "a/b".to_owned()).as_deref(), Some("mission.name"));
    assert_eq!(key(|mission| mission.network = NetworkId(7)).as_deref(), Some("network"));
    assert_eq!(key(|mission| mission.robots.clear()).as_deref(), Some("robots"));
    assert_eq!(key(|mission| mission.robots = vec![99]).as_deref(), Some("robots"));
    assert_eq!(key(|mission| mission.map = MissionMap::Computed("none".to_owned())).as_deref(), Some("map"));
    let asleep =
        Scenario::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml")).expect("a scenario");
    let mut mission = case().missions()[0].clone();
    (mission.name, mission.map) = ("another".to_owned(), MissionMap::Physical);
    assert_eq!(
        asleep.with_mission(mission).err().map(|error| error.key).as_deref(),
        Some("network"),
        "nodes that sleep"
    );
    let short = MissionMap::File { name: "places.csv".to_owned(), places: vec![None] };
    let (_, allowed) = refused(|mission| mission.map = short).expect("one place for many nodes");
    assert!(allowed.starts_with("a place, or none, for each of"), "{allowed}");
}
