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
//! # The types to begin with
//! - [`Scenario`]: a simulation as a file or text says it, read, checked, and changed key by key. [`ScenarioErrors`] are all its
//!   mistakes at once.
//! - [`run`](run()): simulates a scenario, maps the nodes, measures the maps and runs the applications. [`survey`] simulates alone.
//! - [`SteppedRun`]: the same run, which its caller advances to one time after the other, and looks at in between.
//! - [`Run`]: what comes out, with its [`Summary`]: all results, as the JSON object of `--summary`. [`RunError`] is what goes wrong.
//! - [`Programs`]: controllers of robots and applications of stations of the caller's own, for [`run_with`].
//! - [`RunObserver`]: sees a run while it goes on. A pair of observers is one, and `()` sees nothing.
//! - [`RunRecorder`] and [`RunCapture`]: observers that write recordings (MCAP) and captures (pcap).
//! - [`map_log`]: maps a [`ReceptionLog`](channel::ReceptionLog) that was made in code, or read by [`logs`] or [`recording`].
//! - [`LogMap`]: the map, and what its estimator learned; [`MapLogError`] is what goes wrong.
//! - [`AlgorithmName`]: an estimator by its name, such as `"auto".parse()?`.
//! - [`Watch`]: asked by long work whether to go on, and told how far it is; [`Unwatched`] goes on to the end.
//! - [`Forecast`]: what follows from a scenario before it runs.
//! - [`explain_link`]: why a station hears another one, or not.
//! - [`floorplan`]: walls of a scenario from an image, a map of ROS or GeoJSON.
//! - [`next`]: where a robot listens next, so that the map of its log becomes better.
//! - [`export`](export()): the tables of a recording as files.
//!
//! # What is in the crates below
//! They are modules of this crate, so a program needs no other dependency.
//! - [`scenario`]: scenarios, [`Template`](template::Template)s to begin with, and what a key means.
//! - [`kernel`]: [`SimTime`](kernel::SimTime), [`NodeId`](kernel::NodeId), [`RobotId`](kernel::RobotId) and random numbers.
//! - [`channel`]: [`Position`](channel::Position), and logs of [`Stop`](channel::Stop)s and [`Reception`](channel::Reception)s.
//! - [`sim`]: what an [`Observer`](sim::Observer) sees of a simulation, and what a [`Snapshot`](sim::Snapshot) of it shows.
//!   - A [`Controller`](sim::Controller) of a robot looks at its [`Situation`](sim::Situation), with the
//!     [`CommandOutcome`](sim::CommandOutcome), and gives a [`RobotCommand`](sim::RobotCommand), the last one with an
//!     [`Ending`](sim::Ending).
//!   - An [`Application`](sim::Application) of a station has a [`Port`](sim::Port) to send a [`Payload`](sim::Payload) to a
//!     [`Destination`](sim::Destination) in a network ([`NetworkId`](sim::NetworkId)). It gets a [`Delivery`](sim::Delivery), or
//!     a [`Timer`](sim::Timer).
//! - [`apps`]: a [`Mission`](apps::Mission) of stations on a map; [`Scenario::with_mission`] adds one of your own.
//! - [`mapper`]: a [`TopologyMap`](mapper::TopologyMap) in its [`CoordinateFrame`](mapper::CoordinateFrame), and its
//!   [`PositionError`](mapper::PositionError).
//! - [`logs`]: logs of real robots. [`recording`]: recordings, read and written.
#![cfg_attr(feature = "figures", doc = "- [`figure`]: pictures of recordings, maps and logs (feature `figures`).")]
//!
//! A scenario with many settings and seeds is a study: the crate `sextant-study`.
//!
//! Each activity has one type of errors. The same scenario and seed give the same bytes at any number of threads.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

pub mod antenna;
pub mod columns;
pub mod export;
pub mod floorplan;
pub mod forecast;
pub mod link;
pub mod mapping;
mod measure;
pub mod next;
pub mod run;
pub mod summary;
mod threads;

// Scenarios, and runs of them.
pub use run::{Programs, Run, RunCapture, RunError, RunObserver, RunRecorder, SteppedRun, run, run_with, survey};
pub use sextant_kernel::{Unwatched, Watch};
pub use sextant_scenario::{AlgorithmName, Scenario, ScenarioErrors, shell, template};
pub use summary::Summary;

// Logs, recordings and links.
pub use export::export;
pub use forecast::Forecast;
pub use link::{LinkError, explain_link};
pub use mapping::{LogMap, MapLogError, map_log};

// Limits of what may be asked for.
pub use sextant_recording::output::store::NumberRange;
pub use threads::MOST_THREADS;

// The crates below.
pub use sextant_apps as apps;
pub use sextant_channel as channel;
#[cfg(feature = "figures")]
pub use sextant_figure as figure;
pub use sextant_kernel as kernel;
pub use sextant_logs as logs;
pub use sextant_mapper as mapper;
pub use sextant_recording as recording;
pub use sextant_scenario as scenario;
pub use sextant_sim as sim;
