//! Recordings: MCAP files of runs, for viewers, mappers and people.
//!
//! A [`FileRecorder`] writes the events of a run to a file. Foxglove and Rerun can draw the file, [`read_log`] reads the
//! reception log from it, [`inspect`] lists its contents, and [`recover`] copies what is readable of a broken one.
//! Topics, types and units are described in `docs/recording.md`.
//!
//! ```
//! use sextant_recording::{FileRecorder, read_log};
//! use sextant_channel::{Position, Reception, Stop};
//! use sextant_kernel::{NodeId, RobotId, SimTime};
//!
//! let path = std::env::temp_dir().join(format!("sextant-doc-{}.mcap", std::process::id()));
//! let mut recorder = FileRecorder::create(&path)?;
//! recorder.nodes(&["a".to_owned(), "b".to_owned()])?;
//! let stop = Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(1.0, 2.0, 0.0), heading_rad: None };
//! let heard = Reception { node: NodeId(1), stop: 0, received: 3, sent: 5, sector: None, rssi_dbm: None, snr_db: None };
//! recorder.stop(None, "surveyor", 0, &stop, &[heard])?;
//! recorder.finish()?;
//!
//! assert_eq!(read_log(&path)?.log().receptions(), [heard]);
//! # std::fs::remove_file(&path).ok();
//! # Ok::<(), sextant_recording::RecordingError>(())
//! ```

pub mod admission;
pub mod antenna_text;
pub mod capture;
mod container;
pub mod disk;
mod drawing;
mod error;
mod link_quality;
pub mod mcap_file;
pub mod messages;
pub mod output;
mod reader;
mod recorder;
mod tables;

pub use capture::frame::{CapturedDmgFrame, CapturedFrame, Signal};
pub use capture::technologies::Technologies;
pub use capture::writer::{Capture, FileCapture};
pub use container::inspect::{AttachmentInfo, Inspection, Topic, inspect};
pub use container::recover::{Recovery, recover, unfinished_copy};
pub use drawing::{GridPlane, PlacedNode, Solid};
pub use error::RecordingError;
pub use foxglove::Schema;
pub use foxglove::messages::log::Level;
pub use link_quality::link_quality;
pub use mcap_file::salvage::Gap;
pub use mcap_file::{Damage, DamageKind};
pub use messages::names::{FILES_ATTACHMENTS, ORIGIN_METADATA, SCENARIO_ATTACHMENT, SUMMARY_ATTACHMENT};
pub use messages::phase::{Phase, SURVEY};
pub use messages::sensation::Sensation;
pub use output::foreign_folder::ForeignFolder;
pub use reader::activity::{FrameType, RecordedActivity, RecordedFrame};
pub use reader::course::{RecordedCourse, read_course};
pub use reader::known::{MutualKnowledge, read_known};
pub use reader::packets::{RecordedPacket, read_packets};
pub use reader::recorded_summary::ClaimedObstacle;
pub use reader::recording::{Recording, read_recording};
pub use reader::robot_names::RobotNames;
pub use reader::run::{Attachment, RecordedRun, TakeReception, read_log, read_run, read_truth, stream_log};
pub use reader::traffic::{RecordedDelays, RecordedOutcomes, RecordedTraffic};
pub use reader::way::Way;
pub use reader::world::applications::{RecordedApplication, RecordedCapture, RecordedTargetPlace};
pub use reader::world::distributed::{NodeRole, RecordedNode};
pub use reader::world::routing::{RecordedEdge, RecordedParent};
pub use reader::world::sensing::{Detection, RecordedField, RecordedTarget, Sample};
pub use reader::world::{Places, RecordedLikelihood, RecordedWorld, read_world};
pub use recorder::{FileRecorder, Origin, Recorder, RecordingSoFar, Relay};
pub use tables::{Cell, CellKind, LeftOut, OwnedRow, TableColumn, TablePiece, TableRow, read_tables, station};
