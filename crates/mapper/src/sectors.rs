//! How the antenna sector in which a node was heard is used.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{EvenSectorsConfig, LogError, ReceptionLog, SectorConfig, SectorTable};
use sextant_kernel::SettingError;

/// How the sectors of receptions enter the likelihood, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectorsConfig {
    /// How far outside the sector of a reception a vertex may lie.
    #[serde(default)]
    pub tolerance: SectorTolerance,
    /// The sectors of the listener. If absent, those in the log. If the log has none either, sectors are not used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<SectorLayoutConfig>,
}

/// How far outside the sector of a reception a vertex may lie. A tolerance is needed because nodes lie between the
/// vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectorTolerance {
    /// Half the diagonal of a grid cell beyond each edge of the sector, at any distance.
    #[default]
    Positional,
    /// The angle under which a grid step is seen over the range, `atan(grid_step_m / R)`, at each edge (thesis, chapter 4).
    Angular,
    /// Any distance: sectors are not used.
    Unlimited,
}

/// The sectors of a listener as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
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
}

impl SectorSettings {
    /// The sectors that are evidence in `log`; `None` if sectors are not used.
    ///
    /// # Errors
    /// If a reception names a sector that is not among those of the settings.
    pub(crate) fn table<'a>(&'a self, log: &'a ReceptionLog) -> Result<Option<&'a SectorTable>, LogError> {
        if self.tolerance == SectorTolerance::Unlimited || log.receptions().sectors().is_none() {
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

    fn try_from(SectorsConfig { tolerance, layout }: SectorsConfig) -> Result<Self, SettingError> {
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
        Ok(Self { tolerance, layout })
    }
}
