//! What robots seek.

use std::fmt;
use std::time::Duration;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sextant_kernel::SettingError;
use sextant_sim::{Field, FieldId};

/// What robots seek, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GoalConfig {
    /// Name of the field; may be absent if there is only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// The value that is sought, in the unit of the field: a robot that believes to be where the field has it has arrived.
    pub level: f64,
    /// A robot has arrived when the field is at most this much below the level. A robot that is above the level has arrived too.
    #[serde(default = "default_tolerance")]
    pub tolerance: f64,
    /// How long the field must stay within the tolerance below and above the level (s). If 0, a robot has arrived as soon as
    /// the field is the level less the tolerance, or more.
    #[serde(default)]
    pub hold_s: f64,
    /// What a robot does when it has arrived as often as it should.
    #[serde(default)]
    pub then: AfterArrival,
    /// How often each robot should arrive: the number of sources, if it removes them.
    #[serde(default = "one")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub arrivals: u32,
    /// A robot that has arrived removes the sources that are truly within this distance (m); if there is none, it has come
    /// to what is left of an earlier source, and has not arrived. If absent, it removes none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remove_within_m: Option<f64>,
}

/// What a robot does when it has arrived as often as it should.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AfterArrival {
    /// It stops there.
    #[default]
    Stop,
    /// It drives on, round the level set, until the end.
    Circle,
}

/// What robots seek that follow the gradient, as written in a scenario: `"source"`, or the table of a level.
#[derive(Clone, Debug, PartialEq)]
pub enum GradientGoalConfig {
    /// The source: where the field rises in no direction any more.
    Source,
    /// A level of the field.
    Level(GoalConfig),
}

/// How the source is written.
const SOURCE: &str = "source";

impl Serialize for GradientGoalConfig {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Source => serializer.serialize_str(SOURCE),
            Self::Level(goal) => goal.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for GradientGoalConfig {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(GoalVisitor)
    }
}

struct GoalVisitor;

impl<'de> Visitor<'de> for GoalVisitor {
    type Value = GradientGoalConfig;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"source\", or a table with `level`")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<GradientGoalConfig, E> {
        match text {
            SOURCE => Ok(GradientGoalConfig::Source),
            // By its name alone, a level has no value.
            "level" => Err(E::missing_field("level")),
            _ => Err(E::unknown_variant(text, &[SOURCE, "level"])),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<GradientGoalConfig, A::Error> {
        GoalConfig::deserialize(MapAccessDeserializer::new(map)).map(GradientGoalConfig::Level)
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for GradientGoalConfig {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "GradientGoalConfig".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let level = generator.subschema_for::<GoalConfig>();
        schemars::json_schema!({
            "description": "What robots seek that follow the gradient: the source, or a level.",
            "anyOf": [
                {
                    "description": "The source, where the field rises in no direction any more.",
                    "type": "string",
                    "const": SOURCE,
                },
                level,
            ],
        })
    }
}

/// What robots seek, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Goal {
    pub(super) field: FieldId,
    pub(super) target: Target,
    pub(super) then: AfterArrival,
    pub(super) arrivals: u32,
    pub(super) remove_within_m: Option<f64>,
}

/// Where robots want to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// Where the field has a value.
    Level(Level),
    /// Where it is highest.
    Source,
}

/// A value of a field, and when a robot has arrived there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    pub(super) value: f64,
    pub(super) tolerance: f64,
    pub(super) hold: Duration,
}

impl Goal {
    /// The value that is sought; of a source, whose value nobody knows, the `highest` one so far.
    pub(super) fn level_or(&self, highest: f64) -> f64 {
        match self.target {
            Target::Level(level) => level.value,
            Target::Source => highest,
        }
    }
}

/// Longest time of a hold (s).
const LONGEST_HOLD_S: f64 = 1e6;

impl GoalConfig {
    /// The checked form in a world with these fields.
    pub(super) fn checked(&self, fields: &[Field]) -> Result<Goal, SettingError> {
        let arrivals = self.arrivals;
        if arrivals == 0 {
            return Err(SettingError::new("arrivals", arrivals, "1 or more"));
        }
        if arrivals > 1 && self.remove_within_m.is_none() {
            let allowed =
                "1, unless `remove_within_m` says which sources a robot removes: otherwise it stays with the first";
            return Err(SettingError::new("arrivals", arrivals, allowed));
        }
        let tolerance = SettingError::not_negative("tolerance", self.tolerance)?;
        let hold_s = SettingError::in_range("hold_s", self.hold_s, 0.0, LONGEST_HOLD_S)?;
        let hold = Duration::from_secs_f64(hold_s);
        if tolerance <= 0.0 && !hold.is_zero() {
            return Err(SettingError::new("tolerance", tolerance, "a number above 0 beside `hold_s`"));
        }
        Ok(Goal {
            field: field(self.field.as_deref(), fields)?,
            target: Target::Level(Level { value: SettingError::finite("level", self.level)?, tolerance, hold }),
            then: self.then,
            arrivals,
            remove_within_m: self
                .remove_within_m
                .map(|reach_m| SettingError::positive("remove_within_m", reach_m))
                .transpose()?,
        })
    }
}

impl GradientGoalConfig {
    /// The checked form in a world with these fields.
    pub(super) fn checked(&self, fields: &[Field]) -> Result<Goal, SettingError> {
        match self {
            Self::Level(goal) => goal.checked(fields).map_err(|error| error.within("goal")),
            Self::Source if fields.len() > 1 => {
                let found = format!("\"{SOURCE}\" in a world with {} fields", fields.len());
                Err(SettingError::new("goal", found, "a table with `field` and `level`"))
            }
            Self::Source => Ok(Goal {
                field: field(None, fields).map_err(|error| error.within("goal"))?,
                target: Target::Source,
                then: AfterArrival::Stop,
                arrivals: 1,
                remove_within_m: None,
            }),
        }
    }
}

/// The field with this name, or the only one.
fn field(name: Option<&str>, fields: &[Field]) -> Result<FieldId, SettingError> {
    let names = || {
        let names: Vec<String> = fields.iter().map(|field| format!("`{}`", field.name())).collect();
        if names.is_empty() { "a field in `[[world.fields]]`".into() } else { names.join(", ") }
    };
    let index = match (name, fields) {
        (Some(name), _) => fields
            .iter()
            .position(|field| field.name() == name)
            .ok_or_else(|| SettingError::new("field", format!("`{name}`"), names()))?,
        (None, [_]) => 0,
        (None, _) => return Err(SettingError::missing("field", names())),
    };
    Ok(FieldId(u16::try_from(index).expect("at most 65536 fields")))
}

fn default_tolerance() -> f64 {
    0.1
}

fn one() -> u32 {
    1
}
