//! Errors of bags.

use std::path::{Path, PathBuf};

use sextant_recording::mcap_file::{Damage, McapFileError};

/// Why a bag cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BagError {
    /// The file or folder cannot be opened or read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file is of another format.
    #[error("`{}` is not an MCAP file, but {seen}", .path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// What it is.
        seen: String,
    },
    /// The bag is of ROS 1.
    #[error(
        "`{0}` is a bag of ROS 1; convert it first: `rosbags-convert --src {0} --dst NEW_FOLDER --dst-storage mcap` \
         (Python package rosbags) or `mcap convert {0} NEW.mcap`", .path.display()
    )]
    Ros1 {
        /// The file.
        path: PathBuf,
    },
    /// The bag is in SQLite, and this build does not read that.
    #[error(
        "`{0}` is a ROS 2 bag in SQLite, which this build does not read: build it with `--features sqlite-bags`, or convert the \
         bag to MCAP: `ros2 bag convert -i {0} -o mcap.yaml`, where \
         mcap.yaml is `output_bags: [{{uri: NEW_FOLDER, storage_id: mcap, all: true}}]`, or \
         `rosbags-convert --src {0} --dst NEW_FOLDER --dst-storage mcap`", .path.display()
    )]
    Sqlite {
        /// The file or folder.
        path: PathBuf,
    },
    /// The bag is compressed as a whole, or message by message.
    #[error(
        "`{0}` is a ROS 2 bag with compressed {what}; only chunks can be compressed: \
         `ros2 bag convert -i {0} -o plain.yaml`, where plain.yaml is \
         `output_bags: [{{uri: NEW_FOLDER, storage_id: mcap, all: true}}]`", .path.display()
    )]
    Compressed {
        /// The file or folder.
        path: PathBuf,
        /// What is compressed.
        what: &'static str,
    },
    /// The file is damaged.
    #[error(
        "`{0}` is damaged at byte {1}, after {2} messages: {3}; `mcap recover {0} -o NEW.mcap` copies what is readable",
        .path.display(), .damage.at_byte, .damage.messages, .damage.why
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The damage.
        damage: Damage,
    },
    /// The bag lacks something, or flags do not fit it.
    #[error("`{}`: {problem}", .path.display())]
    Content {
        /// The file or folder.
        path: PathBuf,
        /// The error.
        problem: String,
    },
    /// A topic cannot be used.
    #[error("`{}`, topic `{topic}`: {problem}", .path.display())]
    Topic {
        /// The file or folder.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The error.
        problem: String,
    },
}

impl BagError {
    pub(crate) fn read(path: &Path, why: &std::io::Error) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }
}

impl From<McapFileError> for BagError {
    fn from(error: McapFileError) -> Self {
        match error {
            McapFileError::Read { path, why } => Self::Read { path, why },
            McapFileError::Empty { path } => Self::Read { path, why: "it is empty".to_owned() },
            McapFileError::NotMcap { path, seen } => Self::NotMcap { path, seen },
        }
    }
}
