//! The coordinator of a network with beacons, checked against world, robots, sinks and traffic.

use std::time::Duration;

use sextant_kernel::{NodeId, Seed, SettingError, StationId};
use sextant_mac::Phy;
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::superframe::BeaconEnabled;

use super::mac::short_address;
use super::network::{first_sequence, pan};
use crate::service::network_id::NetworkId;

/// The key of the table of the settings.
const KEY: &str = "mac.beacon_enabled";

/// The station that sends beacons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Post {
    pub(crate) station: StationId,
    /// Number of the robot that it is, and how long that listens at a stop; `None` if it always listens.
    pub(crate) listen: Option<(usize, Duration)>,
}

/// Frames that the nodes send.
#[derive(Clone, Debug)]
pub(crate) struct Demand {
    /// Key of the table that says so.
    pub(crate) key: String,
    pub(crate) mpdu_octets: u8,
    pub(crate) acknowledged: bool,
}

/// The coordinator of `network` at `post`, for nodes with these `names` that send frames as `demands` say.
///
/// # Errors
/// If a guaranteed slot is of a node that is not there or has no short address, a frame does not fit in its slot or in
/// the contention access period, or the station listens for less than the beacon interval.
pub(crate) fn coordinator<'a>(
    settings: &BeaconEnabled,
    phy: Phy,
    (network, seed): (NetworkId, Seed),
    post: Post,
    names: impl Iterator<Item = &'a str> + Clone,
    demands: &[Demand],
) -> Result<Coordinator, SettingError> {
    let devices = (settings.gts().iter().enumerate())
        .map(|(i, gts)| {
            let refusal =
                |allowed| SettingError::new(format!("{KEY}.gts[{i}].node"), format!("`{}`", gts.node), allowed);
            let node = names.clone().position(|name| name == gts.node);
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
