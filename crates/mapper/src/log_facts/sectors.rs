//! How the antenna sector in which a node was heard is used.

use sextant_channel::{
    ChannelConfig, ChannelLaw, CloseInConfig, EvenSectorsConfig, LogError, PathLossConfig, ReceptionLog,
    ReflectionsConfig, SectorConfig, SectorTable,
};
use sextant_kernel::SettingError;

use crate::profile::ObstacleUse;

/// The carrier of radios with sectors, if nothing tells another one (GHz): channel 2 of IEEE 802.11ad.
const CARRIER_GHZ: f64 = 60.48;

/// How the sectors of receptions enter the likelihood, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SectorsConfig {
    /// How far outside the sector of a reception a vertex may lie.
    #[cfg_attr(feature = "config", serde(default))]
    pub tolerance: SectorTolerance,
    /// The sectors of the listener. If absent, those in the log. If the log has none either, sectors are not used.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub layout: Option<SectorLayoutConfig>,
    /// What a stop that heard nothing says about places to which no sector points.
    #[cfg_attr(feature = "config", serde(default))]
    pub silence: SilenceRule,
    /// How likely a node names a sector, given the direction to it. If absent: `gains` where the log knows measured gains of
    /// the antenna and the profile is fitted, otherwise `wedge`.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub model: Option<SectorModel>,
    /// Whether the map knows the obstacles of the world. If so, sectors have the gains of all ways among them: straight, less what
    /// they absorb, and reflected. Only with `model = "gains"`.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "ObstacleUse::is_unknown"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = "unknown")))]
    pub obstacles: ObstacleUse,
    /// Carrier at which known obstacles absorb and reflect (GHz). If absent: that of the channel in a scenario, otherwise 60.48.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub carrier_ghz: Option<f64>,
    /// How known obstacles reflect. If absent: as the channel of a scenario says, otherwise by their materials, each signal once.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reflections: Option<ReflectionsConfig>,
}

/// How likely a node names a sector, given the direction to it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SectorModel {
    /// All directions within the sector and its tolerance are alike, others are impossible (thesis, chapter 4).
    Wedge,
    /// By the gains of the antenna, which the log knows: the node names the sector that it hears best, and is heard as far
    /// as that sector reaches. What this antenna differs by from its pattern is estimated from the log. Only with
    /// `profile.fitted`.
    Gains,
    /// By gains that are guessed from the widths of the sectors: the node names the one that it hears best.
    Soft(SoftSectorsConfig),
}

/// Whether the gains of an antenna say how nodes are heard and which sectors they name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum GainUse {
    /// If the log knows them, and they were measured.
    #[default]
    IfKnown,
    /// The log must know them.
    Needed,
    /// They do not.
    Never,
}

/// The gains of sectors, and the errors of their strengths, as written in a scenario. The main lobe of a sector is
/// elliptical: its half-power widths are those of the sector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SoftSectorsConfig {
    /// Standard deviation of the error of the strength of a sector (dB); estimated from the log if absent.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub sigma_db: Option<f64>,
    /// How far side lobes are below the peak of a sector (dB).
    pub side_lobe_db: f64,
}

impl Default for SoftSectorsConfig {
    fn default() -> Self {
        Self { sigma_db: None, side_lobe_db: 30.0 }
    }
}

/// What a stop that heard nothing of a node says about the places to which no sector of its antenna points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SilenceRule {
    /// Nothing, as if they were beyond the range: no packet can arrive from there. A place is covered if any sector
    /// with its tolerance holds it.
    #[default]
    Covered,
    /// The same as about other places (thesis, chapter 4, which takes all directions to be covered).
    Everywhere,
}

/// How far outside the sector of a reception a vertex may lie. A tolerance is needed because nodes lie between the
/// vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SectorTolerance {
    /// Half the diagonal of a grid cell beyond each edge of the sector, at any distance.
    Positional,
    /// An angle at each edge: the larger of the one under which a grid step is seen over the range,
    /// `atan(grid_step_m / R)`, and the one under which half a step is seen over the distance d of the vertex,
    /// `atan(grid_step_m / 2d)`. For azimuths, d is the horizontal distance. A vertex at the stop is in every sector.
    #[default]
    Angular,
    /// `atan(grid_step_m / R)` at each edge, at any distance (thesis, chapter 4).
    AngularLiteral,
    /// Any distance: sectors are not used.
    Unlimited,
}

/// The sectors of a listener as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "config",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SectorLayoutConfig {
    /// Sectors of equal width all round.
    Even(EvenSectorsConfig),
    /// A list of sectors.
    List(Vec<SectorConfig>),
}

/// How the sectors of receptions enter the likelihood, checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SectorSettings {
    pub(crate) tolerance: SectorTolerance,
    layout: Option<SectorTable>,
    pub(crate) silence: SilenceRule,
    /// If the probabilities of sectors count.
    pub(crate) soft: Option<SoftSectorsConfig>,
    pub(crate) gains: GainUse,
    /// How signals go among known obstacles, if they count.
    pub(crate) ways: Option<ChannelLaw>,
}

impl SectorSettings {
    /// The wedges that are evidence in `log`; `None` if sectors are not used, or the antenna turns: a wedge has one direction
    /// at all stops. Gains serve then.
    ///
    /// # Errors
    /// If a reception names a sector that is not among those of the settings.
    pub(crate) fn table<'a>(&'a self, log: &'a ReceptionLog) -> Result<Option<&'a SectorTable>, LogError> {
        let has_wedges = log.receptions().sectors().is_some() && !log.has_headings();
        if self.tolerance == SectorTolerance::Unlimited || !has_wedges {
            return Ok(None);
        }
        if let Some(layout) = &self.layout {
            log.check_sectors(layout)?;
        }
        Ok(self.layout.as_ref().or(log.sectors()))
    }
}

impl TryFrom<SectorsConfig> for SectorSettings {
    type Error = SettingError;

    fn try_from(config: SectorsConfig) -> Result<Self, SettingError> {
        let ways = ways(&config)?;
        let SectorsConfig { tolerance, layout, silence, model, .. } = config;
        let layout = match layout {
            None => None,
            Some(SectorLayoutConfig::Even(even)) => {
                Some(SectorTable::try_from(even).map_err(|error| error.within("layout.even"))?)
            }
            Some(SectorLayoutConfig::List(list)) => {
                let list = SectorTable::new(list);
                Some(list.map_err(|error| SettingError { key: format!("layout.list{}", error.key), ..error })?)
            }
        };
        let gains = match model {
            None if layout.is_none() && tolerance != SectorTolerance::Unlimited => GainUse::IfKnown,
            Some(SectorModel::Gains) => GainUse::Needed,
            None | Some(SectorModel::Wedge | SectorModel::Soft(_)) => GainUse::Never,
        };
        let soft = match model {
            None | Some(SectorModel::Wedge | SectorModel::Gains) => None,
            Some(SectorModel::Soft(soft)) => {
                let within = |error: SettingError| error.within("model.soft");
                if let Some(sigma_db) = soft.sigma_db {
                    SettingError::positive("sigma_db", sigma_db).map_err(within)?;
                }
                SettingError::positive("side_lobe_db", soft.side_lobe_db).map_err(within)?;
                Some(soft)
            }
        };
        Ok(Self { tolerance, layout, silence, soft, gains, ways })
    }
}

/// How signals go among obstacles, if they are known.
fn ways(config: &SectorsConfig) -> Result<Option<ChannelLaw>, SettingError> {
    if config.obstacles == ObstacleUse::Unknown {
        let needless = [("carrier_ghz", config.carrier_ghz.is_some()), ("reflections", config.reflections.is_some())];
        return match needless.iter().find(|(_, is_given)| *is_given) {
            Some((key, _)) => {
                Err(SettingError::conflict(*key, "obstacles that are unknown", "write `obstacles = \"known\"`"))
            }
            None => Ok(None),
        };
    }
    if config.model != Some(SectorModel::Gains) {
        return Err(SettingError::conflict("obstacles", "another model than gains", "write `model = \"gains\"`"));
    }
    let carrier_ghz = SettingError::in_range("carrier_ghz", config.carrier_ghz.unwrap_or(CARRIER_GHZ), 0.1, 1000.0)?;
    let path_loss = CloseInConfig { carrier_ghz: Some(carrier_ghz), exponent: Some(2.0), ..CloseInConfig::default() };
    // Ways round edges keep no image.
    let reflections = ReflectionsConfig { edges: false, ..config.reflections.unwrap_or_default() };
    let channel = ChannelConfig {
        environment: None,
        path_loss: Some(PathLossConfig::CloseIn(path_loss)),
        reflections: Some(reflections),
        ..ChannelConfig::default()
    };
    ChannelLaw::try_from(channel).map(Some)
}
