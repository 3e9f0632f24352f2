//! What a node found, as a message of a recording.

use sextant_apps::distributed::{Category, MappingRecord, MappingRole};
use sextant_kernel::NodeId;

use sextant_recording::messages::MappedNodeMessage;

/// What `node` found; its radio used `energy_j`.
pub(super) fn message(node: NodeId, record: &MappingRecord, energy_j: f64) -> MappedNodeMessage {
    let whole = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    let (role, anchor_since) = match record.role {
        MappingRole::InitialAnchor => ("initial_anchor", None),
        MappingRole::NewAnchor { iteration } => ("new_anchor", Some(iteration)),
        MappingRole::Node if record.gave_up => ("former_anchor", None),
        MappingRole::Node => ("node", None),
    };
    let category = match record.category {
        _ if record.role == MappingRole::InitialAnchor => "",
        Category::NewAnchor => "new_anchor",
        Category::Good => "good",
        Category::Bad => "bad",
    };
    let estimate = record.estimate.as_ref();
    let covariance = |row: usize, column: usize| Some(estimate?.covariance?[row][column]);
    let directions = record.directions.as_ref();
    MappedNodeMessage {
        node: node.0,
        role: role.to_owned(),
        anchor_since,
        category: category.to_owned(),
        x_m: record.place.map(|place| place.x_m),
        y_m: record.place.map(|place| place.y_m),
        z_m: record.place.map(|place| place.z_m),
        cov_xx_m2: covariance(0, 0),
        cov_xy_m2: covariance(0, 1),
        cov_xz_m2: covariance(0, 2),
        cov_yy_m2: covariance(1, 1),
        cov_yz_m2: covariance(1, 2),
        cov_zz_m2: covariance(2, 2),
        log_likelihood: estimate.and_then(|estimate| estimate.log_likelihood),
        ties: estimate.map_or(0, |estimate| estimate.ties),
        violations: whole(record.violations),
        neighbours: whole(record.scattering.neighbours),
        scattered: whole(record.scattering.scattered),
        anchors_heard: whole(record.anchors_heard),
        mobile_stops_heard: whole(record.mobile_stops_heard),
        last_change: record.last_change,
        place_messages: record.messages.place,
        report_messages: record.messages.report,
        beacon_messages: record.messages.beacon,
        coordinates_messages: record.messages.coordinates,
        octets: record.messages.octets,
        sent: record.sent,
        unsent: record.unsent,
        frames_received: record.frames_received,
        frames_unread: record.frames_unread,
        vertices: record.vertices,
        grid_octets: record.grid_octets as u64,
        table_octets: record.table_octets as u64,
        energy_j,
        azimuth_rad: directions.map(|directions| directions.azimuth_rad),
        azimuth_half_width_rad: directions.map(|directions| directions.half_width_rad),
        elevation_rad: directions.map(|directions| directions.elevation_rad),
        bearings: directions.map(|directions| whole(directions.bearings)),
    }
}
