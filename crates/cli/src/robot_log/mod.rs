//! Logs of real robots: a folder of CSV files, and the maps that come of them.
//!
//! Goes in: a folder with `stops.csv` and `receptions.csv`, `contacts.csv` if the robot has a range
//! sensor, and `sectors.csv` if its antenna has sectors. Comes out:
//! the reception log that a mapper reads, or an error with file, line and column. A byte order mark, either line ending,
//! any order of columns and quoted cells are understood; a column of unknown name is refused, because a misspelt
//! `sent` must not pass for an absent one. The columns and their meaning are in `docs/recording.md`.
//!
//! ```
//! use sextant::robot_log;
//!
//! let folder = std::env::temp_dir().join(format!("sextant-log-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! std::fs::write(folder.join("stops.csv"), "stop,t_s,x_m,y_m\nA,0,0,0\nB,1.5,1,0\n")?;
//! std::fs::write(folder.join("receptions.csv"), "node,stop,received,sent\nlamp,B,3,5\ndoor,A,0,5\n")?;
//! let log = robot_log::read(&folder)?;
//! assert_eq!(log.names(), ["lamp", "door"]);
//! assert_eq!(log.stops().len(), 2);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod folder;
mod instant;
mod map;
mod output;
mod sectors;
mod table;
mod truth;

pub use error::RobotLogError;
pub use folder::{read, write};
pub use map::write_map;
pub use truth::read_truth;
