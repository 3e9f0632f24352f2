//! Programs that fit no station are refused in words.

use sextant::sim::{Controller, Ending, RobotCommand, Situation};
use sextant::{Programs, Scenario, Unwatched};

use super::{Counter, shipped, star};

#[test]
fn programs_that_fit_no_station_are_refused_with_the_names_there_are() {
    let refused = |scenario: &Scenario, programs: Programs<'_>| {
        sextant::run_with(scenario, programs, &mut (), &Unwatched).map(drop).expect_err("refused").to_string()
    };
    let application = || Box::new(Counter::default());
    let controller = || Box::new(Idle) as Box<dyn Controller>;
    let (smoke, star) = (shipped("smoke.toml"), star());
    let node = refused(&smoke, Programs::default().with_node("nod", application()));
    assert!(node.starts_with("a program is given to the node `nod`, which is not in the scenario; its nodes: `"));
    assert!(node.ends_with(" and 20 more"), "{node}");
    for (scenario, programs, expected) in [
        (
            &smoke,
            Programs::default().with_controller("rover", controller()),
            "the robot `rover`, which is not in the scenario; its robots: `surveyor`",
        ),
        (
            &star,
            Programs::default().with_robot("rover", application()),
            "which is not in the scenario; it has no robot",
        ),
        (
            &star,
            Programs::default().with_sink("north", application()),
            "the sink `north`, which is not in the scenario; its sinks: `west`, `east`",
        ),
        (
            &smoke,
            Programs::default().with_controller("surveyor", controller()).with_robot("surveyor", application()),
            "the robot `surveyor` is given a controller and an application; give it one of them",
        ),
    ] {
        let message = refused(scenario, programs);
        assert!(message.contains(expected), "{message}");
    }
    let agents = shipped("target/case-1.toml");
    let agent = &agents.config().robots[0].name;
    let message = refused(&agents, Programs::default().with_controller(agent, controller()));
    assert!(message.contains("with the role `agent`; allowed: a robot with the role `survey`"), "{message}");
}

#[test]
fn programs_need_a_survey_in_which_they_run() {
    let agents = shipped("target/case-1.toml");
    let node = agents.world().nodes[0].name.clone();
    let programs = Programs::default().with_node(&node, Box::new(Counter::default()));
    let message =
        sextant::run_with(&agents, programs, &mut (), &Unwatched).map(drop).expect_err("refused").to_string();
    assert!(message.starts_with("programs are given, but the scenario has no survey in which they run"), "{message}");
}

/// Finishes at once.
#[derive(Clone)]
struct Idle;

impl Controller for Idle {
    fn decide(&mut self, _: &Situation<'_>) -> RobotCommand {
        RobotCommand::Finish(Ending::Complete)
    }
}

#[test]
fn nodes_that_compute_a_map_keep_their_application() {
    let scenario = shipped("dmtm/rf.toml");
    let name = scenario.world().nodes[0].name.clone();
    let programs = Programs::default().with_node(&name, Box::new(Counter::default()));
    let message = sextant::run_with(&scenario, programs, &mut (), &Unwatched).map(drop).expect_err("refused");
    let expected = format!(
        "an application is given to the node `{name}`, but the nodes compute a map; \
         remove the application or `[distributed_mapping]`"
    );
    assert_eq!(message.to_string(), expected);
    assert!(!message.is_system_error());
}
