//! DXF: the lines, polylines, arcs and circles of a drawing are walls, as they are and in blocks.

mod drawing;
mod lines;
mod pairs;
mod unit;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use sextant_channel::WallConfig;
use sextant_kernel::text::{choices, counted, listed};

use super::error::FloorPlanError;
use super::{FloorPlan, FloorPlanOptions, to_mm};
use drawing::{drawing, is_same_layer};
use lines::{FloorLine, lines};
pub use unit::LengthUnit;

/// Places may be so far from zero (m).
const FARTHEST_M: f64 = 1e9;
/// Walls that are farther from zero are told (m).
const FAR_M: f64 = 1e5;

/// Reads the drawing `path`. The unit is that of its header, or that of the options; layers are those of the options, or all that are
/// visible.
pub(super) fn read(path: &Path, options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    let octets = sextant_kernel::read_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    let content = |problem| FloorPlanError::Content { path: path.to_owned(), problem };
    let text = pairs::text(&octets).map_err(content)?;
    let drawing = pairs::pairs(&text).and_then(|pairs| drawing(&pairs)).map_err(content)?;
    let unit = match (options.unit, LengthUnit::of_code(drawing.unit)) {
        (Some(unit), _) | (None, Some(unit)) => unit,
        (None, None) if drawing.unit == 0 => return Err(FloorPlanError::NoUnit { path: path.to_owned() }),
        (None, None) => return Err(content(unit::unusual(drawing.unit))),
    };
    let mut plan = FloorPlan::default();
    let mut missing = BTreeMap::new();
    let lines = lines(&drawing, unit.metres(), &mut missing).map_err(content)?;
    let lines = chosen(lines, &drawing.hidden, options, &mut plan.notes)?;
    if !drawing.unread.is_empty() {
        let each: Vec<String> = drawing.unread.iter().map(|(what, count)| format!("{count} {what}")).collect();
        plan.notes.push(format!("left out, because they are not read as walls: {}", listed(&each)));
    }
    if !missing.is_empty() {
        let each: Vec<String> = missing.iter().map(|(name, count)| format!("{count} `{name}`")).collect();
        plan.notes.push(format!("left out, because the drawing does not have their blocks: {}", listed(&each)));
    }
    let from = if options.unit.is_some() { "as given" } else { "as the drawing says" };
    plan.notes.push(format!("lengths are in {}, {from}", unit.name()));
    let [x_m, y_m] = options.origin_m.unwrap_or_default();
    let mut farthest_m = 0.0_f64;
    for (number, FloorLine { layer, points, .. }) in lines.into_iter().enumerate() {
        let points_m: Vec<[f64; 2]> = points.iter().map(|[x, y]| [to_mm(x_m + x), to_mm(y_m + y)]).collect();
        farthest_m = points_m.iter().flatten().map(|length_m| length_m.abs()).fold(farthest_m, f64::max);
        let name = Some(layer).filter(|layer| layer != "0");
        let wall = WallConfig { name, ..options.wall(points_m) };
        match wall.obstacles(0) {
            _ if plan.add_pillar(&wall, options) => {}
            Ok(_) => plan.walls.push(wall),
            Err(why) => plan.notes.push(format!("wall {} is left out: {why}", number + 1)),
        }
    }
    if farthest_m > FARTHEST_M {
        return Err(content(format!("a place is {farthest_m:.3e} m from zero; allowed: at most {FARTHEST_M:e} m")));
    }
    if farthest_m > FAR_M {
        let kilometres = farthest_m / 1000.0;
        plan.notes.push(format!(
            "walls are {kilometres:.0} km away from zero: option `origin` moves them, and the log has to fit"
        ));
    }
    Ok(plan)
}

/// The lines of the layers that are wanted.
fn chosen(
    lines: Vec<FloorLine>,
    hidden: &[String],
    options: &FloorPlanOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<FloorLine>, FloorPlanError> {
    let known: BTreeSet<String> = lines.iter().map(|line| line.layer.clone()).collect();
    let known: Vec<String> = known.into_iter().collect();
    let unknown = options.layers.iter().find(|layer| !known.iter().any(|known| is_same_layer(known, layer)));
    if let Some(unknown) = unknown {
        return Err(FloorPlanError::Option {
            option: "layers",
            found: unknown.clone(),
            allowed: format!("layers with lines: {}", choices(&known)),
        });
    }
    let is_wanted = |layer: &str| match options.layers.as_slice() {
        [] => !hidden.iter().any(|hidden| is_same_layer(hidden, layer)),
        layers => layers.iter().any(|wanted| is_same_layer(wanted, layer)),
    };
    // What is inserted on a frozen layer is hidden, unless layers are chosen.
    let frozen = |line: &FloorLine| line.frozen.clone().filter(|_| options.layers.is_empty());
    let inserted: BTreeSet<String> = lines.iter().filter_map(frozen).collect();
    let lines: Vec<FloorLine> = lines.into_iter().filter(|line| frozen(line).is_none()).collect();
    let drawn: BTreeSet<String> = lines.iter().map(|line| line.layer.clone()).collect();
    let (wanted, mut others): (Vec<String>, Vec<String>) = drawn.into_iter().partition(|layer| is_wanted(layer));
    others.extend(inserted);
    others.sort();
    others.dedup();
    if options.layers.is_empty() && wanted.len() > 1 {
        notes.push(format!(
            "all lines of {} are walls: {}; option `layers` chooses",
            counted(wanted.len(), "layer"),
            listed(&wanted)
        ));
    }
    if !others.is_empty() {
        let why = if options.layers.is_empty() { "hidden" } else { "not chosen" };
        notes.push(format!("layers with lines that are {why}: {}", listed(&others)));
    }
    Ok(lines.into_iter().filter(|line| is_wanted(&line.layer)).collect())
}

#[cfg(test)]
mod tests;
