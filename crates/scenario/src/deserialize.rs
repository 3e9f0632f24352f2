//! Converts the tree of settings to typed settings; errors keep the path of the setting.

mod choice;
mod refused;

use std::collections::btree_map;
use std::fmt;

use serde::de::value::{SeqDeserializer, StrDeserializer};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;

use super::document::key_path::{KeyPath, PathStep};
use super::document::{Document, Entry, Placeholder, Table, Value};
use super::error::ScenarioError;
use super::refusal::Refusal;
use choice::{Choice, choice, names};
use refused::{Refused, array_of, found};

/// The settings of `document` as a `T`.
pub(crate) fn deserialize<T: DeserializeOwned>(document: &Document) -> Result<T, ScenarioError> {
    read(document).map_err(|(refusal, path)| document.refused(&path, &refusal))
}

/// The settings of `document` as a `T`, or the first error and its path.
pub(super) fn read<T: DeserializeOwned>(document: &Document) -> Result<T, (Refusal, KeyPath)> {
    T::deserialize(Reader(&document.root.value)).map_err(|Refused(refused)| {
        let (refusal, mut steps) = *refused;
        steps.reverse();
        (refusal, KeyPath(steps))
    })
}

/// The table without settings.
static NOTHING: Table = Table::new();

/// A value to deserialize.
///
/// Each method reads only one kind of value. A method for all kinds would be compiled for each type of setting, and be
/// most of the program.
#[derive(Clone, Copy)]
struct Reader<'a>(&'a Value);

impl<'a> Reader<'a> {
    /// The error that the value is not what is `allowed`.
    fn unfit(self, allowed: &str) -> Refused {
        let found = match self.0 {
            Value::Boolean(value) => found(Unexpected::Bool(*value)),
            Value::Integer(value) => format!("the integer {value}"),
            Value::Float(value) => found(Unexpected::Float(*value)),
            Value::String(text) => found(Unexpected::Str(text)),
            Value::Datetime(text) => format!("the date {text}"),
            Value::Array(_) => found(Unexpected::Seq),
            Value::Table(_) => found(Unexpected::Map),
            Value::Placeholder(_) => "a value that was rejected".to_owned(),
        };
        Refusal::Unfit { found, expected: allowed.to_owned() }.into()
    }

    fn integer<T: TryFrom<i128>>(self, allowed: &str) -> Result<T, Refused> {
        match self.0 {
            Value::Integer(integer) => T::try_from(*integer).map_err(|_| self.unfit(allowed)),
            Value::Placeholder(placeholder) => T::try_from(number_for(*placeholder)).map_err(|_| self.unfit(allowed)),
            _ => Err(self.unfit(allowed)),
        }
    }

    fn number(self) -> Result<f64, Refused> {
        match self.0 {
            Value::Float(float) => Ok(*float),
            Value::Integer(integer) => Ok(*integer as f64),
            Value::Placeholder(placeholder) => Ok(number_for(*placeholder) as f64),
            _ => Err(self.unfit("a number")),
        }
    }

    fn text(self) -> Result<&'a str, Refused> {
        match self.0 {
            Value::String(text) => Ok(text),
            Value::Placeholder(_) => Ok("placeholder"),
            _ => Err(self.unfit("a text in quotes")),
        }
    }

    fn items(self) -> Result<Items<'a>, Refused> {
        match self.0 {
            Value::Array(entries) => Ok(Items { entries, read: 0 }),
            Value::Placeholder(_) => Ok(Items { entries: &[], read: 0 }),
            _ => Err(self.unfit("an array")),
        }
    }

    fn settings(self) -> Result<Settings<'a>, Refused> {
        match self.0 {
            Value::Table(table) => Ok(Settings { rest: table.iter(), current: None }),
            Value::Placeholder(_) => Ok(Settings { rest: NOTHING.iter(), current: None }),
            _ => Err(self.unfit("a table")),
        }
    }
}

/// Methods that read whole numbers of one type.
macro_rules! integers {
    ($($method:ident $visit:ident $allowed:literal,)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
            visitor.$visit(self.integer($allowed)?)
        }
    )*};
}

impl<'de> Deserializer<'de> for Reader<'_> {
    type Error = Refused;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        match self.0 {
            Value::Boolean(boolean) => visitor.visit_bool(*boolean),
            Value::Integer(integer) => match i64::try_from(*integer) {
                Ok(signed) => visitor.visit_i64(signed),
                Err(_) => visitor.visit_u64(self.integer("a whole number of 64 bits")?),
            },
            Value::Float(float) => visitor.visit_f64(*float),
            Value::String(text) => visitor.visit_str(text),
            Value::Datetime(_) => Err(self.unfit(&Expectation(visitor).to_string())),
            Value::Array(_) => self.deserialize_seq(visitor),
            Value::Table(_) => self.deserialize_map(visitor),
            // Only places are read like this.
            Value::Placeholder(placeholder) => {
                let coordinates = [number_for(*placeholder) as f64; 3];
                visitor.visit_seq(SeqDeserializer::new(coordinates.into_iter()))
            }
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        match self.0 {
            Value::Boolean(boolean) => visitor.visit_bool(*boolean),
            Value::Placeholder(placeholder) => visitor.visit_bool(*placeholder == Placeholder::Large),
            _ => Err(self.unfit("true or false")),
        }
    }

    integers! {
        deserialize_u8 visit_u8 "a whole number, 0 to 255",
        deserialize_u16 visit_u16 "a whole number, 0 to 65535",
        deserialize_u32 visit_u32 "a whole number, 0 to 4294967295",
        deserialize_u64 visit_u64 "a whole number, 0 or above",
        deserialize_i8 visit_i8 "a whole number, -128 to 127",
        deserialize_i16 visit_i16 "a whole number, -32768 to 32767",
        deserialize_i32 visit_i32 "a whole number, -2147483648 to 2147483647",
        deserialize_i64 visit_i64 "a whole number",
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_str(self.text()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_str(self.text()?)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        let mut items = self.items()?;
        let value = visitor.visit_seq(&mut items)?;
        items.end()?;
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Refused> {
        match self.0 {
            Value::Placeholder(_) => visitor.visit_seq(Repeated { value: self.0, left: length }),
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_map(self.settings()?)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        visitor.visit_map(self.settings()?)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Refused> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        match self.0 {
            Value::String(name) => visitor.visit_enum(Choice { name, content: None }),
            Value::Table(table) => visitor.visit_enum(choice(table, variants)?),
            Value::Placeholder(_) => {
                let name = variants.first().copied().unwrap_or_default();
                visitor.visit_enum(Choice { name, content: Some(self.0) })
            }
            _ => Err(self.unfit(&format!("one of {}", names(variants.iter().copied())))),
        }
    }

    forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

/// The items of an array.
struct Items<'a> {
    entries: &'a [Entry],
    /// Number of items read.
    read: usize,
}

impl Items<'_> {
    /// Rejects items that were not read.
    fn end(&self) -> Result<(), Refused> {
        if self.read == self.entries.len() {
            return Ok(());
        }
        Err(Refusal::Unfit { found: array_of(self.entries.len()), expected: array_of(self.read) }.into())
    }
}

impl<'de> SeqAccess<'de> for Items<'_> {
    type Error = Refused;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Refused> {
        let Some(entry) = self.entries.get(self.read) else {
            return Ok(None);
        };
        let index = self.read;
        self.read += 1;
        seed.deserialize(Reader(&entry.value)).map(Some).map_err(|refused| refused.below(PathStep::Index(index)))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.entries.len() - self.read)
    }
}

/// The keys of a table and their values.
struct Settings<'a> {
    rest: btree_map::Iter<'a, String, Entry>,
    /// The setting whose key was read last.
    current: Option<(&'a String, &'a Entry)>,
}

impl<'de> MapAccess<'de> for Settings<'_> {
    type Error = Refused;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Refused> {
        self.current = self.rest.find(|(_, entry)| !matches!(entry.value, Value::Placeholder(Placeholder::Absent)));
        let Some((key, _)) = self.current else {
            return Ok(None);
        };
        let name: StrDeserializer<'_, Refused> = key.as_str().into_deserializer();
        seed.deserialize(name).map(Some).map_err(|refused| refused.below(PathStep::Key(key.clone())))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Refused> {
        let (key, entry) = self.current.expect("a value is read after its key");
        seed.deserialize(Reader(&entry.value)).map_err(|refused| refused.below(PathStep::Key(key.clone())))
    }
}

/// The number that stands for a value.
fn number_for(placeholder: Placeholder) -> i128 {
    if placeholder == Placeholder::Large { 100 } else { 1 }
}

/// The same value several times.
struct Repeated<'a> {
    value: &'a Value,
    left: usize,
}

impl<'de> SeqAccess<'de> for Repeated<'_> {
    type Error = Refused;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Refused> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(Reader(self.value)).map(Some)
    }
}

/// What a visitor expects, as text.
struct Expectation<V>(V);

impl<'de, V: Visitor<'de>> fmt::Display for Expectation<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }
}
