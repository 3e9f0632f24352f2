//! The fields of a message that can be read.

use sextant_kernel::text::choices;

use super::definition::{Definitions, Extent, FieldKind, MessageField, Number};
use super::field_path::{Element, FieldPath, FieldStep};

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Integer,
    Real,
    Text,
    /// A list of octets.
    Octets,
    Instant,
}

impl Content {
    /// What it is, for an error.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Integer => "an integer",
            Self::Real => "a real number",
            Self::Text => "a string",
            Self::Octets => "a list of octets",
            Self::Instant => "a time",
        }
    }

    /// The content of `field` if its value is taken as a whole, or one of its values if `is_element`; `None` if that is a
    /// message, a list or cannot be read.
    pub(super) fn of(field: &MessageField, is_element: bool) -> Option<Self> {
        let is_list = field.extent != Extent::One && !is_element;
        match field.kind {
            FieldKind::Number(Number::UInt8 | Number::Int8) if is_list => Some(Self::Octets),
            _ if is_list => None,
            FieldKind::Number(Number::Float32 | Number::Float64) => Some(Self::Real),
            FieldKind::Number(_) => Some(Self::Integer),
            FieldKind::Text => Some(Self::Text),
            FieldKind::Instant => Some(Self::Instant),
            FieldKind::WideText | FieldKind::Message(_) => None,
        }
    }
}

/// A field that can be read, with its path. A list of messages stands for each of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Leaf {
    pub(super) path: FieldPath,
    pub(super) content: Content,
    /// Its type as written.
    type_text: String,
}

/// All fields that can be read.
pub(super) fn leaves(definitions: &Definitions) -> Vec<Leaf> {
    let mut found = Vec::new();
    gather(definitions, Definitions::WHOLE, &mut Vec::new(), &mut found);
    found
}

fn gather(definitions: &Definitions, message: usize, outer: &mut Vec<FieldStep>, found: &mut Vec<Leaf>) {
    let has_list = outer.iter().any(|step| step.element == Element::Each);
    for field in definitions.fields(message) {
        let content = Content::of(field, false);
        let each = content.is_none() && field.extent != Extent::One;
        if each && has_list {
            continue;
        }
        let element = if each { Element::Each } else { Element::Whole };
        outer.push(FieldStep { name: field.name.clone(), element });
        match (field.kind, content.or_else(|| Content::of(field, each))) {
            (FieldKind::Message(inner), _) => gather(definitions, inner, outer, found),
            (_, Some(content)) => {
                found.push(Leaf { path: FieldPath(outer.clone()), content, type_text: field.type_text.clone() });
            }
            _ => {}
        }
        outer.pop();
    }
}

/// The fields that can be read, for an error.
pub(super) fn listing(definitions: &Definitions) -> String {
    let leaves = leaves(definitions);
    let fields: Vec<_> = leaves.iter().map(|leaf| format!("{} ({})", leaf.path, leaf.type_text)).collect();
    choices(&fields)
}

#[cfg(test)]
mod tests {
    use super::super::definition::Dialect;
    use super::*;

    #[test]
    fn the_fields_that_can_be_read_are_listed_with_their_paths() {
        let text = "builtin_interfaces/Time stamp\nBeacon[] beacons\nfloat32[3] xyz\nuint8[6] mac\nwstring w\n\
            ===\nMSG: radio/Beacon\nstring id\nint8 rssi\nfloat32[] profile\n";
        let definitions = Definitions::parse(Dialect::Ros2, "radio/msg/Heard", text).unwrap();
        assert_eq!(
            listing(&definitions),
            "stamp (builtin_interfaces/Time), beacons[].id (string), beacons[].rssi (int8), xyz[] (float32[3]), \
             mac (uint8[6])"
        );
    }
}
