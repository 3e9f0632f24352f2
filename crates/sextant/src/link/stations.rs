//! The ends of a link by their names.

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_sim::{RobotBody, Setup, Sink, StationKind};

use super::LinkError;
use super::report::LinkEnd;
use crate::Scenario;

/// The stations of a scenario, and those that are added at places.
pub(super) struct Stations {
    setup: Setup,
    agents: Vec<RobotBody>,
}

/// One end of a link.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub(super) station: StationId,
    pub(super) name: String,
    pub(super) kind: &'static str,
    pub(super) place: Position,
}

impl From<End> for LinkEnd {
    fn from(end: End) -> Self {
        LinkEnd { name: end.name, kind: end.kind, position_m: end.place.into() }
    }
}

impl Stations {
    pub(super) fn of(scenario: &Scenario) -> Self {
        let setup = scenario.setup();
        let is_agent = |body: &&RobotBody| !setup.robots.iter().any(|robot| robot.body.name == body.name);
        let agents = scenario.bodies().iter().filter(is_agent).cloned().collect();
        Self { setup, agents }
    }

    /// The setup with the stations that were added.
    pub(super) fn setup(&self) -> &Setup {
        &self.setup
    }

    /// All stations that take part: nodes, robots at their start, sinks.
    pub(super) fn ends(&self) -> Vec<End> {
        let Setup { world, robots, sinks, .. } = &self.setup;
        let nodes = world.nodes.iter().enumerate().map(|(i, node)| (&node.name, StationKind::Node(i), node.position));
        let robots =
            robots.iter().enumerate().map(|(i, robot)| (&robot.body.name, StationKind::Robot(i), robot.body.start));
        let sinks = sinks.iter().enumerate().map(|(i, sink)| (&sink.name, StationKind::Sink(i), sink.position));
        let all = nodes.chain(robots).chain(sinks).enumerate();
        all.map(|(station, (name, kind, place))| self.end(station, name, kind, place)).collect()
    }

    /// The station of this name; or a sink at a place, or for a robot that takes no part in the survey.
    pub(super) fn find(&mut self, name: &str) -> Result<End, LinkError> {
        let name = name.trim();
        let Setup { world, robots, sinks, .. } = &self.setup;
        if let Some(node) = world.nodes.iter().position(|node| node.name == name) {
            return Ok(self.end(node, name, StationKind::Node(node), world.nodes[node].position));
        }
        if let Some(robot) = robots.iter().position(|robot| robot.body.name == name) {
            return Ok(self.end(
                world.nodes.len() + robot,
                name,
                StationKind::Robot(robot),
                robots[robot].body.start,
            ));
        }
        if let Some(sink) = sinks.iter().position(|sink| sink.name == name) {
            let station = world.nodes.len() + robots.len() + sink;
            return Ok(self.end(station, name, StationKind::Sink(sink), sinks[sink].position));
        }
        if let Some(agent) = self.agents.iter().find(|agent| agent.name == name) {
            let place = agent.start;
            return Ok(End { kind: "robot, at its start", ..self.add(name, place) });
        }
        match place(name) {
            Some(Ok(place)) => Ok(self.add(name, place)),
            Some(Err(error)) => Err(error),
            None => Err(LinkError::UnknownStation { name: name.to_owned(), near: self.near(name) }),
        }
    }

    fn end(&self, station: usize, name: &str, kind: StationKind, place: Position) -> End {
        let kind = match kind {
            StationKind::Node(node) if self.setup.world.motions.iter().any(|motion| motion.node.index() == node) => {
                "node, at its start"
            }
            StationKind::Node(_) => "node",
            StationKind::Robot(_) => "robot, at its start",
            StationKind::Sink(_) => "sink",
        };
        End { station: StationId::from_index(station), name: name.to_owned(), kind, place }
    }

    /// A sink at a place: the last of all stations, so that no other one changes.
    fn add(&mut self, name: &str, place: Position) -> End {
        let station = self.setup.world.nodes.len() + self.setup.robots.len() + self.setup.sinks.len();
        self.setup.sinks.push(Sink { name: name.to_owned(), position: place, networks: None });
        let kind = "place, with a radio like that of a sink";
        End { station: StationId::from_index(station), name: name.to_owned(), kind, place }
    }

    /// The most similar names.
    fn near(&self, name: &str) -> Vec<String> {
        let Setup { world, robots, sinks, .. } = &self.setup;
        let nodes = world.nodes.iter().map(|node| node.name.as_str());
        let robots = robots.iter().map(|robot| robot.body.name.as_str());
        let agents = self.agents.iter().map(|agent| agent.name.as_str());
        let sinks = sinks.iter().map(|sink| sink.name.as_str());
        let names = robots.chain(agents).chain(sinks).chain(nodes);
        let mut near: Vec<_> = names.map(|known| (strsim::jaro_winkler(name, known), known)).collect();
        near.retain(|(likeness, _)| *likeness > 0.8);
        near.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        near.into_iter().take(3).map(|(_, known)| known.to_owned()).collect()
    }
}

/// A place as written, `x,y` or `x,y,z`; `None` if it is something else than numbers.
fn place(text: &str) -> Option<Result<Position, LinkError>> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let place = match *numbers? {
        [_] => return None,
        [x, y] => Some(Position::new(x, y, 0.0)),
        [x, y, z] => Some(Position::new(x, y, z)),
        _ => None,
    };
    Some(place.filter(|place| place.is_finite()).ok_or_else(|| LinkError::Place(text.to_owned())))
}
