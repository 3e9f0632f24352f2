//! How receptions of several packets count.

use std::borrow::Cow;

use sextant_channel::ReceptionLog;

/// How a reception of several packets counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum CountRule {
    /// Each packet received or missed counts by itself.
    Packets,
    /// The listening slot counts as one packet. It is received if at least one packet was received (thesis, chapter
    /// 3).
    AtLeastOne,
}

impl CountRule {
    /// A log with its receptions counted by this rule.
    pub(crate) fn counted(self, log: &ReceptionLog) -> Cow<'_, ReceptionLog> {
        match self {
            Self::Packets => Cow::Borrowed(log),
            Self::AtLeastOne => log.at_least_one(),
        }
    }
}
