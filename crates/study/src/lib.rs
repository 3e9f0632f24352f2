//! Parameter studies of Sextant: a scenario with many settings and seeds, and its results in one table.
//!
//! In goes a scenario with a table `[sweep]`. Out come rows: one for each cell, run and map. They depend on scenario, seeds and
//! version alone, and not on how the work was divided.
//!
//! ```
//! use sextant::Unwatched;
//! use sextant_study::Sweep;
//! use sextant_study::sweep::{self, Mean};
//!
//! let folder = std::env::temp_dir().join(format!("sextant-study-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! let template = sextant::template::Template::named("mac").and_then(|template| template.scenario()).expect("a template");
//! let axis = "[sweep.product]\ntraffic.poisson.rate_per_s = [4.0, 8.0]\n";
//! let path = folder.join("study.toml");
//! std::fs::write(&path, format!("{}\n{axis}", template.text))?;
//! let plan = Sweep::read(&path, &[], None, std::num::NonZeroU32::new(3))?;
//! let (rows, outcome) = sweep::rows(std::slice::from_ref(&plan), &Unwatched);
//! outcome?;
//! assert_eq!((plan.cells().len(), rows[0].len()), (2, 6));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`Sweep`] is a scenario with its cells and seeds; [`sweep::run`] does it on all cores, and [`sweep::rows`] in memory.
//! - [`Campaign`] is a sweep as a plan in a folder, which several machines do part by part; [`campaign::slurm`] makes jobs of it.
//! - [`sweep::write_table`] writes the tidy table, [`FinishedTable`](sweep::FinishedTable) reads one of anybody, and
//!   [`StudyFigures`](sweep::StudyFigures) draws it.
//! - [`Mean`](sweep::Mean) and [`Share`](sweep::Share) are results of several runs with their 95 % intervals.
//!
//! The axes as written are checked by `sextant-scenario`; a run is one of `sextant`.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

pub mod campaign;
pub mod sweep;

pub use campaign::{Campaign, CampaignError};
pub use sweep::{Sweep, SweepError};
