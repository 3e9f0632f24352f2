//! Descriptors of Sextant's message types. They are embedded in each recording, so that any reader can decode it.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet, OneofDescriptorProto,
};

/// A message type: its name in the package `sextant`, and its fields.
pub(crate) struct Declaration {
    pub(crate) name: &'static str,
    pub(crate) fields: &'static [Field],
}

/// A field with its stable number.
pub(crate) struct Field {
    pub(crate) name: &'static str,
    pub(crate) number: i32,
    pub(crate) kind: FieldKind,
}

/// The type of a field.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum FieldKind {
    Uint32,
    OptionalUint32,
    Uint32s,
    Uint64,
    OptionalUint64,
    Bool,
    Double,
    OptionalDouble,
    Doubles,
    String,
    Strings,
    Bytes,
}

impl FieldKind {
    fn wire(self) -> (Type, Label) {
        match self {
            Self::Uint32 | Self::OptionalUint32 => (Type::Uint32, Label::Optional),
            Self::Uint32s => (Type::Uint32, Label::Repeated),
            Self::Uint64 | Self::OptionalUint64 => (Type::Uint64, Label::Optional),
            Self::Bool => (Type::Bool, Label::Optional),
            Self::Double | Self::OptionalDouble => (Type::Double, Label::Optional),
            Self::Doubles => (Type::Double, Label::Repeated),
            Self::String => (Type::String, Label::Optional),
            Self::Strings => (Type::String, Label::Repeated),
            Self::Bytes => (Type::Bytes, Label::Optional),
        }
    }

    /// Whether an absent value differs from zero.
    fn has_presence(self) -> bool {
        matches!(self, Self::OptionalUint32 | Self::OptionalUint64 | Self::OptionalDouble)
    }
}

/// The serialised `FileDescriptorSet` of one `file` (proto3, package `sextant`) with all `declarations`.
pub(crate) fn file_set(file: &str, declarations: &[Declaration]) -> Vec<u8> {
    let file = FileDescriptorProto {
        name: Some(file.to_owned()),
        package: Some("sextant".to_owned()),
        message_type: declarations.iter().map(message).collect(),
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

fn message(declaration: &Declaration) -> DescriptorProto {
    let mut message = DescriptorProto { name: Some(declaration.name.to_owned()), ..DescriptorProto::default() };
    for &Field { name, number, kind } in declaration.fields {
        let (wire, label) = kind.wire();
        let mut field = FieldDescriptorProto {
            name: Some(name.to_owned()),
            json_name: Some(name.to_owned()),
            number: Some(number),
            label: Some(label.into()),
            r#type: Some(wire.into()),
            ..FieldDescriptorProto::default()
        };
        // In proto3 an absent scalar differs from zero only if it has its own oneof.
        if kind.has_presence() {
            field.proto3_optional = Some(true);
            field.oneof_index = i32::try_from(message.oneof_decl.len()).ok();
            message
                .oneof_decl
                .push(OneofDescriptorProto { name: Some(format!("_{name}")), ..OneofDescriptorProto::default() });
        }
        message.field.push(field);
    }
    message
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::messages::declarations;

    #[test]
    fn the_documentation_lists_every_field_with_its_number() {
        let page = include_str!("../../../../docs/recording.md");
        for declaration in declarations() {
            let (_, section) = page
                .split_once(&format!("message {} {{", declaration.name))
                .unwrap_or_else(|| panic!("docs/recording.md has no message {}", declaration.name));
            let (section, _) = section.split_once('}').expect("a closed message");
            for field in declaration.fields {
                assert!(
                    section.contains(&format!(" {} = {};", field.name, field.number)),
                    "docs/recording.md lacks {}.{} = {}",
                    declaration.name,
                    field.name,
                    field.number
                );
            }
            assert_eq!(section.matches(" = ").count(), declaration.fields.len(), "{}", declaration.name);
        }
    }

    #[test]
    fn field_numbers_are_unique_within_a_message() {
        for declaration in declarations() {
            let numbers: BTreeSet<i32> = declaration.fields.iter().map(|field| field.number).collect();
            assert_eq!(numbers.len(), declaration.fields.len(), "{}", declaration.name);
        }
    }
}
