//! The sectors of a log as evidence on directions, for estimates that do not share one grid.

use std::f64::consts::{PI, TAU};

use sextant_channel::{LogError, Position, ReceptionLog};

use crate::grid_ml::solver::{Edges, Wedges};
use crate::log_facts::heights::Heights;
use crate::log_facts::sectors::SectorSettings;

/// What a sector says about places outside it: probability of a reception there, over that inside. It is not zero, so
/// that a wrong sector does not rule out the true place.
pub(crate) const CONTRADICTED: f64 = 0.02;
/// How far beyond the edge of a sector a place may lie, over the distance at which nodes are heard.
const TOLERANCE: f64 = 0.025;

/// The sectors of a log.
#[derive(Debug)]
pub(crate) struct Directions {
    wedges: Wedges,
    /// Those whose directions are covered: where silence means something.
    covering: Wedges,
}

/// Whether silence means something at a place just outside all sectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoverageEdge {
    /// Within the tolerance of a sector it does, as a reception is possible there.
    Tolerant,
    /// It does not: many packets that were missed near an edge weigh more than one reception.
    Exact,
}

impl Directions {
    /// The sectors of `log`; `None` if they are not evidence. Nodes are heard over about `reach_m` and sought at `heights`.
    ///
    /// # Errors
    /// If a reception names a sector that is not among those of the settings.
    pub(crate) fn of(
        log: &ReceptionLog,
        settings: &SectorSettings,
        reach_m: f64,
        heights: Heights,
        edge: CoverageEdge,
    ) -> Result<Option<Self>, LogError> {
        let is_flat = match heights {
            Heights::Level(z_m) => log.stops().iter().all(|stop| (stop.position.z_m - z_m).abs() <= 1e-9),
            Heights::Between(..) => false,
        };
        let table = settings.table(log)?;
        let wedges =
            |table, tolerance_m| Wedges::of_table(table, Edges::at_distance(tolerance_m), settings.silence, is_flat);
        let tolerance_m = TOLERANCE * reach_m;
        let covering_m = match edge {
            CoverageEdge::Tolerant => tolerance_m,
            CoverageEdge::Exact => 0.0,
        };
        Ok(table.map(|table| Self { wedges: wedges(table, tolerance_m), covering: wedges(table, covering_m) }))
    }

    /// The factor of the likelihood of a place at `apart` from the stop of a reception in `sector`.
    pub(crate) fn factor(&self, sector: Option<u8>, apart: Position) -> f64 {
        match sector {
            Some(sector) if !self.wedges.admits(sector, apart.into()) => CONTRADICTED,
            _ => 1.0,
        }
    }

    /// Whether a sector points to a place at `apart` from a stop, so that silence there means something.
    pub(crate) fn covers(&self, apart: Position) -> bool {
        self.covering.coverage().is_none_or(|coverage| coverage.covers(apart.into()))
    }
}

/// Whether a stop that heard nothing says something about a place at `apart` from it.
pub(crate) fn covers(directions: Option<&Directions>, apart: Position) -> bool {
    directions.is_none_or(|directions| directions.covers(apart))
}

/// The same angle in (−π, π] (rad).
pub(crate) fn wrapped(angle_rad: f64) -> f64 {
    PI - (PI - angle_rad).rem_euclid(TAU)
}
