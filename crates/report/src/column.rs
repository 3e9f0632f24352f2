//! Columns of numbers, which a browser reads as typed arrays.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Numbers of one type. In the file they are base64 of little-endian octets.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Real numbers with seven digits; NaN where there is none.
    F32(Vec<f32>),
    /// Real numbers with all digits; NaN where there is none.
    F64(Vec<f64>),
    /// Counts and indices.
    U32(Vec<u32>),
    /// Small numbers.
    U8(Vec<u8>),
}

impl Column {
    /// Real numbers, rounded to seven digits.
    #[expect(clippy::cast_possible_truncation, reason = "seven digits are enough for a picture and its labels")]
    pub(super) fn reals(numbers: impl IntoIterator<Item = f64>) -> Self {
        Self::F32(numbers.into_iter().map(|number| number as f32).collect())
    }

    /// How many numbers it has.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(numbers) => numbers.len(),
            Self::F64(numbers) => numbers.len(),
            Self::U32(numbers) => numbers.len(),
            Self::U8(numbers) => numbers.len(),
        }
    }

    /// Whether it has no numbers.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Its numbers.
    #[must_use]
    pub fn to_vec(&self) -> Vec<f64> {
        match self {
            Self::F32(numbers) => numbers.iter().copied().map(f64::from).collect(),
            Self::F64(numbers) => numbers.clone(),
            Self::U32(numbers) => numbers.iter().copied().map(f64::from).collect(),
            Self::U8(numbers) => numbers.iter().copied().map(f64::from).collect(),
        }
    }

    /// The name of the type, and the octets.
    fn octets(&self) -> (&'static str, Vec<u8>) {
        match self {
            Self::F32(numbers) => ("f32", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
            Self::F64(numbers) => ("f64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
            Self::U32(numbers) => ("u32", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
            Self::U8(numbers) => ("u8", numbers.clone()),
        }
    }
}

impl Serialize for Column {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (kind, octets) = self.octets();
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(kind, &STANDARD.encode(octets))?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octets_are_little_endian() {
        // 1.0 as a float of four octets is 00 00 80 3f (IEEE 754), and 258 is 02 01 00 00.
        let json = |column: &Column| serde_json::to_string(column).expect("a column is JSON");
        assert_eq!(json(&Column::reals([1.0])), r#"{"f32":"AACAPw=="}"#);
        assert_eq!(json(&Column::U32(vec![258])), r#"{"u32":"AgEAAA=="}"#);
        assert_eq!(json(&Column::U8(vec![7])), r#"{"u8":"Bw=="}"#);
        assert_eq!(json(&Column::F64(vec![1.0])), r#"{"f64":"AAAAAAAA8D8="}"#);
    }
}
