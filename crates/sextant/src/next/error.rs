//! Why it cannot be said where to listen next.

use sextant_apps::next_stops::GroundError;
use sextant_kernel::Interrupted;
use sextant_kernel::text::choices;
use sextant_mapper::OutlookError;

use crate::mapping::MapLogError;

/// Why it cannot be said where to listen next.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NextError {
    /// The log cannot be mapped.
    #[error(transparent)]
    Map(MapLogError),
    /// The log or its map does not tell what further stops would bring.
    #[error(transparent)]
    Outlook(OutlookError),
    /// The map is made of ranges.
    #[error(
        "where to stop next follows from the distances over which packets arrive, and {}",
        if *has_packets { "a map that is made of ranges does not tell these" } else { "the log has ranges and no packets" }
    )]
    Ranges {
        /// Whether the log has packets beside them.
        has_packets: bool,
    },
    /// There is no way.
    #[error(transparent)]
    Ground(GroundError),
    /// A setting is invalid.
    #[error("the {what} is {found}; allowed: {allowed}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The robot is not in the log.
    #[error("the robot `{found}` is not in the log; allowed: {}", choices(known))]
    Robot {
        /// Its name.
        found: String,
        /// The robots of the log.
        known: Vec<String>,
    },
    /// Too few stops.
    #[error("the log has {found} {}; at least 2 are needed to say where to go on", if *found == 1 { "stop" } else { "stops" })]
    FewStops {
        /// Stops of the log.
        found: usize,
    },
    /// Receivers that stand.
    #[error("nobody drives in this log: {} without a way", if *robots == 1 { "it has one receiver".to_owned() } else { format!("it has {robots} receivers") })]
    NobodyDrives {
        /// Receivers of the log.
        robots: usize,
    },
    /// Nothing can be heard in the area.
    #[error(
        "no node can be heard in the area: it is {away_m:.1} m from the nearest stop, and nodes are heard within {reach_m:.1} m"
    )]
    AreaOutOfReach {
        /// From the area to the nearest stop (m).
        away_m: f64,
        /// So far nodes are heard (m).
        reach_m: f64,
    },
    /// No map was asked for.
    #[error("there is no map to go on from")]
    NoMap,
    /// The work was ended.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl NextError {
    /// What helps, if something does.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Outlook(
                OutlookError::NoCovariance { .. } | OutlookError::NoLaw { .. } | OutlookError::Relative { .. },
            ) => Some("`auto`, `link-model` and `ml-tm` tell what is needed"),
            Self::Ranges { has_packets: true } => {
                Some("an algorithm that maps the packets of the log tells them: `link-model` or `ml-tm`")
            }
            Self::Ranges { has_packets: false } => Some(
                "put the packets of the same nodes beside the ranges, and choose an algorithm that maps packets: `link-model`",
            ),
            Self::NobodyDrives { .. } => Some(
                "fixed receivers cannot be told where to drive; if they heard a transmitter that drove, map the log reciprocally",
            ),
            Self::Ground(GroundError::Start { .. }) => {
                Some("the floor plan must be in the frame of the log: look at a figure of both")
            }
            Self::Ground(GroundError::Enclosed { .. }) => {
                Some("a smaller radius of the robot opens narrow doors, and another area may be reached")
            }
            _ => None,
        }
    }

    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Map(error) if error.is_system_error())
    }
}

impl From<MapLogError> for NextError {
    fn from(error: MapLogError) -> Self {
        match error {
            MapLogError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Map(error),
        }
    }
}

impl From<OutlookError> for NextError {
    fn from(error: OutlookError) -> Self {
        match error {
            OutlookError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Outlook(error),
        }
    }
}

impl From<GroundError> for NextError {
    fn from(error: GroundError) -> Self {
        match error {
            GroundError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Ground(error),
        }
    }
}
