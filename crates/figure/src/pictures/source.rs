//! The data of figures.

use plotters::style::RGBColor;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use sextant_recording::{ClaimedObstacle, Places, RecordedWorld, Solid};

use crate::paint::palette::{self, OBSTACLE};
use crate::plot::sheet::{Entry, Symbol};
use crate::plot::silhouette::RIM;
use crate::plot::view::{Extent, View, Views};

/// The data of figures, from a recording.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Name of the run in titles.
    pub title: &'a str,
    /// The reception log.
    pub log: &'a ReceptionLog,
    /// Everything with a position.
    pub drawn: &'a RecordedWorld,
    /// Shares of the nodes by sector displacement, of each map that has them, by name.
    pub sector_displacements: &'a [(String, Vec<f64>)],
    /// The obstacles that each map claims, by its name.
    pub claimed_obstacles: &'a [(String, Vec<ClaimedObstacle>)],
}

/// At a smaller distance (m) from the position of an anchor, the map was given the position.
const TOLD_M: f64 = 1e-6;

impl Source<'_> {
    /// The positions of paths, stops and contacts of the robots.
    pub(crate) fn survey(&self) -> impl Iterator<Item = Position> {
        let all = self.drawn.paths.iter().chain(&self.drawn.believed_paths);
        let paths = all.flat_map(|(_, path)| path).copied();
        let stops = self.log.stops().iter().map(|stop| stop.position);
        paths.chain(stops).chain(self.log.contacts().iter().map(|contact| contact.position))
    }

    /// Views of the world that contain the nodes, the obstacles and `more`: from above, and also from the side unless the
    /// nodes and `more` all have the same height.
    pub(crate) fn views(&self, more: impl Iterator<Item = Position>) -> Views {
        let places: Vec<_> = self.drawn.nodes.values().copied().chain(more).collect();
        let flat = Extent::around(places.iter().copied()).is_none_or(|extent| extent.is_flat());
        let extent = self.extent(places.into_iter());
        Views::new(&extent, if flat { &[View::Top] } else { &[View::Top, View::Side] })
    }

    /// The view from above that contains the same.
    pub(crate) fn views_from_above(&self, more: impl Iterator<Item = Position>) -> Views {
        Views::new(&self.extent(self.drawn.nodes.values().copied().chain(more)), &[View::Top])
    }

    /// The part of the world with these places and the obstacles.
    fn extent(&self, places: impl Iterator<Item = Position>) -> Extent {
        let corners = self.drawn.obstacles.iter().flat_map(|solid| &solid.vertices).copied();
        Extent::around(places.chain(corners)).unwrap_or_default()
    }

    /// The legend of obstacles, if there are any.
    pub(crate) fn obstacle_entry(&self) -> Option<Entry> {
        let text = "obstacle".to_owned();
        let symbol = Symbol::Body { fill: OBSTACLE, rim: RIM };
        (!self.drawn.obstacles.is_empty()).then_some(Entry { symbol, text })
    }

    /// The obstacles that the map `name` claims.
    pub(crate) fn claims_of(&self, name: &str) -> &[ClaimedObstacle] {
        self.claimed_obstacles.iter().find(|(map, _)| map == name).map_or(&[], |(_, claims)| claims)
    }

    /// The number of the robot `name` in all figures: robots of the survey come first. `None` if it is no robot.
    pub(crate) fn robot(&self, name: &str) -> Option<usize> {
        let of_applications = self.drawn.applications.iter().flat_map(|application| &application.paths);
        let mut robots: Vec<&str> = Vec::new();
        for (robot, _) in self.drawn.paths.iter().chain(of_applications) {
            if !robots.contains(&robot.as_str()) {
                robots.push(robot);
            }
        }
        robots.iter().position(|robot| *robot == name)
    }

    /// The colour of the robot `name`, the same in all figures.
    pub(crate) fn color_of_robot(&self, name: &str) -> RGBColor {
        palette::of_robot(self.robot(name).unwrap_or(0))
    }

    /// The obstacles.
    pub(crate) fn solids(&self) -> &[Solid] {
        &self.drawn.obstacles
    }

    /// The distances between mapped and true positions (m), in the order of the nodes. An anchor where it believes to be
    /// is not an estimate and does not count.
    pub(crate) fn errors(&self, places: &Places) -> Vec<(NodeId, f64)> {
        let error = |(&node, &place): (&NodeId, &Position)| {
            let error_m = self.drawn.nodes.get(&node)?.distance_m(place);
            let was_told = self.drawn.anchors.get(&node).is_some_and(|told| told.distance_m(place) < TOLD_M);
            (!was_told).then_some((node, error_m))
        };
        places.iter().filter_map(error).collect()
    }

    /// Name of the map that the nodes computed themselves, if they did: it comes before all others.
    pub(crate) fn map_of_nodes(&self) -> Option<&str> {
        let is_there = !self.drawn.mapped_nodes.is_empty();
        self.drawn.maps.first().filter(|_| is_there).map(|(name, _)| name.as_str())
    }

    /// The node of this name.
    pub(crate) fn node(&self, name: &str) -> Option<NodeId> {
        self.log.names().iter().position(|other| other == name).map(NodeId::from_index)
    }
}
