//! Reproduction of the tables and figures of the thesis (2018, chapters 3 to 7): published values beside ours.
//!
//! Each experiment has the id of its table or figure, and runs scenarios that ship with the program with several seeds.
//! Nothing is fitted to published values. Where definitions differ, a note says how. Each published value names its table,
//! figure or section, and each conclusion is computed from the runs.
//!
//! # Tables are data
//! Each table is a file in `tables/CHAPTER/`, and `shared.toml` beside it has what several tables of the chapter refer to.
//! An entry of `[[lines]]` says what a line is called, its scenario, the cell of the scenario's sweep (`at`), the path of the
//! measure in the summary of a run, and the published value with its source:
//! ```toml
//! scenario = "ml-tm/trajectory-{trajectory}.toml"
//! source = "table 3.3"
//!
//! [lists]
//! trajectory = [{ id = "spiral", e_total_percent = "6" }, { id = "s", e_total_percent = "6" }]
//!
//! [[lines]]
//! each = ["trajectory"]
//! what = "{trajectory}: E_total, neighbourhood of 3 m"
//! measure = "maps.ml-tm.connectivity_error"
//! published = "{trajectory.e_total_percent}"
//!
//! [[conclusions]]
//! what = "E_total of S and spiral is less than a point apart"
//! measure = "maps.ml-tm.connectivity_error"
//! check = { within = 0.01 }
//! terms = [{ trajectory = "s" }, { trajectory = "spiral" }]
//! ```
//! `each` makes an entry for each combination of the items of lists, `only` chooses items, `with` and `terms` name one, and
//! `{list.field}` is filled in. Entries below an entry (`[[lines.lines]]`) have what it says. Unknown keys are errors.
//! Three kinds of lines are computed in another way: `at_least`, `least` and `likelihood`.
//!
//! # What the thesis leaves open
//! An entry of `[[open]]` names a setting or a definition that the thesis leaves open, the value that is taken, and others that
//! its text allows. Each is a reading, and so are pairs of names in `together`:
//! ```toml
//! [[open]]
//! name = "turns of the random walk"
//! key = "robots.controller.random_walk.steps_per_turn"
//! taken = "a new direction at each step"
//! says = "nothing"
//! scenarios = ["ml-tm/trajectory-random.toml"]
//! values = [{ value = "after 5 steps", set = ["robots.0.controller.random_walk.steps_per_turn=5"] }]
//! ```
//!
//! # Pictures
//! An entry of `[[pictures]]` shows a figure of the first run of a scenario on the page, by its name in `sextant figure`:
//! ```toml
//! [[pictures]]
//! each = ["trajectory"]
//! figure = "network"
//! title = "The way of the robot: {trajectory}"
//! ```

mod agreement;
mod better;
mod chart;
mod claim;
mod computation;
mod costs;
mod error;
mod expansion;
mod experiment;
mod experiment_page;
mod figures;
mod finding;
mod line;
mod open;
mod ours;
mod page;
mod pages;
mod picture;
mod published;
mod quantity;
mod reading;
mod readings;
mod reproduction;
mod results;
mod runs;
mod shipped;
mod table;
mod tables;
mod tally;
mod values;
mod variant;
mod words;

pub use agreement::Agreement;
pub use better::Better;
pub use chart::{Across, Chart, ChartKind, ChartLine};
pub use claim::{Check, Claim};
pub use computation::{Candidate, Computation, Least};
pub use costs::Costs;
pub use error::ReproductionError;
pub use experiment::Experiment;
pub use figures::{write_figures, write_pictures};
pub use finding::{Finding, Verdict};
pub use line::{Line, NamedReading, write_csv};
pub use open::OpenSetting;
pub use ours::Ours;
pub use pages::write_pages;
pub use picture::{FIGURES, Picture};
pub use published::Published;
pub use quantity::Quantity;
pub use reading::{Choice, Reading};
pub use readings::{Moved, Readings};
pub use reproduction::{first_seed, is_reproduction, json, write_json};
pub use results::Results;
pub use runs::{RunCounts, Runs, Term};
pub use shipped::{SHIPPED, write_scenarios};
pub use tables::{experiments, usual_runs};
pub use tally::{Tally, by_chapter};
pub use values::Values;
pub use variant::Variant;

#[cfg(test)]
mod tests;
