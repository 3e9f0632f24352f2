//! Each example of the guide runs.

#[path = "../../../../examples/aloha.rs"]
pub(crate) mod aloha;
#[path = "../../../../examples/map_log.rs"]
mod map_log;
#[path = "../../../../examples/own_application.rs"]
mod own_application;
#[path = "../../../../examples/own_controller.rs"]
mod own_controller;
#[path = "../../../../examples/own_estimator.rs"]
mod own_estimator;
#[path = "../../../../examples/own_mission.rs"]
mod own_mission;
#[path = "../../../../examples/stepped.rs"]
mod stepped;
#[path = "../../../../examples/survey.rs"]
mod survey;
#[path = "../../../../examples/tdma.rs"]
pub(crate) mod tdma;
#[path = "../../../../examples/x_mac.rs"]
pub(crate) mod x_mac;

#[test]
fn a_scenario_is_run_and_observed() {
    survey::main().unwrap();
}

#[test]
fn a_run_is_looked_at_on_its_way() {
    stepped::main().unwrap();
}

#[test]
fn a_log_made_in_code_is_mapped() {
    map_log::main().unwrap();
}

#[test]
fn a_robot_drives_as_its_own_controller_says() {
    own_controller::main().unwrap();
}

#[test]
fn a_message_floods_nodes_with_their_own_application() {
    own_application::main().unwrap();
}

#[test]
fn a_robot_visits_the_nodes_with_the_lowest_batteries() {
    own_mission::main().unwrap();
}

#[test]
fn an_own_estimator_is_compared() {
    own_estimator::main().unwrap();
}

#[test]
fn channel_access_of_ones_own_is_shown_beside_its_closed_forms() {
    aloha::main().unwrap();
    tdma::main().unwrap();
    x_mac::main().unwrap();
}

#[test]
fn the_guide_shows_each_example() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let pages = ["docs/library.md", "docs/own-radio.md"];
    let guide: String = pages.map(|page| std::fs::read_to_string(root.join(page)).unwrap()).concat();
    for example in std::fs::read_dir(root.join("examples")).unwrap() {
        let path = example.unwrap().path();
        let code = std::fs::read_to_string(&path).unwrap();
        assert!(guide.contains(&code), "{pages:?} do not show {}", path.display());
    }
}
