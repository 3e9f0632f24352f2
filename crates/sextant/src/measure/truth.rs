//! The errors of a map: the only place where estimates are compared with the truth.

use sextant_channel::{Anchor, Position};
use sextant_kernel::{Interrupted, NodeId, Watch};
use sextant_mapper::{
    ConnectivityError, CoordinateFrame, Estimate, EstimatorFindings, KnowledgeKind, NeighbourhoodRule, PositionError,
    Reflection, Region, SectorDisplacement, SectorDisplacementRule, Similarity, TopologyMap, connectivity_error,
    sector_displacement, topology_preservation_error,
};
use sextant_scenario::MetricsConfig;

use super::outline::outline;
use super::subject::Subject;
use crate::summary::{
    AlignmentSummary, ConnectivitySummary, ErrorSummary, MapSummary, MeasuredIn, NODE_ERRORS, POSITION_ERRORS_M,
};

/// The true positions of nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth<'a> {
    /// The true position of each node (m), where it is known.
    pub(crate) places: &'a [Option<Position>],
    /// The nodes that know their position. In a map that uses anchors, these positions are not estimates.
    pub(crate) anchors: &'a [Anchor],
    /// In how many dimensions they are known.
    pub(crate) dimensions: Dimensions,
}

/// In how many dimensions true positions are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dimensions {
    /// With their heights.
    #[default]
    Space,
    /// Without heights: a map is measured in the plane of x and y, whatever its heights are.
    Plane,
}

/// A map in world coordinates. A map that is known only up to a similarity is aligned to the true positions, each of its
/// parts by itself; without the truth it stays as it is.
#[must_use]
pub(crate) fn in_world(map: TopologyMap, truth: Option<&[Option<Position>]>) -> (TopologyMap, AlignmentSummary) {
    match (&map.frame, truth) {
        (CoordinateFrame::World, _) => (map, AlignmentSummary::None),
        (CoordinateFrame::AlignedToAnchors, _) => (map, AlignmentSummary::Anchors),
        (CoordinateFrame::Relative(_), None) => (map, AlignmentSummary::Relative),
        (CoordinateFrame::Relative(_), Some(truth)) => {
            let known = truth.iter().enumerate().filter_map(|(i, &place)| Some((NodeId::from_index(i), place?)));
            let known: Vec<_> = known.collect();
            (map.aligned_to(&known, LEAST_TO_ALIGN), AlignmentSummary::Truth)
        }
    }
}

/// A part of a map is aligned to the truth only if it has at least this many nodes: fewer nodes always fit.
const LEAST_TO_ALIGN: usize = 4;

/// The properties of a map of nodes with these `names` and, if true positions are known, its errors over the nodes whose
/// true position is known: the others count nowhere, not even as neighbours.
/// Connectivity is measured at each radius of `metrics`. A measure that cannot be computed, for example because all
/// nodes are in one place, is absent.
///
/// Position errors are those of the nodes whose position the map had to estimate; connectivity is that of all nodes. If the
/// heights of the nodes are not known, everything is measured in the plane: regions are those of x and y.
///
/// # Errors
/// If `watch` stops the work.
pub(crate) fn measure(
    subject: &Subject<'_>,
    map: &TopologyMap,
    learned: Option<&EstimatorFindings>,
    names: &[String],
    truth: Option<Truth<'_>>,
    metrics: &MetricsConfig,
    watch: &dyn Watch,
) -> Result<MapSummary, Interrupted> {
    let Some(Truth { places, anchors, dimensions }) = truth else {
        return Ok(outline(subject, map, learned, names));
    };
    if dimensions == Dimensions::Plane && !is_flat(map) {
        let places: Vec<Option<Position>> = places.iter().map(|place| Some(on_plane((*place)?))).collect();
        let truth = Truth { places: &places, anchors, dimensions: Dimensions::Space };
        let flat = measure(subject, &flattened(map), learned, names, Some(truth), metrics, watch)?;
        let outline = outline(subject, map, learned, names);
        return Ok(MapSummary {
            measured_in: Some(MeasuredIn::Plane),
            heights: outline.heights,
            coincident: outline.coincident,
            ..flat
        });
    }
    let known: Vec<usize> = (0..places.len()).filter(|&node| places[node].is_some()).collect();
    let truth: Vec<Position> = places.iter().copied().flatten().collect();
    let truth = truth.as_slice();
    let estimates: Vec<Option<&Estimate>> = known.iter().map(|&node| map.estimates[node].as_ref()).collect();
    let mapped: Vec<Option<Position>> =
        estimates.iter().map(|estimate| estimate.map(|estimate| estimate.position)).collect();
    let mut found = mapped.clone();
    let mut sought = truth.len();
    if subject.knowledge.contains(&KnowledgeKind::Anchors) {
        for at in anchors.iter().filter_map(|anchor| known.binary_search(&anchor.node.index()).ok()) {
            found[at] = None;
            sought -= 1;
        }
    }
    let at_radius = |&radius_m: &f64| connectivity(truth, &mapped, radius_m, watch);
    let connectivities: Result<Vec<_>, Interrupted> = metrics.neighbourhood_m.iter().map(at_radius).collect();
    let (connectivity_errors, absent): (Vec<_>, Vec<_>) = connectivities?.into_iter().unzip();
    let first = connectivity_errors.first().copied().unwrap_or_default();
    let has_flat_regions = has_flat_regions(truth, &estimates);
    let in_plane = || {
        let truth: Vec<Position> = truth.iter().copied().map(on_plane).collect();
        let found: Vec<Option<Position>> = found.iter().map(|place| place.map(on_plane)).collect();
        PositionError::between(&truth, &found).map(ErrorSummary::from)
    };
    Ok(MapSummary {
        measured: (known.len() < places.len()).then(|| mapped.iter().flatten().count()),
        regions_in: has_flat_regions.then_some(MeasuredIn::Plane),
        position_error_in_plane_m: has_flat_regions.then(in_plane).flatten(),
        position_error_m: PositionError::between(truth, &found).map(ErrorSummary::from),
        position_error_cdf: position_error_cdf(truth, &found, sought),
        coverage_95: coverage_95(truth, &estimates),
        aligned_error_m: aligned(truth, &found, Reflection::Allowed).map(ErrorSummary::from),
        aligned_error_without_reflection_m: aligned(truth, &found, Reflection::Forbidden).map(ErrorSummary::from),
        connectivity_error: first.connectivity_error,
        false_neighbour_rate: first.false_neighbour_rate,
        connectivity_absent: absent.into_iter().next().flatten(),
        topology_preservation_error: topology_preservation_error(truth, &mapped, watch)?,
        connectivity_errors,
        ..outline(subject, map, learned, names)
    })
}

/// Whether regions say nothing of heights, although a node is higher or lower than the map has it.
fn has_flat_regions(truth: &[Position], estimates: &[Option<&Estimate>]) -> bool {
    /// Heights that differ by less are equal (m).
    const EQUAL_M: f64 = 0.1;
    let is_beside = |(place, estimate): (&Position, &Option<&Estimate>)| {
        let covariance = |estimate: &Estimate| estimate.covariance.filter(|covariance| covariance[0][0] > 0.0);
        estimate.is_some_and(|estimate| {
            let is_flat = covariance(estimate).is_some_and(|covariance| covariance[2][2] <= 0.0);
            is_flat && (estimate.position.z_m - place.z_m).abs() > EQUAL_M
        })
    };
    truth.iter().zip(estimates).any(is_beside)
}

/// Whether all places of a map are at height 0, and known to be.
fn is_flat(map: &TopologyMap) -> bool {
    let is_flat = |estimate: &Estimate| {
        estimate.position.z_m.abs() <= 0.0 && estimate.covariance.is_none_or(|covariance| covariance[2][2] <= 0.0)
    };
    map.estimates.iter().flatten().all(is_flat)
}

/// The map as seen from above.
fn flattened(map: &TopologyMap) -> TopologyMap {
    let estimate = |estimate: &Estimate| {
        let covariance =
            estimate.covariance.map(|[[xx, xy, _], [yx, yy, _], _]| [[xx, xy, 0.0], [yx, yy, 0.0], [0.0; 3]]);
        Estimate { position: on_plane(estimate.position), covariance, ..estimate.clone() }
    };
    let estimates = map.estimates.iter().map(|each| each.as_ref().map(estimate)).collect();
    TopologyMap { estimates, ..map.clone() }
}

/// The place at height 0.
fn on_plane(place: Position) -> Position {
    Position::new(place.x_m, place.y_m, 0.0)
}

/// The antennas of nodes, all with as many sectors of equal width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeSectors<'a> {
    /// Number of sectors round the circle.
    pub(crate) sectors: u32,
    /// Azimuth of the middle of sector 0 of each node (rad).
    pub(crate) headings_rad: &'a [f64],
}

/// How far the sectors that a map suggests are from those that point to the neighbours; `None` if there are fewer than two
/// sectors.
#[must_use]
pub(crate) fn displacement(
    truth: &[Position],
    map: &TopologyMap,
    antennas: NodeSectors<'_>,
    metrics: &MetricsConfig,
) -> Option<SectorDisplacement> {
    let rule = SectorDisplacementRule {
        radius_m: metrics.sector_neighbourhood_m,
        of_node: metrics.sector_displacement_of_node,
        ..SectorDisplacementRule::new(antennas.sectors)
    };
    sector_displacement(truth, &map.positions(), antennas.headings_rad, &rule).ok()
}

/// Share of the nodes with a 95 % region whose true position is inside it.
fn coverage_95(truth: &[Position], estimates: &[Option<&Estimate>]) -> Option<f64> {
    let regions = estimates.iter().map(|&estimate| Region::of_95(estimate?));
    let inside: Vec<bool> =
        regions.zip(truth).filter_map(|(region, &truth)| region.map(|region| region.contains(truth))).collect();
    let count = inside.iter().filter(|&&inside| inside).count();
    (!inside.is_empty()).then(|| count as f64 / inside.len() as f64)
}

/// The distribution of the position errors of the nodes on the map, of all nodes that were `sought`.
fn position_error_cdf(
    truth: &[Position],
    found: &[Option<Position>],
    sought: usize,
) -> Option<[[f64; 2]; POSITION_ERRORS_M.len()]> {
    let error_m = |(truth, found): (&Position, &Option<Position>)| Some(found.as_ref()?.distance_m(*truth));
    let errors_m: Vec<f64> = truth.iter().zip(found).filter_map(error_m).collect();
    let within = |limit_m: f64| errors_m.iter().filter(|&&error_m| error_m <= limit_m).count();
    (sought > 0).then(|| POSITION_ERRORS_M.map(|limit_m| [limit_m, within(limit_m) as f64 / sought as f64]))
}

/// The errors after the similarity that brings the map closest to the truth.
fn aligned(truth: &[Position], mapped: &[Option<Position>], reflection: Reflection) -> Option<PositionError> {
    let pairs: Vec<_> =
        truth.iter().zip(mapped).filter_map(|(&truth, mapped)| mapped.map(|mapped| (mapped, truth))).collect();
    let similarity = Similarity::fit(&pairs, reflection).ok()?;
    let left: Vec<_> = pairs.iter().map(|&(mapped, truth)| similarity.apply(mapped).distance_m(truth)).collect();
    PositionError::of(&left)
}

/// How neighbours fare at one radius, and why that is not known.
fn connectivity(
    truth: &[Position],
    mapped: &[Option<Position>],
    radius_m: f64,
    watch: &dyn Watch,
) -> Result<(ConnectivitySummary, Option<String>), Interrupted> {
    let error = |rule| connectivity_error(truth, mapped, radius_m, rule, watch).ok();
    let affine = connectivity_error(truth, mapped, radius_m, NeighbourhoodRule::Affine, watch);
    let absent = affine.as_ref().err().map(ToString::to_string);
    let affine = affine.ok();
    let summary = ConnectivitySummary {
        neighbourhood_m: radius_m,
        connectivity_error: affine.as_ref().map(ConnectivityError::connectivity_error),
        connectivity_error_end_points: error(NeighbourhoodRule::EndPoints).map(|e| e.connectivity_error()),
        connectivity_error_per_node: error(NeighbourhoodRule::PerNode).map(|e| e.connectivity_error()),
        false_neighbour_rate: affine.as_ref().map(ConnectivityError::false_neighbour_rate),
        nodes_within_0_2: affine.as_ref().map(|error| error.share_of_nodes_within(0.2)),
        symmetric_loss: affine.as_ref().map(ConnectivityError::symmetric_loss),
        node_error_cdf: affine.map(|error| NODE_ERRORS.map(|limit| [limit, error.share_of_nodes_within(limit)])),
    };
    // An interrupted measure looks like one that does not apply, so the interrupt is checked here.
    watch.check().map(|()| (summary, absent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_without_a_position_count_as_infinitely_far() {
        let truth = [Position::new(0.0, 0.0, 0.0); 4];
        let found = [0.1, 0.6, 30.0].map(|x_m| Some(Position::new(x_m, 0.0, 0.0)));
        let found = [found[0], found[1], found[2], None];
        let cdf = position_error_cdf(&truth, &found, 4).unwrap();
        let share = |limit_m: f64| cdf.iter().find(|at| (at[0] - limit_m).abs() < 1e-12).map(|at| at[1]);
        assert_eq!([0.05, 0.1, 0.5, 0.7, 20.0].map(share), [0.0, 0.25, 0.25, 0.5, 0.5].map(Some));
        assert_eq!(position_error_cdf(&truth, &found, 0), None);
    }
}
