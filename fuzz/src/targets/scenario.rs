//! A scenario as one text.

use sextant::forecast::warnings;
use sextant::{Forecast, Scenario};

use crate::budget::is_small;
use crate::properties::{errors_are_clear, runs};

/// It is refused with clear errors, or its forecast can be told and, if that is short, it runs.
pub(crate) fn check(octets: &[u8]) {
    let Ok(text) = std::str::from_utf8(octets) else { return };
    // Its files are in a folder that does not exist: what is read from the disk is no part of the input.
    match Scenario::parse(text).and_then(|scenario| scenario.check_grids().map(|()| scenario)) {
        Ok(scenario) => accepted(&scenario),
        Err(errors) => errors_are_clear(&errors),
    }
}

/// What holds of a scenario that is accepted.
pub(crate) fn accepted(scenario: &Scenario) {
    let (_, forecast) = (warnings(scenario), Forecast::of(scenario));
    if let Some(cost) = forecast.cost {
        let numbers = [Some(cost.frames), cost.events, cost.cpu_s];
        assert!(numbers.into_iter().flatten().all(f64::is_finite), "{cost:?}");
    }
    let again = Scenario::parse(scenario.text()).map(|again| again.text().to_owned());
    assert!(again.is_ok_and(|again| again == scenario.text()), "the text of the scenario reads as another one");
    if is_small(scenario) {
        runs(scenario);
    }
}
