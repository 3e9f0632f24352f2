//! Sextant simulates wireless sensor networks, and works out where the nodes are from what robots and anchors heard.
//!
//! ```
//! use sextant::{Scenario, Unwatched};
//! # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))?;
//!
//! let scenario = Scenario::load("scenarios/smoke.toml")?.with("seed", 3)?;
//! let run = sextant::run(&scenario, &mut (), &Unwatched)?;
//! let map = &run.summary().maps[0];
//! let error_m = map.position_error_m.expect("the true places are known").mean;
//! println!("{}: {error_m:.2} m, {} nodes mapped", map.algorithm, map.mapped);
//! let log = &run.survey().expect("robots survey").logs.first();
//! let by_the_log_alone = sextant::map_log(log, "auto".parse()?, &Unwatched)?;
//! println!("{} nodes mapped", by_the_log_alone.summary.mapped);
//! # assert!(error_m < 5.0 && by_the_log_alone.summary.mapped > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`Scenario`] is a simulation as a file or text says it: read, checked, and changed key by key.
//! - [`run`](run()) simulates it, maps the nodes, measures the maps and runs the applications; [`survey`] simulates alone.
//! - [`SteppedRun`] is the same run, which its caller advances to one time after the other, and looks at in between.
//! - [`run_with`] does the same with controllers of robots and applications of stations of the caller's own: [`Programs`].
//! - [`RunObserver`] sees a run while it goes on. Recordings ([`RunRecorder`]) and captures ([`RunCapture`]) are observers; a
//!   pair of observers is one, and `()` sees nothing.
//! - [`Forecast`] is what follows from a scenario before it runs, and [`forecast::warnings`] what is likely a mistake.
//! - [`map_log`] maps a log that was made in code, or read by `sextant-logs` or `sextant-recording`; [`mapping`] has all
//!   settings of `sextant map`.
//! - [`explain_link`] says why a station hears another one, or not: the power between the two, item by item.
//! - [`antenna`] says what the sectors of an antenna cover, and makes code books of measurements in other formats.
//! - A scenario with many settings and seeds is a study: the crate `sextant-study`.
//! - [`Template`](template::Template)s are scenarios to begin with; [`scenario::explain`] says what a key means.
//! - [`Summary`] is the result of each of them, as the JSON object of `--summary`.
//! - [`kernel`], [`channel`], [`sim`], [`mapper`], [`logs`], [`recording`], [`figure`] and [`scenario`] are the crates below:
//!   their words are those of this one, so a program needs no other dependency.
//!
//! Long work asks a [`Watch`] whether to go on, and tells it how far it is; [`Unwatched`] goes on to the end. Each activity
//! has one type of errors. The same scenario and seed give the same bytes at any number of threads.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

pub mod antenna;
pub mod columns;
pub mod export;
pub mod forecast;
pub mod link;
pub mod mapping;
pub mod measure;
mod number_range;
pub mod run;
pub mod summary;
mod threads;

pub use export::{ExportError, export};
pub use forecast::Forecast;
pub use link::{LinkError, LinkReport, RayReport, explain_link, rays_csv};
pub use mapping::{LogMap, MapLogError, map_log};
pub use number_range::NumberRange;
pub use run::{Programs, Run, RunCapture, RunError, RunObserver, RunRecorder, SteppedRun, run, run_with, survey};
pub use sextant_channel as channel;
pub use sextant_figure as figure;
pub use sextant_kernel as kernel;
pub use sextant_kernel::{Unwatched, Watch};
pub use sextant_logs as logs;
pub use sextant_mapper as mapper;
pub use sextant_recording as recording;
pub use sextant_scenario as scenario;
pub use sextant_scenario::{AlgorithmName, Scenario, ScenarioErrors, shell, template};
pub use sextant_sim as sim;
pub use summary::Summary;
pub use threads::MOST_THREADS;
