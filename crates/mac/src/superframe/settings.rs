//! Settings of a beacon-enabled PAN.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use super::{MAX_GUARANTEED, MAX_ORDER, SLOTS};
use crate::RadioState;
use crate::csma::{CsmaConfig, CsmaSettings};

/// A beacon-enabled PAN of IEEE 802.15.4 whose coordinator is the first robot, or the first sink, as written in a scenario. It
/// sends beacons while it stands and listens. Nodes that heard a beacon answer in its superframe, by slotted CSMA-CA
/// or in a guaranteed slot. Defaults are those of the standard where it has them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct BeaconEnabledConfig {
    /// Beacon order (macBeaconOrder): a beacon every 960 symbols * 2^order, which is 15.36 ms * 2^order at 2.4 GHz; 0 to 14.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 14)))]
    pub beacon_order: u8,
    /// Superframe order (macSuperframeOrder): stations are active for 960 symbols * 2^order after the start of a beacon; 0 to
    /// the beacon order.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 14)))]
    pub superframe_order: u8,
    /// Whether nodes contend only in the six backoff periods after a beacon, with shorter backoffs (macBattLifeExt).
    pub battery_life_extension: bool,
    /// Guaranteed time slots for transmission, from the end of the active part backwards: at most 7.
    pub gts: Vec<GtsConfig>,
    /// Whether nodes that are synchronised sleep outside the active part.
    pub sleep_when_inactive: bool,
    /// First backoff exponent (macMinBE): 0 to max_be.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 8)))]
    pub min_be: u8,
    /// Largest backoff exponent (macMaxBE): 3 to 8.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 8)))]
    pub max_be: u8,
    /// Further backoffs after the first busy channel, before the frame is given up (macMaxCSMABackoffs): 0 to 5.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 5)))]
    pub max_backoffs: u8,
    /// Further transmissions of a frame without acknowledgement (macMaxFrameRetries): 0 to 7.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 7)))]
    pub max_retries: u8,
    /// Whether the receiver stays on between frames in the active part (macRxOnWhenIdle).
    pub rx_on_when_idle: bool,
    /// Frames that wait while another one is under way; one more is lost: 0 to 10000.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 10000)))]
    pub queue_frames: u16,
}

/// A guaranteed time slot, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GtsConfig {
    /// Name of the node that transmits in it.
    pub node: String,
    /// Its length [slots of the superframe]: 1 to 15.
    #[serde(default = "one")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 15)))]
    pub slots: u8,
}

fn one() -> u8 {
    1
}

impl Default for BeaconEnabledConfig {
    fn default() -> Self {
        let CsmaConfig { min_be, max_be, max_backoffs, max_retries, rx_on_when_idle, queue_frames, .. } =
            CsmaConfig::default();
        Self {
            beacon_order: 6,
            superframe_order: 6,
            battery_life_extension: false,
            gts: Vec::new(),
            sleep_when_inactive: true,
            min_be,
            max_be,
            max_backoffs,
            max_retries,
            rx_on_when_idle,
            queue_frames,
        }
    }
}

/// A guaranteed time slot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gts {
    /// Name of the node that transmits in it.
    pub node: String,
    /// Its length (slots).
    pub slots: u8,
}

/// A beacon-enabled PAN, settings checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BeaconEnabled {
    beacon_order: u8,
    superframe_order: u8,
    battery_life_extension: bool,
    gts: Vec<Gts>,
    csma: CsmaSettings,
    inactive_state: RadioState,
}

impl BeaconEnabled {
    /// Beacon order, 0 to 14.
    #[must_use]
    pub const fn beacon_order(&self) -> u8 {
        self.beacon_order
    }

    /// Superframe order, 0 to the beacon order.
    #[must_use]
    pub const fn superframe_order(&self) -> u8 {
        self.superframe_order
    }

    /// Whether contention is limited to the time after the beacon.
    #[must_use]
    pub(crate) const fn battery_life_extension(&self) -> bool {
        self.battery_life_extension
    }

    /// Guaranteed slots: at most 7, at most one per node, together at most 15 slots of the superframe; the first of
    /// them is the last of the superframe.
    #[must_use]
    pub fn gts(&self) -> &[Gts] {
        &self.gts
    }

    /// Settings of contention.
    #[must_use]
    pub const fn csma(&self) -> CsmaSettings {
        self.csma
    }

    /// State of a node's radio between the active part and the next beacon.
    #[must_use]
    pub(crate) const fn inactive_state(&self) -> RadioState {
        self.inactive_state
    }
}

impl TryFrom<BeaconEnabledConfig> for BeaconEnabled {
    type Error = SettingError;

    fn try_from(config: BeaconEnabledConfig) -> Result<Self, SettingError> {
        let BeaconEnabledConfig { beacon_order, superframe_order, battery_life_extension, .. } = config;
        if beacon_order > MAX_ORDER {
            return Err(SettingError::new("beacon_order", beacon_order, format!("0 to {MAX_ORDER}")));
        }
        if superframe_order > beacon_order {
            let allowed = format!("0 to beacon_order, which is {beacon_order}");
            return Err(SettingError::new("superframe_order", superframe_order, allowed));
        }
        let csma = CsmaSettings::try_from(CsmaConfig {
            min_be: config.min_be,
            max_be: config.max_be,
            max_backoffs: config.max_backoffs,
            max_retries: config.max_retries,
            rx_on_when_idle: config.rx_on_when_idle,
            queue_frames: config.queue_frames,
            idle_turnarounds: false,
            sleep_between_frames: false,
        })?;
        Ok(Self {
            beacon_order,
            superframe_order,
            battery_life_extension,
            gts: checked(&config.gts)?,
            csma,
            inactive_state: if config.sleep_when_inactive { RadioState::Sleep } else { csma.resting_state() },
        })
    }
}

fn checked(configs: &[GtsConfig]) -> Result<Vec<Gts>, SettingError> {
    if configs.len() > MAX_GUARANTEED {
        return Err(SettingError::new("gts", format!("{} slots", configs.len()), "at most 7 guaranteed time slots"));
    }
    let mut left = SLOTS - 1;
    for (i, GtsConfig { node, slots }) in configs.iter().enumerate() {
        let refusal = |key, found, allowed| Err(SettingError::new(key, found, allowed).within(format!("gts[{i}]")));
        if configs[..i].iter().any(|other| other.node == *node) {
            return refusal("node", format!("`{node}`, which has a slot already"), "one slot per node".to_owned());
        }
        if !(1..=left).contains(slots) {
            let allowed = format!("1 to {left}: the other slots take the rest, and one slot is for contention");
            return refusal("slots", slots.to_string(), allowed);
        }
        left -= slots;
    }
    Ok(configs.iter().map(|GtsConfig { node, slots }| Gts { node: node.clone(), slots: *slots }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl FnOnce(&mut BeaconEnabledConfig)) -> Option<String> {
        let mut config = BeaconEnabledConfig::default();
        change(&mut config);
        BeaconEnabled::try_from(config).err().map(|error| error.key)
    }

    fn gts(slots: &[u8]) -> Vec<GtsConfig> {
        slots.iter().enumerate().map(|(i, &slots)| GtsConfig { node: format!("n{i}"), slots }).collect()
    }

    #[test]
    fn settings_outside_the_range_of_the_standard_are_rejected() {
        assert_eq!(refused(|_| ()), None);
        assert_eq!(refused(|c| c.beacon_order = 15).as_deref(), Some("beacon_order"));
        assert_eq!(refused(|c| c.superframe_order = 7).as_deref(), Some("superframe_order"));
        assert_eq!(refused(|c| c.min_be = 6).as_deref(), Some("min_be"));
        assert_eq!(refused(|c| (c.beacon_order, c.superframe_order) = (14, 14)), None);
        assert_eq!(refused(|c| (c.beacon_order, c.superframe_order) = (14, 0)), None);
    }

    #[test]
    fn at_most_seven_guaranteed_slots_one_per_node_leave_a_slot_for_contention() {
        assert_eq!(refused(|c| c.gts = gts(&[1; 7])), None);
        assert_eq!(refused(|c| c.gts = gts(&[1; 8])).as_deref(), Some("gts"));
        assert_eq!(refused(|c| c.gts = gts(&[8, 7])), None);
        assert_eq!(refused(|c| c.gts = gts(&[8, 8])).as_deref(), Some("gts[1].slots"));
        assert_eq!(refused(|c| c.gts = gts(&[255])).as_deref(), Some("gts[0].slots"));
        assert_eq!(refused(|c| c.gts = gts(&[0])).as_deref(), Some("gts[0].slots"));
        let twice = vec![GtsConfig { node: "n".to_owned(), slots: 1 }; 2];
        assert_eq!(refused(|c| c.gts = twice).as_deref(), Some("gts[1].node"));
    }

    #[test]
    fn a_node_sleeps_when_inactive_by_default() {
        let state = |sleep_when_inactive, rx_on_when_idle| {
            let config = BeaconEnabledConfig { sleep_when_inactive, rx_on_when_idle, ..Default::default() };
            BeaconEnabled::try_from(config).expect("good settings").inactive_state()
        };
        assert_eq!(state(true, true), RadioState::Sleep);
        assert_eq!(state(false, false), RadioState::Idle);
        assert_eq!(state(false, true), RadioState::Receive);
    }
}
