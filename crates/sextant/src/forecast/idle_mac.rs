//! Keys of channel access and routing that change nothing beside the other settings.

use std::collections::BTreeMap;

use sextant_apps::routing::{RplMode, TreeConfig};
use sextant_mac::RadioState;
use sextant_mac::sleep::{Form, PhasesConfig, SinksConfig};
use sextant_sim::{Mac, Sleeping, Technology, Traffic, Tsch};

use super::network::Reach;
use super::warning::Warnings;

const BROADCASTS: &str =
    "all packets are broadcasts, which nobody acknowledges; set `acknowledged = true` in the table of the traffic";
const EXACT_CLOCKS: &str = "clocks are exact; let them drift with `radio.clock_ppm`";
const NO_DAOS: &str = "no DAOs are sent with `mode = \"none\"`";

/// Keys that change nothing, and why.
type Idle = BTreeMap<String, String>;

impl Warnings<'_> {
    /// Settings of channel access that are not used.
    pub(super) fn idle_keys_of_mac(&mut self, reach: &Reach<'_>) {
        let mut idle = Idle::new();
        match &reach.network.technology {
            Technology::Ieee802154(links) => {
                let table = match links.mac {
                    Mac::CsmaUnslotted(_) => "mac.csma_unslotted",
                    Mac::BeaconEnabled(_) => "mac.beacon_enabled",
                };
                self.of_csma(reach, table, links.mac.csma().resting_state(), &mut idle);
            }
            Technology::Tsch(links) => self.of_tsch(reach, links, &mut idle),
            Technology::Sleeping(links) => self.of_sleep(reach, links, &mut idle),
            Technology::Programmed(_) | Technology::Ieee80211ad(_) => {}
        }
        self.warn_of_changed(&reach.table(), &idle);
    }

    fn of_csma(&self, reach: &Reach<'_>, table: &str, resting: RadioState, idle: &mut Idle) {
        if self.has_broadcasts_alone(reach) {
            idle.insert(format!("{table}.max_retries"), BROADCASTS.to_owned());
        }
        if table == "mac.csma_unslotted" && resting == RadioState::Receive {
            let why = "the receiver stays on with `rx_on_when_idle`".to_owned();
            idle.insert(format!("{table}.idle_turnarounds"), why);
        }
        let mut kinds = kinds(reach).peekable();
        if kinds.peek().is_some() && kinds.all(Traffic::is_saturated) && self.sends_by_traffic() {
            let why = "a saturated node has its next packet as soon as the last one has ended".to_owned();
            idle.insert(format!("{table}.queue_frames"), why);
        }
    }

    fn of_tsch(&self, reach: &Reach<'_>, links: &Tsch, idle: &mut Idle) {
        let mut add = |key: &str, why: &str| idle.insert(format!("mac.tsch.{key}"), why.to_owned());
        if !links.radio.has_drift() {
            add("synchronisation.keep_alive_s", EXACT_CLOCKS);
            add("synchronisation.lost_after_s", EXACT_CLOCKS);
            // With clocks that drift, frames that keep the time are acknowledged.
            if self.has_broadcasts_alone(reach) && links.tsch.msf().is_none() {
                for key in [
                    "max_retries",
                    "min_be",
                    "max_be",
                    "timeslot.tx_ack_delay_us",
                    "timeslot.rx_ack_delay_us",
                    "timeslot.ack_wait_us",
                ] {
                    add(key, BROADCASTS);
                }
            }
        }
        let why = "stations send in their slots without looking at the channel".to_owned();
        idle.insert("radio.cca_threshold_dbm".to_owned(), why);
    }

    fn of_sleep(&self, reach: &Reach<'_>, links: &Sleeping, idle: &mut Idle) {
        let sleep = &links.sleep;
        let is_routed = self.scenario.routing().is_some();
        let broadcasts = self.has_broadcasts_alone(reach);
        let has_broadcasts = !is_routed && kinds(reach).any(|traffic| !traffic.is_acknowledged());
        // Stations that sleep, and acknowledge frames.
        let has_sleepers = is_routed || sleep.sinks == SinksConfig::Sleep;
        let (name, usual) = match sleep.form {
            Form::XMac => ("x_mac", PhasesConfig::Unknown),
            Form::RepeatedData => ("repeated_data", PhasesConfig::Unknown),
            Form::Csl => ("csl", PhasesConfig::Learned),
        };
        if broadcasts {
            idle.insert("mac.sleep.max_retries".to_owned(), BROADCASTS.to_owned());
        }
        let no_phase = if broadcasts {
            Some("phases are learned from acknowledgements, and all packets are broadcasts")
        } else if !has_sleepers {
            Some("packets go to sinks that are always on, which have no phase; set `mac.sleep.sinks = \"sleep\"`")
        } else {
            None
        };
        if let Some(why) = no_phase.filter(|_| sleep.phases != usual) {
            idle.insert(format!("mac.sleep.wake_up.{name}.phases"), why.to_owned());
        }
        let no_guard = match sleep.form {
            Form::XMac => Some("senders of `x_mac` do not know when a station wakes up"),
            Form::RepeatedData if sleep.phases == PhasesConfig::Unknown => {
                Some("senders do not know when a station wakes up; set `phases = \"learned\"`")
            }
            Form::RepeatedData => no_phase,
            // Who is woken comes back when the frame is due, and allows for clocks too.
            Form::Csl if has_broadcasts => None,
            Form::Csl => no_phase,
        };
        if let Some(why) = no_guard {
            idle.insert("mac.sleep.allowed_ppm".to_owned(), why.to_owned());
        }
    }

    /// Settings of routing that are not used.
    pub(super) fn idle_keys_of_routing(&mut self) {
        let Some(routing) = &self.scenario.config().routing else { return };
        let mut idle = Idle::new();
        if let TreeConfig::Rpl(rpl) = &routing.tree {
            let mut add = |key: &str, why: &str| idle.insert(format!("routing.tree.rpl.{key}"), why.to_owned());
            if rpl.mode != RplMode::Storing {
                add("route_table", "only nodes with `mode = \"storing\"` keep tables");
            }
            if rpl.mode == RplMode::None {
                for key in ["dao_tries", "dao_delay_s", "dao_retry_s", "route_lifetime_min"] {
                    add(key, NO_DAOS);
                }
            } else if rpl.dao_tries == 0 {
                add("dao_retry_s", "no answer to a DAO is asked for with `dao_tries = 0`");
            }
        }
        self.warn_of_changed("", &idle);
    }

    /// Warns of those of `idle` that the scenario sets, in the tables of a network or for all.
    fn warn_of_changed(&mut self, table: &str, idle: &Idle) {
        let own: Vec<String> = idle.keys().map(|key| format!("{table}{key}")).collect();
        let mut changed: Vec<String> =
            self.scenario.changed_keys(own.iter().map(String::as_str)).into_iter().map(str::to_owned).collect();
        if !table.is_empty() && changed.is_empty() && self.scenario.networks().len() == 1 {
            changed =
                self.scenario.changed_keys(idle.keys().map(String::as_str)).into_iter().map(str::to_owned).collect();
        }
        for key in changed {
            let why = &idle[key.strip_prefix(table).unwrap_or(&key)];
            self.warn(key.clone(), format!("it changes nothing: {why}"));
        }
    }

    /// Whether nodes send by their traffic, and all of it goes to all.
    fn has_broadcasts_alone(&self, reach: &Reach<'_>) -> bool {
        let mut kinds = kinds(reach).peekable();
        kinds.peek().is_some() && kinds.all(|traffic| !traffic.is_acknowledged()) && self.sends_by_traffic()
    }

    /// Whether nodes send nothing but their traffic, each packet by itself.
    fn sends_by_traffic(&self) -> bool {
        let scenario = self.scenario;
        scenario.routing().is_none() && scenario.missions().is_empty() && scenario.distributed().is_none()
    }
}

/// The kinds of traffic with which nodes send.
fn kinds<'a>(reach: &Reach<'a>) -> impl Iterator<Item = &'a Traffic> {
    reach.network.traffic.kinds().filter(|traffic| !traffic.is_silent())
}
