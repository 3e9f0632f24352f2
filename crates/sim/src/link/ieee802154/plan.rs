//! The coordinator of a network with beacons, checked against world, robots, sinks and traffic.

use sextant_kernel::{NodeId, SettingError};
use sextant_mac::Phy;
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::superframe::BeaconEnabled;

use super::addressing::{first_sequence, pan};
use super::mac::short_address;
use crate::link::coordinator::{Coordination, Demand};

/// The key of the table of the settings.
const KEY: &str = "mac.beacon_enabled";

/// The coordinator of a network, at its post, for its nodes and what they send.
///
/// # Errors
/// If a guaranteed slot is of a node that is not there or has no short address, a frame does not fit in its slot or in
/// the contention access period, or the station listens for less than the beacon interval.
pub(super) fn coordinator(
    settings: &BeaconEnabled,
    phy: Phy,
    coordination: &Coordination<'_>,
) -> Result<Coordinator, SettingError> {
    let &Coordination { network, seed, post, nodes, demands } = coordination;
    let devices = (settings.gts().iter().enumerate())
        .map(|(i, gts)| {
            let refusal =
                |allowed| SettingError::new(format!("{KEY}.gts[{i}].node"), format!("`{}`", gts.node), allowed);
            let node = nodes.iter().position(|node| node.name == gts.node);
            let node = node.ok_or_else(|| refusal("the name of a node"))?;
            short_address(NodeId::from_index(node).into())
                .ok_or_else(|| refusal("one of the nodes that have a short address"))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let source = Endpoint { pan: pan(network), address: Address::of(post.station) };
    let sequence = first_sequence(seed, post.station, network);
    let coordinator =
        Coordinator::new(settings, phy, source, &devices, sequence).map_err(|error| error.within(KEY))?;
    for demand in demands {
        let &Demand { mpdu_octets: octets, acknowledged, .. } = demand;
        for (i, gts) in settings.gts().iter().enumerate() {
            if !coordinator.slot_carries(i, octets, acknowledged) {
                let allowed = format!("enough slots for a frame of {octets} octets and what must follow it");
                return Err(SettingError::new(format!("{KEY}.gts[{i}].slots"), gts.slots, allowed));
            }
        }
        if !coordinator.contention_carries(octets, acknowledged) {
            let allowed =
                "a size that fits into the contention access period with assessments, acknowledgement and spacing";
            return Err(SettingError::new(format!("{}.mpdu_octets", demand.key), octets, allowed));
        }
    }
    let interval = coordinator.timing().beacon_interval();
    if let Some((robot, listen)) = post.listen
        && listen < interval
    {
        let allowed = format!(
            "at least the beacon interval, {} s: a stop without a beacon hears nobody",
            interval.as_secs_f64()
        );
        return Err(SettingError::new(format!("robots[{robot}].listen_s"), listen.as_secs_f64(), allowed));
    }
    Ok(coordinator)
}
