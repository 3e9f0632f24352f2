//! Routing over several hops.

use sextant_apps::routing::{Routing, RoutingConfig, TreeConfig};
use sextant_kernel::{Files, SettingError};
use sextant_mac::tsch::{ScheduleConfig, TschConfig, UnicastConfig};
use sextant_sim::{MacConfig, NetworkId, Setup};

use super::errors::Errors;
use super::networks::Networks;
use crate::config::ScenarioConfig;

/// The table of the scenario.
const TABLE: &str = "routing";

/// How packets go over several hops, if they do.
pub(crate) fn check_routing(
    config: &ScenarioConfig,
    networks: &Networks<'_>,
    setup: &Setup,
    files: &Files,
    errors: &mut Errors,
) -> Option<Routing> {
    let written = config.routing.as_ref()?;
    let before = errors.found.len();
    check_others(config, errors);
    check_mac(networks, &written.tree, errors);
    check_traffic(written, setup, errors);
    // A tree needs sinks and links.
    if errors.found.len() > before {
        return None;
    }
    errors.take(TABLE, Routing::new(written, setup, files))
}

/// Refuses what packets over several hops cannot be together with, or cannot do without.
fn check_others(config: &ScenarioConfig, errors: &mut Errors) {
    for (is_there, with, remedy) in [
        (!config.networks.is_empty(), "`networks`", "use one network, with the tables of the scenario"),
        (!config.robots.is_empty(), "`robots`", "remove one of the two: packets go to sinks, which stand"),
        (config.distributed_mapping.is_some(), "`distributed_mapping`", "remove one of the two"),
        (!config.applications.is_empty(), "`applications`", "remove one of the two"),
        (!config.maps.is_empty(), "`maps`", "remove one of the two: no robot hears the packets"),
    ] {
        if is_there {
            errors.refuse(&SettingError::conflict(TABLE, with, remedy));
        }
    }
    let is_known = errors.found.iter().any(|error| error.key == "sinks");
    if config.sinks.is_empty() && !is_known {
        errors
            .refuse(&SettingError::missing("sinks", "at least one sink in `[[sinks]]`, to which packets are routed"));
    }
    if config.duration_s.is_none() {
        errors.refuse(&SettingError::missing("duration_s", "the time at which a simulation with `routing` ends"));
    }
}

/// Refuses a MAC by which stations do not hear each other at any time, or that has no acknowledgements.
fn check_mac(networks: &Networks<'_>, tree: &TreeConfig, errors: &mut Errors) {
    let tables = networks.network(NetworkId::default());
    let is_built = tree.is_built();
    let why = "because each hop is acknowledged, and nodes must hear each other at any time";
    let only = format!("`csma_unslotted`, `tsch` or `sleep`, {why}");
    let mac = tables.mac.value;
    let error = match mac {
        MacConfig::CsmaUnslotted(csma) if csma.rx_on_when_idle => return,
        MacConfig::CsmaUnslotted(_) => {
            SettingError::new("csma_unslotted.rx_on_when_idle", "false, beside `routing`", format!("true, {why}"))
        }
        MacConfig::BeaconEnabled(_) | MacConfig::SectorSweep(_) | MacConfig::Program(_) => {
            SettingError::new(mac.key(), "a table beside `routing`", only)
        }
        MacConfig::Tsch(TschConfig { schedule: ScheduleConfig::Orchestra(orchestra), .. })
            if is_built && orchestra.unicast == UnicastConfig::SenderBased =>
        {
            let allowed = "`receiver_based`, because nodes listen in the cells of their children, which change";
            let found = format!("`sender_based`, beside `routing.tree.{}`", tree.name());
            SettingError::new("tsch.schedule.orchestra.unicast", found, allowed)
        }
        MacConfig::Sleep(_) if is_built => {
            let allowed = "another tree: its beacons to all would take an interval each";
            SettingError::new("sleep", format!("a table, beside `routing.tree.{}`", tree.name()), allowed)
        }
        MacConfig::Tsch(_) | MacConfig::Sleep(_) => return,
    };
    errors.refuse(&error.within(&tables.mac.key));
}

/// Refuses frames without room for the header of a packet, and acknowledgements from afar.
fn check_traffic(routing: &RoutingConfig, setup: &Setup, errors: &mut Errors) {
    let traffic = &setup.network().traffic;
    for kind in traffic.kinds().filter(|kind| !kind.is_silent()) {
        if kind.is_acknowledged() {
            let key = format!("{}.acknowledged", kind.key());
            let allowed = "false: with `routing` each hop is acknowledged, and packets go to a sink in any case";
            errors.refuse(&SettingError::new(key, "true, beside `routing`", allowed));
        }
        let (octets, least) = (kind.mpdu_octets(), Routing::least_mpdu_octets(&routing.tree, routing.to));
        // Packets in fragments have a size of their own.
        if routing.fragments.is_none() && octets < least {
            let allowed =
                format!("at least {least} with `routing`: headers of MAC and packet, and the check sequence");
            errors.refuse(&SettingError::new(format!("{}.mpdu_octets", kind.key()), octets, allowed));
        }
    }
}
