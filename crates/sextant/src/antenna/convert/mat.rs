//! MATLAB files of level 5 (The MathWorks, "MAT-File Format", 2019), as far as measurements need them: real arrays of
//! numbers, also in structures, compressed or not.

use std::collections::BTreeMap;
use std::io::Read as _;

use flate2::read::ZlibDecoder;

use super::ConvertError;

/// An array of numbers; the first dimension runs fastest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array {
    pub(super) dimensions: Vec<usize>,
    pub(super) values: Vec<f64>,
}

/// Octets of the header.
const HEADER: usize = 128;
/// Most octets that a compressed variable may have.
const MOST_OCTETS: u64 = 1 << 28;
/// Most structures in one another.
const MOST_DEPTH: u8 = 4;
/// Types of elements (table 1-1).
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays (table 1-3).
const STRUCTURE: u32 = 2;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;
/// The flag of arrays with an imaginary part.
const COMPLEX: u32 = 0x0800;

/// The arrays of numbers in a file, by name; a field of a structure is `name.field`. Other variables are left out.
///
/// # Errors
/// If the file is damaged, or of another level.
pub(super) fn read(octets: &[u8]) -> Result<BTreeMap<String, Array>, ConvertError> {
    if octets.starts_with(b"MATLAB 7.3") {
        return Err(flaw("has version 7.3; allowed: versions 5 to 7.2 (`save` with `-v7`)"));
    }
    let is_big = match octets.get(HEADER - 2..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(flaw("has no header of level 5")),
    };
    let mut variables = BTreeMap::new();
    let mut cursor = Cursor { rest: &octets[HEADER..], is_big };
    while let Some(Element { kind, data }) = cursor.next()? {
        match kind {
            COMPRESSED => {
                let mut unpacked = Vec::new();
                let read = ZlibDecoder::new(data).take(MOST_OCTETS).read_to_end(&mut unpacked);
                read.map_err(|_| flaw("has a variable that cannot be decompressed"))?;
                let mut inner = Cursor { rest: &unpacked, is_big };
                if let Some(Element { kind: MATRIX, data }) = inner.next()? {
                    matrix(Cursor { rest: data, is_big }, "", 0, &mut variables)?;
                }
            }
            MATRIX => matrix(Cursor { rest: data, is_big }, "", 0, &mut variables)?,
            _ => {}
        }
    }
    Ok(variables)
}

fn flaw(text: &str) -> ConvertError {
    ConvertError::Mat(text.to_owned())
}

fn cut() -> ConvertError {
    flaw("ends within a variable")
}

/// An element: its type and its octets.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

/// What is left of a sequence of elements.
#[derive(Clone, Copy)]
struct Cursor<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl<'a> Cursor<'a> {
    fn word(&self, octets: [u8; 4]) -> u32 {
        if self.is_big { u32::from_be_bytes(octets) } else { u32::from_le_bytes(octets) }
    }

    /// The next element; `None` at the end.
    fn next(&mut self) -> Result<Option<Element<'a>>, ConvertError> {
        let Some((&tag, rest)) = self.rest.split_first_chunk::<4>() else {
            return if self.rest.is_empty() { Ok(None) } else { Err(cut()) };
        };
        let tag = self.word(tag);
        // Up to four octets stand in the tag itself.
        if tag >> 16 != 0 {
            let size = (tag >> 16) as usize;
            let kept = rest.get(..size.min(4)).ok_or_else(cut)?;
            self.rest = rest.get(4..).unwrap_or_default();
            return if size > 4 { Err(cut()) } else { Ok(Some(Element { kind: tag & 0xFFFF, data: kept })) };
        }
        let (&size, rest) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
        let size = self.word(size) as usize;
        let data = rest.get(..size).ok_or_else(cut)?;
        // Elements begin at multiples of eight octets, but for compressed ones.
        let padded = if tag == COMPRESSED { size } else { size.next_multiple_of(8) };
        self.rest = rest.get(padded.min(rest.len())..).unwrap_or_default();
        Ok(Some(Element { kind: tag, data }))
    }

    /// The next element, which there must be.
    fn expect(&mut self) -> Result<Element<'a>, ConvertError> {
        self.next()?.ok_or_else(cut)
    }

    /// The numbers of an element.
    fn numbers(&self, Element { kind, data }: &Element<'a>) -> Result<Vec<f64>, ConvertError> {
        macro_rules! read {
            ($type:ty, $size:literal) => {
                data.chunks_exact($size)
                    .map(|octets| {
                        let octets: [u8; $size] = octets.try_into().unwrap_or_default();
                        let value =
                            if self.is_big { <$type>::from_be_bytes(octets) } else { <$type>::from_le_bytes(octets) };
                        value as f64
                    })
                    .collect()
            };
        }
        Ok(match kind {
            1 => read!(i8, 1),
            2 => read!(u8, 1),
            3 => read!(i16, 2),
            4 => read!(u16, 2),
            &INT32 => read!(i32, 4),
            &UINT32 => read!(u32, 4),
            7 => read!(f32, 4),
            9 => read!(f64, 8),
            12 => read!(i64, 8),
            13 => read!(u64, 8),
            other => {
                return Err(ConvertError::Mat(format!("has numbers of type {other}; allowed: 1 to 7, 9, 12, 13")));
            }
        })
    }
}

/// Adds the arrays of one matrix to `variables`: an array of numbers, or those of a structure with one place.
fn matrix(
    mut content: Cursor<'_>,
    owner: &str,
    depth: u8,
    variables: &mut BTreeMap<String, Array>,
) -> Result<(), ConvertError> {
    // An empty place of a structure.
    let Some(flags) = content.next()? else { return Ok(()) };
    let flags = flags.data.first_chunk::<4>().map(|&octets| content.word(octets)).ok_or_else(cut)?;
    let (class, is_complex) = (flags & 0xFF, flags & COMPLEX != 0);
    let dimensions = content.expect()?;
    let dimensions: Vec<usize> = content.numbers(&dimensions)?.into_iter().map(whole).collect();
    let name = content.expect()?;
    let own = String::from_utf8_lossy(name.data).trim_end_matches('\0').to_owned();
    let name = match (owner, own.as_str()) {
        ("", own) => own.to_owned(),
        (owner, _) => owner.to_owned(),
    };
    let count = dimensions.iter().try_fold(1_usize, |count, &length| count.checked_mul(length)).ok_or_else(cut)?;
    if NUMBERS.contains(&class) && !is_complex {
        let numbers = content.expect()?;
        let values = content.numbers(&numbers)?;
        if values.len() != count {
            return Err(ConvertError::Mat(format!(
                "has {} numbers in `{name}`, whose dimensions give {count}",
                values.len()
            )));
        }
        variables.insert(name, Array { dimensions, values });
    } else if class == STRUCTURE && count == 1 && depth < MOST_DEPTH {
        let width = content.expect()?;
        let width = content.numbers(&width)?.first().copied().map_or(0, whole);
        let fields = content.expect()?;
        for field in fields.data.chunks(width.max(1)) {
            let letters = field.split(|&letter| letter == 0).next().unwrap_or_default();
            let inner = content.expect()?;
            if inner.kind == MATRIX {
                let path = format!("{name}.{}", String::from_utf8_lossy(letters));
                matrix(Cursor { rest: inner.data, ..content }, &path, depth + 1, variables)?;
            }
        }
    }
    Ok(())
}

/// A length; numbers that are none count as 0.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to lengths of arrays")]
fn whole(value: f64) -> usize {
    value.clamp(0.0, 1e9) as usize
}
