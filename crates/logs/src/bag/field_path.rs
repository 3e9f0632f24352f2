//! The path of a field in a message: `header.stamp`, `radios[0].rssi`, `beacons[].address`.

use std::fmt;

/// A step of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FieldStep {
    pub(crate) name: String,
    pub(crate) element: Element,
}

/// Which of the values of a field are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    /// The only one, or all of a list of octets.
    Whole,
    /// One of a list, from 0.
    At(usize),
    /// Each of a list.
    Each,
}

/// The path of a field in a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FieldPath(pub(crate) Vec<FieldStep>);

impl FieldPath {
    /// Reads `NAME`, `NAME[INDEX]` or `NAME[]`, joined by points.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let invalid = || {
            format!(
                "`{text}` is not the path of a field; allowed: names joined by points, with `[]` for each value of a list and `[2]` for one"
            )
        };
        let step = |part: &str| {
            let (name, element) = match part.split_once('[') {
                None => (part, Element::Whole),
                Some((name, "]")) => (name, Element::Each),
                Some((name, index)) => (
                    name,
                    Element::At(index.strip_suffix(']').and_then(|index| index.parse().ok()).ok_or_else(invalid)?),
                ),
            };
            let is_name = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
            if is_name { Ok(FieldStep { name: name.to_owned(), element }) } else { Err(invalid()) }
        };
        text.split('.').map(step).collect::<Result<_, _>>().map(Self)
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, FieldStep { name, element }) in self.0.iter().enumerate() {
            let point = if index == 0 { "" } else { "." };
            write!(f, "{point}{name}")?;
            match element {
                Element::Whole => {}
                Element::At(at) => write!(f, "[{at}]")?,
                Element::Each => f.write_str("[]")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_written_as_it_is_read() {
        for text in ["rssi", "header.stamp", "radios[2].rssi", "beacons[].id"] {
            assert_eq!(FieldPath::parse(text).unwrap().to_string(), text);
        }
        for text in ["", "a..b", "a[", "a[x]", "a[-1]", "a b", "[]"] {
            assert!(FieldPath::parse(text).unwrap_err().starts_with(&format!("`{text}` is not the path")), "{text}");
        }
    }
}
