//! A robot in a room (section 7.4.2, figure 7.11).

use super::super::experiment::{Content, Experiment};
use super::super::published::Published;
use super::method::{METHODS, Method, Snr};
use super::seeking::{DEFINITIONS, EXPERIMENT, Seeking};

const ROOM: Seeking = Seeking {
    scenario: "seek/pioneer.toml",
    place: "",
    methods: METHODS,
    snrs: &[Snr::NoOffsets, Snr::Db20, Snr::Db10],
};

pub(super) fn experiment() -> Experiment {
    let id = "7.11";
    let title = "A robot in a room of 8 m × 7 m with offsets of the sensors";
    let noisy = |method: &Method, snr| {
        let is_published = method.is_level_set() && snr != Snr::NoOffsets;
        is_published.then(|| Published::new("\"performs well in noisy environments\"", EXPERIMENT))
    };
    let of_method = |method: &'static Method| {
        let arrives = ROOM.snrs.iter().map(move |&snr| ROOM.most_arrive(method, snr, noisy(method, snr)));
        arrives.chain([ROOM.true_on_average(method, Snr::NoOffsets), ROOM.true_on_average(method, Snr::Db10)])
    };
    Experiment {
        id,
        title,
        content: Content::Computed {
            scenarios: &[ROOM.scenario],
            lines: |runs| ROOM.lines(runs, |_, _| None),
            figures: |_| Vec::new(),
        },
        distributions: &[],
        charts: ROOM.charts(id, title),
        claims: METHODS.iter().flat_map(|&method| of_method(method)).collect(),
        notes: &[
            DEFINITIONS,
            "The thesis shows the ways of a real robot, without times. Its nodes, start and speed are not given; ours are in the scenario. \
             This is a simulation too.",
        ],
    }
}
