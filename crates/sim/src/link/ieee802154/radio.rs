//! The radios of the stations: transmit power, sensitivity, threshold of carrier sense, noise, clock, what is received.

use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::{NodeId, Seed, SettingError};
use sextant_mac::{Phy, oqpsk};

use crate::air::{ReceptionConfig, ReceptionModel};
use crate::link::clock::Clock;
use crate::link::config::{LinkConfig, LinkError, RadioConfig, RadioGroupConfig};
use crate::purpose;
use crate::service::network_id::NetworkId;
use crate::world::layout::PlacedNode;

/// Threshold of carrier sense above the sensitivity (IEEE 802.15.4-2006, 6.9.9: at most 10 dB).
const CCA_MARGIN: Db = Db(10.0);

/// Largest deviation of a clock (millionths).
const WORST_CLOCK_PPM: f64 = 1000.0;

/// The radios of all stations.
#[derive(Clone, Debug, PartialEq)]
pub struct Radio {
    phy: Phy,
    channel: u8,
    levels: Levels,
    /// Those of the groups of nodes that differ.
    groups: Vec<Levels>,
    /// Number of the group of each node; empty if there are no groups.
    group_of: Vec<Option<u16>>,
    /// The rule that decides whether a frame is received.
    reception: ReceptionModel,
}

/// What the radios of a group have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels {
    /// Transmit power at the reference distance.
    pub(crate) tx_power: Dbm,
    /// Minimum power of a frame that can be received.
    pub(crate) sensitivity: Dbm,
    /// Power at or above which carrier sense finds the channel busy.
    pub(crate) cca_threshold: Dbm,
    /// Noise in the bandwidth of the receiver.
    pub(crate) noise_floor: Dbm,
    clock: Rate,
}

/// The rate of a clock (millionths).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rate {
    /// Random, up to this much.
    UpTo(f64),
    /// Fast by this much.
    FastBy(f64),
}

impl TryFrom<&RadioConfig> for Levels {
    type Error = SettingError;

    fn try_from(config: &RadioConfig) -> Result<Self, SettingError> {
        let level = |key, dbm| SettingError::in_range(key, dbm, -200.0, 100.0).map(Dbm);
        let tx_power = level("tx_power_dbm", config.tx_power_dbm)?;
        let sensitivity = level("sensitivity_dbm", config.sensitivity_dbm)?;
        let cca_threshold = match config.cca_threshold_dbm {
            Some(dbm) => level("cca_threshold_dbm", dbm)?,
            None => sensitivity + CCA_MARGIN,
        };
        let noise_floor = match config.noise_floor_dbm {
            Some(dbm) => level("noise_floor_dbm", dbm)?,
            None => oqpsk::noise_floor(sensitivity),
        };
        let clock = SettingError::in_range("clock_ppm", config.clock_ppm, 0.0, WORST_CLOCK_PPM).map(Rate::UpTo)?;
        Ok(Self { tx_power, sensitivity, cca_threshold, noise_floor, clock })
    }
}

/// The radios without the groups of nodes, which [`Radio::new`] knows, and with the default rule of reception.
impl TryFrom<RadioConfig> for Radio {
    type Error = SettingError;

    fn try_from(config: RadioConfig) -> Result<Self, SettingError> {
        let (phy, channels) = (config.phy, config.phy.channels());
        let channel = config.channel.unwrap_or(*channels.start());
        if !channels.contains(&channel) {
            let allowed = format!("{} to {} with this `phy`", channels.start(), channels.end());
            return Err(SettingError::new("channel", channel, allowed));
        }
        let (levels, reception) = (Levels::try_from(&config)?, ReceptionConfig::default().try_into()?);
        Ok(Self { phy, channel, levels, groups: Vec::new(), group_of: Vec::new(), reception })
    }
}

impl Radio {
    /// The radios that a scenario describes, with their groups if the nodes are known; `None` with an error if it describes none.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        errors: &mut Vec<LinkError>,
    ) -> Option<Self> {
        let radio = match (config.radio, nodes) {
            (Some(radio), Some(nodes)) => LinkError::take("radio", Self::new(radio, nodes), errors),
            (Some(radio), None) => LinkError::take("radio", Self::try_from(radio.clone()), errors),
            (None, _) => LinkError::missing("radio", errors),
        };
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or_default());
        let reception = LinkError::take("reception", reception, errors);
        Some(Self { reception: reception?, ..radio? })
    }

    /// The radios with the groups of `nodes`.
    ///
    /// # Errors
    /// If a setting is out of range, or a group has no node, or one that is unknown or in another group.
    pub fn new(config: &RadioConfig, nodes: &[PlacedNode]) -> Result<Self, SettingError> {
        let mut radio = Self::try_from(config.clone())?;
        for (i, group) in config.groups.iter().enumerate() {
            let table = format!("groups[{i}]");
            radio.add(config, group, nodes).map_err(|error| error.within(table))?;
        }
        Ok(radio)
    }

    fn add(
        &mut self,
        config: &RadioConfig,
        group: &RadioGroupConfig,
        nodes: &[PlacedNode],
    ) -> Result<(), SettingError> {
        let mut levels = Levels::try_from(&config.of_group(group))?;
        if let Some(ppm) = group.clock_offset_ppm {
            if group.clock_ppm.is_some() {
                return Err(SettingError::conflict("clock_offset_ppm", "`clock_ppm`", "set one of them"));
            }
            let ppm = SettingError::in_range("clock_offset_ppm", ppm, -WORST_CLOCK_PPM, WORST_CLOCK_PPM)?;
            levels.clock = Rate::FastBy(ppm);
        }
        let number = self.groups.len();
        let number = u16::try_from(number).map_err(|_| SettingError::new("nodes", number, "at most 65536 groups"))?;
        self.group_of.resize(nodes.len(), None);
        let members = group.nodes.choose(nodes, |node| self.group_of[node].is_some())?;
        members.into_iter().for_each(|node| self.group_of[node] = Some(number));
        self.groups.push(levels);
        Ok(())
    }

    /// The same radios with this rule that decides whether a frame is received.
    #[must_use]
    pub fn with_reception(self, reception: ReceptionModel) -> Self {
        Self { reception, ..self }
    }

    /// The rule that decides whether a frame is received.
    #[must_use]
    pub fn reception(&self) -> ReceptionModel {
        self.reception
    }

    /// The physical layer.
    #[must_use]
    pub fn phy(&self) -> Phy {
        self.phy
    }

    /// Number of the radio channel.
    #[must_use]
    pub fn channel(&self) -> u8 {
        self.channel
    }

    /// Transmit power at the reference distance, but for nodes in groups.
    #[must_use]
    pub fn tx_power(&self) -> Dbm {
        self.levels.tx_power
    }

    /// Minimum power of a frame that can be received, but for nodes in groups.
    #[must_use]
    pub fn sensitivity(&self) -> Dbm {
        self.levels.sensitivity
    }

    /// Power at or above which carrier sense finds the channel busy, but for nodes in groups.
    #[must_use]
    pub fn cca_threshold(&self) -> Dbm {
        self.levels.cca_threshold
    }

    /// Noise in the bandwidth of the receiver, but for nodes in groups.
    #[must_use]
    pub fn noise_floor(&self) -> Dbm {
        self.levels.noise_floor
    }

    /// The greatest transmit power of any station.
    pub(crate) fn greatest_tx_power(&self) -> Dbm {
        self.all_levels().map(|levels| levels.tx_power).fold(Dbm(f64::MIN), |a, b| if b > a { b } else { a })
    }

    /// The least noise in any receiver.
    pub(crate) fn least_noise_floor(&self) -> Dbm {
        self.all_levels().map(|levels| levels.noise_floor).fold(Dbm(f64::MAX), |a, b| if b < a { b } else { a })
    }

    /// Those of all groups, after those of the stations in none.
    pub(crate) fn all_levels(&self) -> impl Iterator<Item = &Levels> {
        std::iter::once(&self.levels).chain(&self.groups)
    }

    /// Number of a node among [`Radio::all_levels`].
    pub(crate) fn level_of(&self, node: NodeId) -> u16 {
        self.group_of.get(node.index()).copied().flatten().map_or(0, |group| group + 1)
    }

    /// Those of the stations in no group, such as robots and sinks.
    pub(crate) fn common_levels(&self) -> &Levels {
        &self.levels
    }

    /// Those of a node.
    pub(crate) fn levels(&self, node: NodeId) -> &Levels {
        match self.group_of.get(node.index()).copied().flatten() {
            Some(group) => &self.groups[usize::from(group)],
            None => &self.levels,
        }
    }

    /// Whether a clock may drift.
    #[must_use]
    pub fn has_drift(&self) -> bool {
        let ppm = |levels: &Levels| match levels.clock {
            Rate::UpTo(ppm) | Rate::FastBy(ppm) => ppm,
        };
        self.all_levels().any(|levels| ppm(levels).abs() > 0.0)
    }

    /// By how much a receiver is ready for an answer before its clock says that the turnaround is over. 12 symbols are the most
    /// that a turnaround takes (IEEE 802.15.4-2006, 6.4.1), and clocks differ: an answer of the fastest one reaches the slowest.
    pub(crate) fn lead(&self) -> Duration {
        let share = if self.has_drift() { 2.5e-6 * WORST_CLOCK_PPM } else { 0.0 };
        self.phy().turnaround().mul_f64(share)
    }

    /// The clock of a node.
    pub(crate) fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        Clock::fast_by(self.clock_ppm(seed, network, node))
    }

    /// By how much the clock of a node is fast (millionths).
    pub(crate) fn clock_ppm(&self, seed: Seed, network: NetworkId, node: NodeId) -> f64 {
        let draw = || seed.uniform(purpose::CLOCK, [node.0.into(), network.0.into(), 0]);
        match self.levels(node).clock {
            Rate::UpTo(ppm) => ppm * (2.0 * draw() - 1.0),
            Rate::FastBy(ppm) => ppm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::layout::NodesOfGroup;
    use sextant_channel::Position;

    fn nodes() -> Vec<PlacedNode> {
        ["a", "b", "c"].map(|name| PlacedNode { name: name.to_owned(), position: Position::ORIGIN }).into()
    }

    fn group(nodes: NodesOfGroup) -> RadioGroupConfig {
        RadioGroupConfig {
            nodes,
            tx_power_dbm: None,
            sensitivity_dbm: None,
            cca_threshold_dbm: None,
            noise_floor_dbm: None,
            clock_ppm: None,
            clock_offset_ppm: None,
        }
    }

    fn radio(groups: Vec<RadioGroupConfig>) -> Result<Radio, SettingError> {
        let config = RadioConfig {
            phy: Phy::Oqpsk2450,
            channel: None,
            tx_power_dbm: 0.0,
            sensitivity_dbm: -90.0,
            cca_threshold_dbm: None,
            noise_floor_dbm: None,
            clock_ppm: 0.0,
            groups,
        };
        Radio::new(&config, &nodes())
    }

    #[test]
    fn a_group_has_levels_of_its_own_and_the_rest_of_the_others() {
        let named = |name: &str| NodesOfGroup::Names(vec![name.to_owned()]);
        let strong = RadioGroupConfig { tx_power_dbm: Some(10.0), ..group(named("b")) };
        let fine = RadioGroupConfig { sensitivity_dbm: Some(-100.0), ..group(NodesOfGroup::Others {}) };
        let radio = radio(vec![strong, fine]).expect("good groups");
        let levels = [0, 1, 2].map(|node| {
            let levels = radio.levels(NodeId(node));
            (levels.tx_power, levels.sensitivity, levels.cca_threshold)
        });
        let fine = (Dbm(0.0), Dbm(-100.0), Dbm(-90.0));
        assert_eq!(levels, [fine, (Dbm(10.0), Dbm(-90.0), Dbm(-80.0)), fine]);
        assert_eq!(
            (radio.greatest_tx_power(), radio.least_noise_floor()),
            (Dbm(10.0), oqpsk::noise_floor(Dbm(-100.0)))
        );
        assert_eq!([0, 1, 2].map(|node| radio.level_of(NodeId(node))), [2, 1, 2]);
        assert!(!radio.has_drift());
    }

    #[test]
    fn invalid_groups_are_rejected_with_their_keys() {
        let all = || group(NodesOfGroup::Others {});
        let key = |groups| radio(groups).err().map(|error| error.key);
        assert_eq!(key(vec![all()]), None);
        let unknown = group(NodesOfGroup::Names(vec!["z".to_owned()]));
        assert_eq!(key(vec![unknown]).as_deref(), Some("groups[0].nodes.names[0]"));
        assert_eq!(key(vec![group(NodesOfGroup::Count(4))]).as_deref(), Some("groups[0].nodes.count"));
        assert_eq!(key(vec![all(), all()]).as_deref(), Some("groups[1].nodes"));
        for bad in [f64::NAN, f64::INFINITY, 101.0] {
            let power = RadioGroupConfig { tx_power_dbm: Some(bad), ..all() };
            assert_eq!(key(vec![power]).as_deref(), Some("groups[0].tx_power_dbm"));
            let sensitivity = RadioGroupConfig { sensitivity_dbm: Some(bad), ..all() };
            assert_eq!(key(vec![sensitivity]).as_deref(), Some("groups[0].sensitivity_dbm"));
        }
        for bad in [-1.0, f64::NAN, 1001.0] {
            let clock = RadioGroupConfig { clock_ppm: Some(bad), ..all() };
            assert_eq!(key(vec![clock]).as_deref(), Some("groups[0].clock_ppm"));
        }
        let offset = RadioGroupConfig { clock_offset_ppm: Some(-1001.0), ..all() };
        assert_eq!(key(vec![offset]).as_deref(), Some("groups[0].clock_offset_ppm"));
        let both = RadioGroupConfig { clock_offset_ppm: Some(1.0), clock_ppm: Some(1.0), ..all() };
        assert_eq!(key(vec![both]).as_deref(), Some("groups[0].clock_offset_ppm"));
    }
}
