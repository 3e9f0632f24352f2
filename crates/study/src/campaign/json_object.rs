//! JSON that somebody else may have written.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use sextant_kernel::SettingError;

/// An object of a JSON file. Each key is taken once; one that nobody takes is refused.
#[derive(Debug)]
pub(super) struct JsonObject {
    /// Where it stands, for errors: empty for the file itself.
    key: String,
    entries: Map<String, Value>,
}

impl JsonObject {
    /// The object that a file is.
    pub(super) fn parse(json: &[u8]) -> Result<Self, serde_json::Error> {
        Ok(Self { key: String::new(), entries: serde_json::from_slice(json)? })
    }

    /// The value of a key, which has the form of a `T`: `allowed` in words.
    ///
    /// # Errors
    /// If it is absent, or has another form.
    pub(super) fn take<T: DeserializeOwned>(&mut self, key: &str, allowed: &str) -> Result<T, SettingError> {
        let value = self.entries.remove(key).ok_or_else(|| SettingError::missing(self.path(key), allowed))?;
        T::deserialize(&value).map_err(|_| SettingError::new(self.path(key), shown(&value), allowed))
    }

    /// The object below a key.
    ///
    /// # Errors
    /// If it is absent, or no object.
    pub(super) fn object(&mut self, key: &str) -> Result<Self, SettingError> {
        Ok(Self { entries: self.take(key, "an object")?, key: self.path(key) })
    }

    /// The objects in the array below a key.
    ///
    /// # Errors
    /// If it is absent, or no array of objects.
    pub(super) fn objects(&mut self, key: &str) -> Result<Vec<Self>, SettingError> {
        let path = self.path(key);
        let entries: Vec<Map<String, Value>> = self.take(key, "an array of objects")?;
        Ok((0..).zip(entries).map(|(i, entries)| Self { key: format!("{path}[{i}]"), entries }).collect())
    }

    /// Where a key stands in the file.
    pub(super) fn path(&self, key: &str) -> String {
        if self.key.is_empty() { key.to_owned() } else { format!("{}.{key}", self.key) }
    }

    /// Refuses keys that nobody took.
    pub(super) fn finish(self) -> Result<(), SettingError> {
        match self.entries.keys().next() {
            None => Ok(()),
            Some(key) => {
                Err(SettingError::new(self.path(&key.escape_debug().to_string()), "an unknown key", "no other keys"))
            }
        }
    }
}

/// A value as it was found.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => format!("`{}`", text.escape_debug()),
        Value::Array(_) => "an array of another kind".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::Null | Value::Bool(_) | Value::Number(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_key_from_the_top_of_the_file() {
        let object = || JsonObject::parse(br#"{"a": {"b": "x\n", "d": 1}, "c": [{"e": -1}]}"#).unwrap();
        let mut a = object().object("a").unwrap();
        let error = a.take::<u32>("b", "a number").unwrap_err().to_string();
        assert_eq!(error, r"`a.b` is `x\n`; allowed: a number");
        assert_eq!(a.finish().unwrap_err().to_string(), "`a.d` is an unknown key; allowed: no other keys");
        let mut c = object().objects("c").unwrap();
        assert_eq!(c[0].take::<u32>("e", "a number").unwrap_err().to_string(), "`c[0].e` is -1; allowed: a number");
        let missing = object().take::<u32>("f", "a number").unwrap_err();
        assert_eq!(missing.to_string(), "`f` is missing; needed: a number");
    }
}
