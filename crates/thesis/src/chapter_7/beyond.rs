//! What the thesis does not have: obstacles in the way, and a robot in space.

use super::super::experiment::{Content, Experiment};
use super::method::{LEVEL_SET, METHODS, Snr};
use super::seeking::{DEFINITIONS, Seeking};

const OBSTACLES: Seeking =
    Seeking { scenario: "seek/obstacles.toml", place: "obstacles", methods: METHODS, snrs: Snr::ALL };

const SPACE: Seeking = Seeking {
    scenario: "seek/space.toml",
    place: "space",
    methods: &[&LEVEL_SET],
    snrs: &[Snr::NoOffsets, Snr::Db20, Snr::Db10],
};

pub(super) fn experiment() -> Experiment {
    let of_obstacles = METHODS.iter().flat_map(|method| [Snr::Db20, Snr::Db10].map(|snr| (OBSTACLES, *method, snr)));
    let of_space = SPACE.snrs.iter().map(|&snr| (SPACE, &LEVEL_SET, snr));
    let mut charts = OBSTACLES.charts("seek-obstacles", "Source seeking around obstacles");
    charts.extend(SPACE.charts("seek-space", "Source seeking in space"));
    Experiment {
        id: "seek",
        title: "Source seeking around obstacles and in space, which the thesis does not have",
        content: Content::Computed {
            scenarios: &[OBSTACLES.scenario, SPACE.scenario],
            lines: |runs| [OBSTACLES, SPACE].iter().flat_map(|seeking| seeking.lines(runs, |_, _| None)).collect(),
            figures: |_| Vec::new(),
        },
        distributions: &[],
        charts,
        claims: of_obstacles
            .chain(of_space)
            .map(|(seeking, method, snr)| seeking.most_arrive(method, snr, None))
            .collect(),
        notes: &[DEFINITIONS],
    }
}
