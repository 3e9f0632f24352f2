//! An estimator of one's own, with what it learns: one type for each, and nothing else to change.
//!
//! Each node is at the median of the stops that heard it, and what is learned is how far nodes are heard.

use std::io::Write;

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime, Unwatched, Watch};
use sextant_mapper::{
    CoordinateFrame, Estimator, EstimatorFindings, Finding, Knowledge, KnowledgeKind, Line, MapError, Mapper,
    Section, TopologyMap,
};

/// Places nodes at the median of the stops that heard them.
#[derive(Debug, PartialEq)]
struct MedianStop;

/// How far nodes are heard.
#[derive(Debug, PartialEq)]
struct Reach {
    farthest_m: f64,
}

impl Estimator for MedianStop {
    fn name(&self) -> &'static str {
        "median-stop"
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotReceptions]
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        watch.check()?;
        let log = knowledge.log;
        let heard = |node| {
            let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
            receptions.map(|reception| log.stops()[reception.stop as usize].position).collect::<Vec<Position>>()
        };
        let nodes: Vec<Vec<Position>> = (0..log.node_count()).map(|node| heard(NodeId::from_index(node))).collect();
        let places: Vec<Option<Position>> = nodes.iter().map(|stops| median(stops)).collect();
        let distances = nodes
            .iter()
            .zip(&places)
            .flat_map(|(stops, place)| stops.iter().filter_map(move |stop| Some(stop.distance_m((*place)?))));
        let reach = Reach { farthest_m: distances.fold(0.0, f64::max) };
        let map = TopologyMap::of_places(self.name(), places, CoordinateFrame::World);
        Ok((map, Some(EstimatorFindings::new(reach))))
    }
}

impl Finding for Reach {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        std::iter::once(("farthest_m".to_owned(), self.farthest_m.into())).collect()
    }

    fn lines(&self, name: &str, _: &TopologyMap) -> Vec<Line> {
        let text = format!("{name}: nodes are heard over up to {:.2} m", self.farthest_m);
        vec![Line { section: Section::Laws, text }]
    }
}

/// The median along each axis; `None` of no places.
fn median(places: &[Position]) -> Option<Position> {
    let along = |axis: usize| {
        let mut sorted: Vec<f64> = places.iter().map(|&place| <[f64; 3]>::from(place)[axis]).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    };
    Some([along(0)?, along(1)?, along(2)?].into())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stop = |x_m| Stop {
        robot: RobotId(0),
        time: SimTime::ZERO,
        position: Position::new(x_m, 0.0, 0.0),
        heading_rad: None,
    };
    let stops = (0..9).map(|i| stop(f64::from(i))).collect();
    let heard =
        |stop| Reception { node: NodeId(0), stop, received: 1, sent: 1, sector: None, rssi_dbm: None, snr_db: None };
    let log = ReceptionLog::new(vec!["lamp".into()], stops, (3..6).map(heard).collect(), Vec::new())?;

    let mapper = Mapper::new(MedianStop);
    let (map, learned) = mapper.map_and_learn(&log, &Unwatched)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "lamp: {}", map.positions()[0].ok_or("it was heard")?)?;
    for line in learned.ok_or("it learns the reach")?.lines(mapper.name(), &map) {
        writeln!(out, "{}", line.text)?;
    }
    Ok(())
}
