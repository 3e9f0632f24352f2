//! Choices: a name, or a table with one key and its settings.

use serde::de::value::StrDeserializer;
use serde::de::{self, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, VariantAccess, Visitor};

use super::Reader;
use super::refused::Refused;
use crate::document::key_path::PathStep;
use crate::document::{Table, Value};
use crate::refusal::Refusal;

/// The empty table that a choice by name alone means.
static NOTHING: Value = Value::Table(Table::new());

/// The choice in a table. The choice of a later layer replaces that of an earlier one.
pub(super) fn choice<'a>(table: &'a Table, variants: &'static [&'static str]) -> Result<Choice<'a>, Refused> {
    let latest = table.values().map(|entry| entry.layer).max();
    let mut chosen = table.iter().filter(|(_, entry)| Some(entry.layer) == latest);
    match (chosen.next(), chosen.next()) {
        (Some((name, entry)), None) => Ok(Choice { name, content: Some(&entry.value) }),
        (None, _) => Err(Refusal::Unfit {
            found: "an empty table".to_owned(),
            expected: format!("a table with one of {}", names(variants.iter().copied())),
        }
        .into()),
        (Some(_), Some(_)) => {
            // If one of several names is unknown, it is the more likely mistake.
            if let Some(name) = table.keys().find(|name| !variants.contains(&name.as_str())) {
                return Err(de::Error::unknown_variant(name, variants));
            }
            Err(Refusal::SeveralChoices(table.keys().cloned().collect()).into())
        }
    }
}

/// Names as a list in a message.
pub(super) fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A variant by name, with its content if it was written as a table.
pub(super) struct Choice<'a> {
    pub(super) name: &'a str,
    pub(super) content: Option<&'a Value>,
}

impl Choice<'_> {
    /// Adds the variant to the path of an error.
    fn below(&self, refused: Refused) -> Refused {
        refused.below(PathStep::Key(self.name.to_owned()))
    }

    /// The content; an empty table for a name alone. So `mac = "csma_unslotted"` means the default settings.
    fn reader(&self) -> Reader<'_> {
        Reader(self.content.unwrap_or(&NOTHING))
    }

    /// Rejects any settings.
    fn without_settings(&self) -> Result<(), Refused> {
        match self.content {
            None => Ok(()),
            Some(Value::Table(table)) => match table.keys().next() {
                None => Ok(()),
                Some(key) => Err(de::Error::unknown_field(key, &[])),
            },
            Some(Value::Placeholder(_)) => Ok(()),
            Some(_) => Err(Refusal::Other(format!("`{}` takes no settings", self.name)).into()),
        }
    }
}

impl<'de> EnumAccess<'de> for Choice<'_> {
    type Error = Refused;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Self), Refused> {
        let name: StrDeserializer<'_, Refused> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'de> VariantAccess<'de> for Choice<'_> {
    type Error = Refused;

    fn unit_variant(self) -> Result<(), Refused> {
        self.without_settings().map_err(|refused| self.below(refused))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Refused> {
        seed.deserialize(self.reader()).map_err(|refused| self.below(refused))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value, Refused> {
        self.reader().deserialize_seq(visitor).map_err(|refused| self.below(refused))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        self.reader().deserialize_map(visitor).map_err(|refused| self.below(refused))
    }
}
