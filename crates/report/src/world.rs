//! What a report draws: the world, the survey, the maps, and who went where when.

use serde::Serialize;
use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_recording::{self as recording, Phase, Places, RecordedTarget};

use super::column::Column;
use super::frame::Frame;
use super::map::Map;
use super::plane::Plane;
use super::survey::{Contacts, Survey};
use super::tree::{Deaths, Tree};

/// Everything with a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct World {
    /// The zero of places and times.
    pub frame: Frame,
    /// The names of the nodes.
    pub names: Vec<String>,
    /// The true places of the nodes (m), NaN where not known; absent if none is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth_m: Option<Column>,
    /// The nodes that know their place, and where they believe to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchors: Option<Marks>,
    /// The sinks, by number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sinks: Option<Marks>,
    /// The obstacles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Solid>,
    /// The robots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<Body>,
    /// The surveys, one a network.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub surveys: Vec<Survey>,
    /// Where robots met obstacles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<Contacts>,
    /// The maps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<Map>,
    /// The targets.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<Body>,
    /// Likelihoods of nodes over a plane.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub likelihoods: Vec<Plane>,
    /// Fields at instants.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<Plane>,
    /// The tree over which packets went.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tree: Option<Tree>,
    /// When batteries were empty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deaths: Option<Deaths>,
    /// The simulations of the run, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub phases: Vec<PhaseSpan>,
}

/// Numbered things with places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Marks {
    /// The numbers.
    pub ids: Column,
    /// Coordinates (m).
    pub places_m: Column,
}

/// The surface of an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solid {
    /// Its name.
    pub name: String,
    /// Coordinates of the corners (m).
    pub corners_m: Column,
    /// Triangles as three corners each.
    pub triangles: Column,
}

/// A robot or a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Where it was, and when.
    pub way: Way,
}

/// Places on straight lines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Way {
    /// When (s); absent if that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times_s: Option<Column>,
    /// Coordinates (m).
    pub places_m: Column,
}

/// A simulation in a run with several.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseSpan {
    /// `survey`, or the name of an application.
    pub name: String,
    /// When it begins (s).
    pub start_s: f64,
    /// When it ends (s).
    pub end_s: f64,
}

impl Marks {
    /// These places, if there are any.
    pub(super) fn of(places: &Places, frame: &Frame) -> Option<Self> {
        (!places.is_empty()).then(|| Self {
            ids: Column::U32(places.keys().map(|id| id.0).collect()),
            places_m: frame.places(places.values().copied()),
        })
    }
}

impl Solid {
    /// The surface.
    pub(super) fn of(solid: &recording::Solid, frame: &Frame) -> Self {
        Self {
            name: solid.name.clone(),
            corners_m: frame.places(solid.vertices.iter().copied()),
            triangles: Column::U32(solid.triangles.iter().flatten().copied().collect()),
        }
    }
}

impl Way {
    /// Places with times.
    pub(super) fn timed(points: &[(SimTime, Position)], frame: &Frame) -> Self {
        Self {
            times_s: Some(frame.times(points.iter().map(|(time, _)| *time))),
            places_m: frame.places(points.iter().map(|(_, place)| *place)),
        }
    }

    /// Places of which only the order is known.
    pub(super) fn untimed(places: &[Position], frame: &Frame) -> Self {
        Self { times_s: None, places_m: frame.places(places.iter().copied()) }
    }
}

impl Body {
    /// A target.
    pub(super) fn of_target(target: &RecordedTarget, frame: &Frame) -> Self {
        Self { name: target.name.clone(), way: Way::timed(target.way.points(), frame) }
    }
}

impl PhaseSpan {
    /// The simulation.
    pub(super) fn of(phase: &Phase, frame: &Frame) -> Self {
        Self { name: phase.name.clone(), start_s: frame.seconds(phase.start), end_s: frame.seconds(phase.end) }
    }
}
