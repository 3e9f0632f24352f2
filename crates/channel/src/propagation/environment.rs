//! Environments with known path loss and shadowing.

/// An environment with known path loss exponent and shadowing. Those with a carrier have close-in path loss (loss of
/// free space over the first metre), the others log-distance path loss from a power at 1 m.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Environment {
    /// Suburban area: ε = 2.7, σ = 9.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "suburban"))]
    Suburban,
    /// Heavy tree density: ε = 4.6, σ = 10.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "heavy-tree"))]
    HeavyTrees,
    /// Light tree density: ε = 3.6, σ = 8.2 dB.
    #[cfg_attr(feature = "config", serde(rename = "light-tree"))]
    LightTrees,
    /// Warehouse of chapter 4 of the thesis: 73 GHz, ε = 1.7, σ = 3.2 dB.
    #[cfg_attr(feature = "config", serde(rename = "mmtm-warehouse"))]
    MmtmWarehouse,
    /// Greenhouse of chapter 4 of the thesis: 73 GHz, ε = 2.4, σ = 6.2 dB.
    #[cfg_attr(feature = "config", serde(rename = "mmtm-greenhouse"))]
    MmtmGreenhouse,
    /// Warehouse of chapter 5 of the thesis: 73 GHz, ε = 1.6, σ = 3.2 dB.
    #[cfg_attr(feature = "config", serde(rename = "dmmtm-warehouse"))]
    DmmtmWarehouse,
    /// Greenhouse of chapter 5 of the thesis: 73 GHz, ε = 2.4, σ = 6.3 dB.
    #[cfg_attr(feature = "config", serde(rename = "dmmtm-greenhouse"))]
    DmmtmGreenhouse,
    /// Indoor office, directional antennas in line of sight: 28 GHz, ε = 1.7, σ = 2.5 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-28-los"))]
    Office28Los,
    /// Indoor office, the best direction without line of sight: 28 GHz, ε = 3.0, σ = 10.8 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-28-nlos-best"))]
    Office28NlosBest,
    /// Indoor office, any direction without line of sight: 28 GHz, ε = 4.4, σ = 11.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-28-nlos"))]
    Office28Nlos,
    /// Indoor office, directional antennas in line of sight: 73 GHz, ε = 1.6, σ = 3.2 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-73-los"))]
    Office73Los,
    /// Indoor office, the best direction without line of sight: 73 GHz, ε = 3.4, σ = 11.8 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-73-nlos-best"))]
    Office73NlosBest,
    /// Indoor office, any direction without line of sight: 73 GHz, ε = 5.3, σ = 15.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-73-nlos"))]
    Office73Nlos,
    /// Indoor office, omnidirectional, in line of sight: 28 GHz, ε = 1.1, σ = 1.7 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-28-omni-los"))]
    Office28OmniLos,
    /// Indoor office, omnidirectional, without line of sight: 28 GHz, ε = 2.7, σ = 9.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-28-omni-nlos"))]
    Office28OmniNlos,
    /// Indoor office, omnidirectional, in line of sight: 73 GHz, ε = 1.3, σ = 1.9 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-73-omni-los"))]
    Office73OmniLos,
    /// Indoor office, omnidirectional, without line of sight: 73 GHz, ε = 3.2, σ = 11.3 dB.
    #[cfg_attr(feature = "config", serde(rename = "office-73-omni-nlos"))]
    Office73OmniNlos,
    /// Streets of Manhattan, omnidirectional, in line of sight: 28 GHz, ε = 2.1, σ = 3.6 dB.
    #[cfg_attr(feature = "config", serde(rename = "manhattan-28-omni-los"))]
    Manhattan28OmniLos,
    /// Streets of Manhattan, omnidirectional, without line of sight: 28 GHz, ε = 3.4, σ = 9.7 dB.
    #[cfg_attr(feature = "config", serde(rename = "manhattan-28-omni-nlos"))]
    Manhattan28OmniNlos,
    /// Streets of Manhattan, omnidirectional, in line of sight: 73 GHz, ε = 2.0, σ = 4.8 dB.
    #[cfg_attr(feature = "config", serde(rename = "manhattan-73-omni-los"))]
    Manhattan73OmniLos,
    /// Streets of Manhattan, omnidirectional, without line of sight: 73 GHz, ε = 3.4, σ = 7.9 dB.
    #[cfg_attr(feature = "config", serde(rename = "manhattan-73-omni-nlos"))]
    Manhattan73OmniNlos,
}

/// What is known of an environment.
struct Values {
    name: &'static str,
    exponent: f64,
    sigma_db: f64,
    carrier_ghz: Option<f64>,
    source: &'static str,
}

const THESIS_3: &str = "thesis, chapter 3, simulation parameters";
const THESIS_4: &str = "thesis, chapter 4, simulation parameters";
const THESIS_5: &str = "thesis, chapter 5, simulation parameters";
const OFFICE: &str = "MacCartney et al. (2015), IEEE Access 3, 2388, directional, vertical polarisation; \
                      figures not verified against the paper";
const OMNI: &str = "MacCartney et al. (2015), IEEE Access 3, 2388; exponents as in arXiv:1509.00395, deviations not \
                    verified against the paper";
const STREET: &str = "Rappaport et al. (2015), IEEE Transactions on Communications 63, 3029; figures not verified \
                      against the paper";

impl Environment {
    /// All environments: those of the thesis first.
    pub const ALL: [Self; 21] = [
        Self::Suburban,
        Self::HeavyTrees,
        Self::LightTrees,
        Self::MmtmWarehouse,
        Self::MmtmGreenhouse,
        Self::DmmtmWarehouse,
        Self::DmmtmGreenhouse,
        Self::Office28Los,
        Self::Office28NlosBest,
        Self::Office28Nlos,
        Self::Office73Los,
        Self::Office73NlosBest,
        Self::Office73Nlos,
        Self::Office28OmniLos,
        Self::Office28OmniNlos,
        Self::Office73OmniLos,
        Self::Office73OmniNlos,
        Self::Manhattan28OmniLos,
        Self::Manhattan28OmniNlos,
        Self::Manhattan73OmniLos,
        Self::Manhattan73OmniNlos,
    ];

    const fn values(self) -> Values {
        let (name, exponent, sigma_db, carrier_ghz, source) = match self {
            Self::Suburban => ("suburban", 2.7, 9.6, None, THESIS_3),
            Self::HeavyTrees => ("heavy-tree", 4.6, 10.6, None, THESIS_3),
            Self::LightTrees => ("light-tree", 3.6, 8.2, None, THESIS_3),
            Self::MmtmWarehouse => ("mmtm-warehouse", 1.7, 3.2, Some(73.0), THESIS_4),
            Self::MmtmGreenhouse => ("mmtm-greenhouse", 2.4, 6.2, Some(73.0), THESIS_4),
            Self::DmmtmWarehouse => ("dmmtm-warehouse", 1.6, 3.2, Some(73.0), THESIS_5),
            Self::DmmtmGreenhouse => ("dmmtm-greenhouse", 2.4, 6.3, Some(73.0), THESIS_5),
            Self::Office28Los => ("office-28-los", 1.7, 2.5, Some(28.0), OFFICE),
            Self::Office28NlosBest => ("office-28-nlos-best", 3.0, 10.8, Some(28.0), OFFICE),
            Self::Office28Nlos => ("office-28-nlos", 4.4, 11.6, Some(28.0), OFFICE),
            Self::Office73Los => ("office-73-los", 1.6, 3.2, Some(73.0), OFFICE),
            Self::Office73NlosBest => ("office-73-nlos-best", 3.4, 11.8, Some(73.0), OFFICE),
            Self::Office73Nlos => ("office-73-nlos", 5.3, 15.6, Some(73.0), OFFICE),
            Self::Office28OmniLos => ("office-28-omni-los", 1.1, 1.7, Some(28.0), OMNI),
            Self::Office28OmniNlos => ("office-28-omni-nlos", 2.7, 9.6, Some(28.0), OMNI),
            Self::Office73OmniLos => ("office-73-omni-los", 1.3, 1.9, Some(73.0), OMNI),
            Self::Office73OmniNlos => ("office-73-omni-nlos", 3.2, 11.3, Some(73.0), OMNI),
            Self::Manhattan28OmniLos => ("manhattan-28-omni-los", 2.1, 3.6, Some(28.0), STREET),
            Self::Manhattan28OmniNlos => ("manhattan-28-omni-nlos", 3.4, 9.7, Some(28.0), STREET),
            Self::Manhattan73OmniLos => ("manhattan-73-omni-los", 2.0, 4.8, Some(73.0), STREET),
            Self::Manhattan73OmniNlos => ("manhattan-73-omni-nlos", 3.4, 7.9, Some(73.0), STREET),
        };
        Values { name, exponent, sigma_db, carrier_ghz, source }
    }

    /// Name in scenarios.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.values().name
    }

    /// Path loss exponent ε.
    #[must_use]
    pub const fn exponent(self) -> f64 {
        self.values().exponent
    }

    /// Standard deviation of shadowing σ (dB).
    #[must_use]
    pub const fn sigma_db(self) -> f64 {
        self.values().sigma_db
    }

    /// Carrier for which it was measured (GHz), if path loss is close-in.
    #[must_use]
    pub const fn carrier_ghz(self) -> Option<f64> {
        self.values().carrier_ghz
    }

    /// Where its values are from.
    #[must_use]
    pub const fn source(self) -> &'static str {
        self.values().source
    }

    /// All names, for messages.
    pub(crate) fn names() -> String {
        Self::ALL.map(|environment| format!("\"{}\"", environment.name())).join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_scenarios() {
        for environment in Environment::ALL {
            let text = format!("environment = \"{}\"", environment.name());
            let config: crate::propagation::law::ChannelConfig = toml::from_str(&text).unwrap();
            assert_eq!(config.environment, Some(environment));
            assert!(!environment.source().is_empty());
        }
    }
}
