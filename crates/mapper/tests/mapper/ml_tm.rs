//! ML-TM against the formula of the thesis, against examples, and its settings.

mod cases;
mod examples;
mod literal_product;
mod oracle;
mod settings;

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::NodeId;
use sextant_mapper::{MlTm, MlTmConfig};

fn stop(place: Position) -> Stop {
    Stop::at(place)
}

fn entry(node: u32, stop: u32, received: u32, sent: u32) -> Reception {
    Reception::heard(NodeId(node), stop, received, sent)
}

fn log(nodes: u32, stops: &[Position], receptions: Vec<Reception>) -> ReceptionLog {
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    let stops = stops.iter().map(|&place| stop(place)).collect();
    ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log without contradictions")
}

fn ml_tm(config: MlTmConfig) -> MlTm {
    MlTm::try_from(config).expect("good settings")
}
