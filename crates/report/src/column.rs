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

    /// The name of the type and how it is written, and the octets: numbers in as few as hold them all.
    fn octets(&self) -> (&'static str, Vec<u8>) {
        match self {
            Self::F32(numbers) => match as_small(numbers) {
                Some(octets) => ("f32_in_i8", octets),
                None => ("f32", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
            },
            Self::F64(numbers) => ("f64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
            Self::U32(numbers) => {
                if let Some(octets) = numbers.iter().map(|&number| u8::try_from(number).ok()).collect() {
                    return ("u32_in_u8", octets);
                }
                let halves: Option<Vec<u16>> = numbers.iter().map(|&number| u16::try_from(number).ok()).collect();
                match halves {
                    Some(halves) => ("u32_in_u16", halves.iter().flat_map(|number| number.to_le_bytes()).collect()),
                    None => ("u32", numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
                }
            }
            Self::U8(numbers) => ("u8", numbers.clone()),
        }
    }
}

/// What stands for NaN among small whole numbers.
const NOT_A_NUMBER: i8 = i8::MIN;

/// Whole numbers from -127 to 127, such as strengths in dBm, one octet each; `None` if others are among them.
#[expect(clippy::cast_possible_truncation, reason = "the number is whole and small")]
fn as_small(numbers: &[f32]) -> Option<Vec<u8>> {
    let small = |number: f32| match number {
        _ if number.is_nan() => Some(NOT_A_NUMBER),
        _ if number.abs() <= 127.0 && number.fract() == 0.0 => Some(number as i8),
        _ => None,
    };
    numbers.iter().map(|&number| small(number).map(i8::cast_unsigned)).collect()
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
        // 1.5 as a float of four octets is 00 00 c0 3f (IEEE 754), and 65794 is 02 01 01 00.
        let json = |column: &Column| serde_json::to_string(column).expect("a column is JSON");
        assert_eq!(json(&Column::reals([1.5])), r#"{"f32":"AADAPw=="}"#);
        assert_eq!(json(&Column::U32(vec![0x0001_0102])), r#"{"u32":"AgEBAA=="}"#);
        assert_eq!(json(&Column::U8(vec![7])), r#"{"u8":"Bw=="}"#);
        assert_eq!(json(&Column::F64(vec![1.0])), r#"{"f64":"AAAAAAAA8D8="}"#);
    }

    #[test]
    fn small_numbers_take_few_octets() {
        let written = |column: Column| column.octets();
        assert_eq!(written(Column::U32(vec![7, 255])), ("u32_in_u8", vec![7, 255]));
        assert_eq!(written(Column::U32(vec![7, 258])), ("u32_in_u16", vec![7, 0, 2, 1]));
        assert_eq!(written(Column::reals([-90.0, f64::NAN, 3.0])), ("f32_in_i8", vec![166, 128, 3]));
        assert_eq!(written(Column::reals([-90.5])).0, "f32");
        assert_eq!(written(Column::reals([-128.0])).0, "f32", "that octet stands for NaN");
    }
}
