//! Values over a plane: likelihoods and fields.

use serde::Serialize;
use sextant_kernel::SimTime;
use sextant_recording::{GridPlane, RecordedField};

use super::column::Column;
use super::frame::Frame;

/// Values at the vertices of a horizontal grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plane {
    /// Name of the map (of a likelihood) or of the field.
    pub of: String,
    /// Name of the node, of a likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// The instant, of a field (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// The first vertex, with the lowest x and y (m).
    pub first_m: [f64; 3],
    /// Distance between neighbouring vertices (m).
    pub step_m: f64,
    /// Vertices along x.
    pub columns: u32,
    /// The values; x varies fastest.
    pub values: Column,
}

/// Of a field, at most so many values are kept over all instants.
const MOST_VALUES: usize = 400_000;

impl Plane {
    /// The values of `plane`.
    pub(super) fn new(of: &str, node: Option<&str>, time: Option<SimTime>, plane: &GridPlane, frame: &Frame) -> Self {
        Self {
            of: of.to_owned(),
            node: node.map(str::to_owned),
            time_s: time.map(|time| frame.seconds(time)),
            first_m: frame.place(plane.first),
            step_m: plane.step_m,
            columns: plane.columns,
            values: Column::reals(plane.values.iter().copied()),
        }
    }

    /// The instants of fields. Of many, some at equal distances are kept, the first and the last one among them.
    pub(super) fn of_fields(fields: &[RecordedField], frame: &Frame) -> Vec<Self> {
        let values: usize = fields.iter().map(|field| field.plane.values.len()).sum();
        let every = values.div_ceil(MOST_VALUES).max(1);
        let mut names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        names.dedup();
        names.sort_unstable();
        names.dedup();
        let mut kept = Vec::new();
        for name in names {
            let instants: Vec<_> = fields.iter().filter(|field| field.name == name).collect();
            let last = instants.len().saturating_sub(1);
            let chosen = instants.iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last);
            kept.extend(chosen.map(|(_, field)| Self::new(name, None, Some(field.time), &field.plane, frame)));
        }
        kept
    }
}
