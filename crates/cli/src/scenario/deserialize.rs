//! From the tree of settings to the types that describe them, with refusals that can be explained.

use std::fmt;

use serde::de::value::{MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Expected, IntoDeserializer, Unexpected,
    VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use serde_path_to_error::Segment;

use super::document::{Document, Entry, Table, Value};
use super::error::ScenarioError;
use super::key_path::{KeyPath, Step};
use super::refusal::Refusal;

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownField { field, .. } => write!(f, "unknown key `{field}`"),
            Self::UnknownVariant { variant, .. } => write!(f, "unknown choice `{variant}`"),
            Self::MissingField(field) => write!(f, "`{field}` is missing"),
            Self::Unfit { found, expected } => write!(f, "{found}; allowed: {expected}"),
            Self::Other(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for Refusal {}

impl de::Error for Refusal {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::Unfit { found: found(unexpected), expected: wanted(&expected.to_string()) }
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::Unfit { found: format!("an array of {length}"), expected: expected.to_string() }
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::UnknownVariant { variant: variant.to_owned(), expected }
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::UnknownField { field: field.to_owned(), expected }
    }

    fn missing_field(field: &'static str) -> Self {
        Self::MissingField(field)
    }
}

/// What was found, in the words of a person who writes TOML.
fn found(unexpected: Unexpected<'_>) -> String {
    match unexpected {
        Unexpected::Bool(value) => format!("the boolean {value}"),
        Unexpected::Unsigned(value) => format!("the integer {value}"),
        Unexpected::Signed(value) => format!("the integer {value}"),
        Unexpected::Float(value) => format!("the number {value}"),
        Unexpected::Str(value) => format!("the text \"{value}\""),
        Unexpected::Seq => "an array".to_owned(),
        Unexpected::Map => "a table".to_owned(),
        other => other.to_string(),
    }
}

/// What was wanted, in the same words; serde speaks of Rust types.
fn wanted(expected: &str) -> String {
    match expected {
        "u8" => "a whole number, 0 to 255",
        "u16" => "a whole number, 0 to 65535",
        "u32" => "a whole number, 0 to 4294967295",
        "u64" | "usize" => "a whole number, 0 or above",
        "i8" | "i16" | "i32" | "i64" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a string" | "path string" => "a text in quotes",
        "a sequence" => "an array",
        "a map" => "a table",
        _ if expected.starts_with("struct ") => "a table",
        _ if expected.starts_with("enum ") || expected.ends_with("enum") => {
            "the name of a choice, or a table with one"
        }
        _ => expected,
    }
    .to_owned()
}

/// The settings of `document` as a `T`.
pub(crate) fn deserialize<T: DeserializeOwned>(document: &Document) -> Result<T, ScenarioError> {
    serde_path_to_error::deserialize(Reader(&document.root)).map_err(|error| {
        let steps = error.path().iter().filter_map(|segment| match segment {
            Segment::Seq { index } => Some(Step::Index(*index)),
            Segment::Map { key } => Some(Step::Key(key.clone())),
            Segment::Enum { variant } => Some(Step::Key(variant.clone())),
            Segment::Unknown => None,
        });
        document.refused(&KeyPath(steps.collect()), error.inner())
    })
}

/// An entry, ready to be read.
#[derive(Clone, Copy)]
struct Reader<'a>(&'a Entry);

impl<'de> Deserializer<'de> for Reader<'_> {
    type Error = Refusal;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        match &self.0.value {
            Value::Boolean(boolean) => visitor.visit_bool(*boolean),
            Value::Integer(integer) => match (i64::try_from(*integer), u64::try_from(*integer)) {
                (Ok(signed), _) => visitor.visit_i64(signed),
                (_, Ok(unsigned)) => visitor.visit_u64(unsigned),
                _ => Err(Refusal::Other("this integer does not fit into 64 bits".to_owned())),
            },
            Value::Float(float) => visitor.visit_f64(*float),
            Value::String(text) => visitor.visit_str(text),
            Value::Datetime(text) => Err(Refusal::Unfit {
                found: format!("the date {text}"),
                expected: wanted(&Expectation(visitor).to_string()),
            }),
            Value::Array(items) => {
                let mut items = SeqDeserializer::new(items.iter().map(Reader));
                let value = visitor.visit_seq(&mut items)?;
                items.end()?;
                Ok(value)
            }
            Value::Table(table) => {
                let entries = table.iter().map(|(key, entry)| (key.as_str(), Reader(entry)));
                visitor.visit_map(MapDeserializer::new(entries))
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refusal> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        match &self.0.value {
            Value::String(name) => visitor.visit_enum(Choice { name, content: None }),
            Value::Table(table) => visitor.visit_enum(choice(table, variants)?),
            _ => self.deserialize_any(visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Refusal> for Reader<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// The one choice that a table makes. A choice of a later layer replaces that of an earlier one.
fn choice<'a>(table: &'a Table, variants: &'static [&'static str]) -> Result<Choice<'a>, Refusal> {
    let latest = table.values().map(|entry| entry.layer).max();
    let mut chosen = table.iter().filter(|(_, entry)| Some(entry.layer) == latest);
    match (chosen.next(), chosen.next()) {
        (Some((name, entry)), None) => Ok(Choice { name, content: Some(entry) }),
        (None, _) => Err(Refusal::Unfit {
            found: "an empty table".to_owned(),
            expected: format!("a table with one of {}", names(variants.iter().copied())),
        }),
        (Some(_), Some(_)) => {
            // An unknown name among several is the likelier mistake.
            if let Some(name) = table.keys().find(|name| !variants.contains(&name.as_str())) {
                return Err(de::Error::unknown_variant(name, variants));
            }
            Err(Refusal::Other(format!("{} exclude each other: keep one", names(table.keys().map(String::as_str)))))
        }
    }
}

fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A variant by name, with its content if it was written as a table.
struct Choice<'a> {
    name: &'a str,
    content: Option<&'a Entry>,
}

impl<'de, 'a> EnumAccess<'de> for Choice<'a> {
    type Error = Refusal;
    type Variant = Content<'a>;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Content<'a>), Refusal> {
        let name: StrDeserializer<'_, Refusal> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, Content { name: self.name, content: self.content }))
    }
}

struct Content<'a> {
    name: &'a str,
    content: Option<&'a Entry>,
}

impl<'a> Content<'a> {
    fn reader(&self) -> Result<Reader<'a>, Refusal> {
        self.content.map(Reader).ok_or_else(|| Refusal::Unfit {
            found: format!("the text \"{}\"", self.name),
            expected: format!("a table `{}` with its settings", self.name),
        })
    }
}

impl<'de> VariantAccess<'de> for Content<'_> {
    type Error = Refusal;

    fn unit_variant(self) -> Result<(), Refusal> {
        match self.content.map(|entry| &entry.value) {
            None => Ok(()),
            Some(Value::Table(table)) => match table.keys().next() {
                None => Ok(()),
                Some(key) => Err(de::Error::unknown_field(key, &[])),
            },
            Some(_) => Err(Refusal::Other(format!("`{}` takes no settings", self.name))),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Refusal> {
        if self.content.is_none() {
            // `mac = "csma_unslotted"` means the defaults, if all settings have one.
            let nothing = std::iter::empty::<(&str, Reader<'_>)>();
            return seed.deserialize(MapDeserializer::new(nothing));
        }
        seed.deserialize(self.reader()?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value, Refusal> {
        self.reader()?.deserialize_any(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refusal> {
        match self.content {
            Some(entry) => Reader(entry).deserialize_any(visitor),
            None => visitor.visit_map(MapDeserializer::new(std::iter::empty::<(&str, Reader<'_>)>())),
        }
    }
}

/// A visitor's expectation as text.
struct Expectation<V>(V);

impl<'de, V: Visitor<'de>> fmt::Display for Expectation<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }
}
