//! What a row of a sweep holds of a run.

use serde_json::Value;

use crate::measure::NODE_ERRORS;
use crate::summary::Summary;

/// What the texts of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Whole numbers.
    Integer,
    /// Numbers.
    Real,
    /// Texts.
    Text,
}

/// A column of the table of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What is in it.
    pub kind: Kind,
}

impl Column {
    /// A column `name` of `kind`.
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// What is taken of the survey: JSON pointers into the summary.
const OF_SURVEY: [(&str, Kind); 19] = [
    ("/simulation/nodes", Kind::Integer),
    ("/simulation/obstacles", Kind::Integer),
    ("/gathering/stops", Kind::Integer),
    ("/gathering/path_length_m", Kind::Real),
    ("/gathering/duration_s", Kind::Real),
    ("/gathering/packets_offered", Kind::Integer),
    ("/gathering/packets_sent", Kind::Integer),
    ("/gathering/packets_received", Kind::Integer),
    ("/gathering/lost_collision", Kind::Integer),
    ("/gathering/lost_channel_access", Kind::Integer),
    ("/gathering/lost_signal", Kind::Integer),
    ("/gathering/energy_j/tx", Kind::Real),
    ("/gathering/energy_j/rx", Kind::Real),
    ("/gathering/energy_j/idle", Kind::Real),
    ("/simulation/events", Kind::Integer),
    ("/discovery/neighbours/energy_j/tx", Kind::Real),
    ("/discovery/neighbours/energy_j/rx", Kind::Real),
    ("/discovery/anchors/energy_j/tx", Kind::Real),
    ("/discovery/anchors/energy_j/rx", Kind::Real),
];

/// What is taken of each map: JSON pointers into its summary.
const OF_MAP: [(&str, Kind); 25] = [
    ("/mapped", Kind::Integer),
    ("/unmapped", Kind::Integer),
    ("/infeasible", Kind::Integer),
    ("/ambiguous", Kind::Integer),
    ("/connectivity_error", Kind::Real),
    ("/connectivity_errors/1/connectivity_error", Kind::Real),
    ("/connectivity_errors/1/nodes_within_0_2", Kind::Real),
    ("/connectivity_errors/2/connectivity_error", Kind::Real),
    ("/connectivity_errors/2/nodes_within_0_2", Kind::Real),
    ("/connectivity_errors/0/connectivity_error_end_points", Kind::Real),
    ("/connectivity_errors/0/connectivity_error_per_node", Kind::Real),
    ("/connectivity_errors/0/symmetric_loss", Kind::Real),
    ("/false_neighbour_rate", Kind::Real),
    ("/position_error_m/mean", Kind::Real),
    ("/position_error_m/median", Kind::Real),
    ("/position_error_m/p90", Kind::Real),
    ("/position_error_m/p95", Kind::Real),
    ("/position_error_m/max", Kind::Real),
    ("/aligned_error_m/mean", Kind::Real),
    ("/posterior_bound_m", Kind::Real),
    ("/coverage_95", Kind::Real),
    ("/vertices_evaluated", Kind::Integer),
    ("/topology_preservation_error", Kind::Real),
    ("/message_energy_j", Kind::Real),
    ("/connectivity_errors/0/nodes_within_0_2", Kind::Real),
];

/// Name of the column with the share of nodes that lose at most `error` of their neighbours on `map`.
pub(crate) fn node_error_cdf(map: &str, error: f64) -> String {
    format!("{map}.node_error_cdf_{error}")
}

/// The columns of the measures, if the maps are called `maps`.
pub(super) fn columns(maps: &[String]) -> Vec<Column> {
    let of_survey = OF_SURVEY.iter().map(|&(pointer, kind)| {
        let name =
            pointer.trim_start_matches("/gathering/").trim_start_matches("/simulation/").trim_start_matches('/');
        Column::new(name.replace('/', "."), kind)
    });
    let of_map = |map: &String| {
        let map = map.clone();
        OF_MAP.iter().map(move |&(pointer, kind)| {
            let name = pointer.trim_start_matches("/connectivity_errors/0/").trim_start_matches('/');
            Column::new(format!("{map}.{}", name.replace('/', ".")), kind)
        })
    };
    let of_map = |map: &String| {
        let cdf = NODE_ERRORS.map(|error| Column::new(node_error_cdf(map, error), Kind::Real));
        of_map(map).chain(cdf).collect::<Vec<_>>()
    };
    of_survey.chain(maps.iter().flat_map(of_map)).collect()
}

/// The texts of these columns for the run that `summary` describes; empty where there is nothing to tell.
pub(super) fn texts(summary: &Summary, maps: &[String]) -> Vec<String> {
    let json = serde_json::to_value(summary).unwrap_or_default();
    let none = Vec::new();
    let mapped = json["maps"].as_array().unwrap_or(&none);
    let named = |name: &String| {
        mapped.iter().find(|map| map["name"].as_str().or(map["algorithm"].as_str()) == Some(name.as_str()))
    };
    let of_survey = OF_SURVEY.iter().map(|&(pointer, _)| text(json.pointer(pointer)));
    let of_maps = maps.iter().flat_map(|name| {
        let map = named(name);
        let of_map = OF_MAP.iter().map(move |&(pointer, _)| text(map.and_then(|map| map.pointer(pointer))));
        let cdf = (0..NODE_ERRORS.len()).map(move |i| {
            text(map.and_then(|map| map.pointer(&format!("/connectivity_errors/0/node_error_cdf/{i}/1"))))
        });
        of_map.chain(cdf)
    });
    of_survey.chain(of_maps).collect()
}

fn text(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::{EnergySummary, ErrorSummary, GatheringSummary, MapSummary};

    #[test]
    fn each_measure_stands_under_its_name() {
        let energy = EnergySummary { tx: 0.5, rx: 1.25, idle: 0.1 };
        let map = MapSummary {
            name: Some("fine".into()),
            algorithm: "ml-tm".into(),
            mapped: 7,
            position_error_m: Some(ErrorSummary { mean: 0.3, ..ErrorSummary::default() }),
            ..MapSummary::default()
        };
        let gathering = GatheringSummary { stops: 12, energy_j: Some(energy), ..GatheringSummary::default() };
        let summary = Summary { gathering: Some(gathering), maps: vec![map], ..Summary::default() };
        let maps = ["ml-tm".to_owned(), "fine".to_owned()];
        let (columns, texts) = (columns(&maps), texts(&summary, &maps));
        assert_eq!(columns.len(), texts.len());
        let of =
            |name: &str| &texts[columns.iter().position(|column| column.name == name).expect("the column exists")];
        assert_eq!(of("stops"), "12");
        assert_eq!(of("energy_j.rx"), "1.25");
        assert_eq!(of("fine.mapped"), "7");
        assert_eq!(of("fine.position_error_m.mean"), "0.3");
        assert_eq!(of("ml-tm.mapped"), "", "there is no map of this name");
        assert_eq!(of("fine.connectivity_error"), "", "it was not measured");
    }
}
