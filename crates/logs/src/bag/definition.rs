//! Definitions of ROS messages, as a bag carries them: the text of a `.msg` file, followed by those of the types that it
//! uses (ROS 2 documentation, "Interfaces"; ROS wiki, "msg").

/// Which ROS wrote the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// ROS 1: no alignment, no padding, `time` is built in.
    Ros1,
    /// ROS 2.
    Ros2,
}

/// A number of fixed size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Bool,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64,
}

impl Number {
    /// Size (octets), and alignment in ROS 2.
    pub(super) const fn octets(self) -> usize {
        match self {
            Self::Bool | Self::Int8 | Self::UInt8 => 1,
            Self::Int16 | Self::UInt16 => 2,
            Self::Int32 | Self::UInt32 | Self::Float32 => 4,
            Self::Int64 | Self::UInt64 | Self::Float64 => 8,
        }
    }
}

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FieldKind {
    Number(Number),
    Text,
    /// A string of wide characters. Its size on the wire differs between implementations, so it cannot be read.
    WideText,
    /// Seconds and nanoseconds: a time, or in ROS 1 a duration.
    Instant,
    /// Another message, by its index.
    Message(usize),
}

/// How many values a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    One,
    /// An array of this length.
    Array(usize),
    /// A sequence, which carries its length.
    Sequence,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct MessageField {
    pub(super) name: String,
    pub(super) kind: FieldKind,
    pub(super) extent: Extent,
    /// Its type as written, for people.
    pub(super) type_text: String,
}

/// A message and the messages in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Definitions {
    pub(super) dialect: Dialect,
    /// The fields of each message; the first is the whole one.
    messages: Vec<Vec<MessageField>>,
}

impl Definitions {
    /// The index of the whole message.
    pub(super) const WHOLE: usize = 0;

    /// Reads the definition of the message type `name`.
    ///
    /// # Errors
    /// If the text has an invalid line or a type that it does not define, or defines a message without end or of great size.
    pub(super) fn parse(dialect: Dialect, name: &str, text: &str) -> Result<Self, String> {
        let mut sections = vec![Section { name: short_name(name), lines: Vec::new() }];
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if is_separator(line) {
                let title = lines.next().unwrap_or_default().trim();
                let name = title.strip_prefix("MSG:").ok_or_else(|| {
                    format!("`{title}` follows a line of `=` in its definition; expected: `MSG: PACKAGE/TYPE`")
                })?;
                sections.push(Section { name: short_name(name.trim()), lines: Vec::new() });
            } else if let [.., section] = sections.as_mut_slice() {
                section.lines.push(line);
            }
        }
        if sections.len() > MOST_TYPES {
            return Err(format!("its definition has {} types; allowed: up to {MOST_TYPES}", sections.len()));
        }
        let mut messages = Vec::with_capacity(sections.len());
        for section in &sections {
            let fields =
                section.lines.iter().filter_map(|line| field(dialect, line, &section.name, &sections).transpose());
            messages.push(fields.collect::<Result<Vec<_>, String>>()?);
        }
        let definitions = Self { dialect, messages };
        let Size { fields, .. } =
            definitions.size(Self::WHOLE, 1, &mut vec![KnownSize::Nothing; sections.len()], &sections)?;
        if fields > MOST_FIELDS {
            return Err(format!(
                "its definition has {fields} fields with those of inner messages; allowed: up to {MOST_FIELDS}"
            ));
        }
        Ok(definitions)
    }

    /// The fields of the message with this index.
    pub(super) fn fields(&self, message: usize) -> &[MessageField] {
        &self.messages[message]
    }

    /// How large a message is with those in it; `sizes` has what is known of each.
    ///
    /// # Errors
    /// If a message holds itself, or they are nested too deep.
    fn size(
        &self,
        message: usize,
        depth: usize,
        sizes: &mut [KnownSize],
        sections: &[Section<'_>],
    ) -> Result<Size, String> {
        match sizes[message] {
            KnownSize::Size(size) => return Ok(size),
            KnownSize::Open => {
                return Err(format!("its definition is circular: `{}` holds itself", sections[message].name));
            }
            KnownSize::Nothing => sizes[message] = KnownSize::Open,
        }
        let mut whole = Size { fields: 0, depth: 1 };
        for field in &self.messages[message] {
            whole.fields = whole.fields.saturating_add(1);
            if let FieldKind::Message(inner) = field.kind {
                // The depth is looked at here too, because this function calls itself.
                if depth < MOST_DEPTH {
                    let size = self.size(inner, depth + 1, sizes, sections)?;
                    whole.fields = whole.fields.saturating_add(size.fields);
                    whole.depth = whole.depth.max(size.depth + 1);
                } else {
                    whole.depth = MOST_DEPTH + 1;
                }
                if whole.depth > MOST_DEPTH {
                    return Err(format!("its definition nests more than {MOST_DEPTH} messages in each other"));
                }
            }
        }
        sizes[message] = KnownSize::Size(whole);
        Ok(whole)
    }
}

/// Most types of a definition, most fields of a message with those in it, and how deep messages are nested. Those of ROS have some
/// dozens, some hundreds, and some. A few lines can define a message of 2⁶⁰ fields.
const MOST_TYPES: usize = 1000;
const MOST_FIELDS: u64 = 10_000;
const MOST_DEPTH: usize = 50;

/// How large a message is.
#[derive(Clone, Copy)]
struct Size {
    fields: u64,
    /// How many messages are nested in each other.
    depth: usize,
}

/// What is known of the size of a message.
#[derive(Clone, Copy)]
enum KnownSize {
    Nothing,
    /// It is being worked out.
    Open,
    Size(Size),
}

/// The definition of one type.
struct Section<'a> {
    /// `PACKAGE/TYPE`.
    name: String,
    lines: Vec<&'a str>,
}

/// `PACKAGE/TYPE` of `PACKAGE/msg/TYPE` or `PACKAGE/TYPE`.
pub(super) fn short_name(name: &str) -> String {
    match (name.split_once('/'), name.rsplit_once('/')) {
        (Some((package, _)), Some((_, local))) => format!("{package}/{local}"),
        _ => name.to_owned(),
    }
}

fn is_separator(line: &str) -> bool {
    let line = line.trim();
    line.len() >= 3 && line.bytes().all(|byte| byte == b'=')
}

/// The field of a line; `None` if the line is empty, a comment or a constant.
fn field(
    dialect: Dialect,
    line: &str,
    scope: &str,
    sections: &[Section<'_>],
) -> Result<Option<MessageField>, String> {
    // A string constant may hold `#`, but only after its name.
    let line = line.split('#').next().unwrap_or_default().trim();
    if line.is_empty() {
        return Ok(None);
    }
    let invalid = || format!("its definition has the invalid line `{line}`; expected: `TYPE NAME`");
    let (type_text, rest) = line.split_once(char::is_whitespace).ok_or_else(invalid)?;
    let rest = rest.trim_start();
    let name_octets = rest.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count();
    let (name, rest) = rest.split_at(name_octets);
    if name.is_empty() {
        return Err(invalid());
    }
    if rest.trim_start().starts_with('=') {
        return Ok(None);
    }
    // What is left is a default value.
    let (element, extent) = match type_text.split_once('[') {
        None => (type_text, Extent::One),
        Some((element, size)) => {
            let size = size.strip_suffix(']').ok_or_else(invalid)?;
            let extent = match size.strip_prefix("<=") {
                Some(_) => Extent::Sequence,
                None if size.is_empty() => Extent::Sequence,
                None => Extent::Array(size.parse().map_err(|_| invalid())?),
            };
            (element, extent)
        }
    };
    let kind = kind(dialect, element, scope, sections)
        .ok_or_else(|| format!("field `{name}` has the type `{element}`, which its definition does not define"))?;
    Ok(Some(MessageField { name: name.to_owned(), kind, extent, type_text: type_text.to_owned() }))
}

fn kind(dialect: Dialect, element: &str, scope: &str, sections: &[Section<'_>]) -> Option<FieldKind> {
    let bounded = element.split("<=").next().unwrap_or_default();
    let number = match bounded {
        "bool" => Number::Bool,
        "int8" => Number::Int8,
        "byte" if dialect == Dialect::Ros1 => Number::Int8,
        "byte" | "char" | "uint8" => Number::UInt8,
        "int16" => Number::Int16,
        "uint16" => Number::UInt16,
        "int32" => Number::Int32,
        "uint32" => Number::UInt32,
        "int64" => Number::Int64,
        "uint64" => Number::UInt64,
        "float32" => Number::Float32,
        "float64" => Number::Float64,
        "string" => return Some(FieldKind::Text),
        "wstring" => return Some(FieldKind::WideText),
        "time" | "duration" if dialect == Dialect::Ros1 => return Some(FieldKind::Instant),
        _ => {
            let full = match element.contains('/') {
                true => short_name(element),
                false => format!("{}/{element}", scope.split('/').next().unwrap_or_default()),
            };
            if full == "builtin_interfaces/Time" {
                return Some(FieldKind::Instant);
            }
            let found = sections.iter().position(|section| section.name == full);
            let header = || {
                let is_header = element == "Header";
                sections.iter().position(|section| is_header && section.name == "std_msgs/Header")
            };
            return found.or_else(header).map(FieldKind::Message);
        }
    };
    Some(FieldKind::Number(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fields of the whole message as `name type`.
    fn fields(dialect: Dialect, text: &str) -> Result<Vec<String>, String> {
        let definitions = Definitions::parse(dialect, "radio/msg/Heard", text)?;
        let fields = definitions.fields(Definitions::WHOLE).iter();
        Ok(fields.map(|field| format!("{} {:?} {:?}", field.name, field.kind, field.extent)).collect())
    }

    #[test]
    fn each_form_of_a_field_is_read() {
        let text = "# comment\n\
            std_msgs/Header header\n\
            int32 COUNT=3\n\
            string GREETING = \"a # b\"  # a constant\n\
            uint16 src 7            # with a default value\n\
            string<=10 name \"x=y\"\n\
            float32[3] xyz\n\
            uint8[] payload\n\
            int8[<=5] few [1, 2]\n\
            Inner[] inner\n\
            wstring wide\n\
            ================================================================================\n\
            MSG: std_msgs/Header\n\
            builtin_interfaces/Time stamp\n\
            string frame_id\n\
            ===\n\
            MSG: radio/Inner\n\
            char letter\n";
        let expected = [
            "header Message(1) One",
            "src Number(UInt16) One",
            "name Text One",
            "xyz Number(Float32) Array(3)",
            "payload Number(UInt8) Sequence",
            "few Number(Int8) Sequence",
            "inner Message(2) Sequence",
            "wide WideText One",
        ];
        assert_eq!(fields(Dialect::Ros2, text).as_deref(), Ok(&expected.map(str::to_owned)[..]));
    }

    #[test]
    fn a_time_and_a_header_of_ros_1_are_built_in() {
        let text = "Header header\ntime when\n===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
        let expected = ["header Message(1) One".to_owned(), "when Instant One".to_owned()];
        assert_eq!(fields(Dialect::Ros1, text).as_deref(), Ok(&expected[..]));
        assert_eq!(
            fields(Dialect::Ros2, "time when").unwrap_err(),
            "field `when` has the type `time`, which its definition does not define"
        );
    }

    #[test]
    fn the_size_of_a_message_has_bounds() {
        let chain = |types: usize, of: &str| {
            let mut text = of.replace('#', "0");
            for at in 0..types {
                text += &format!("===\nMSG: radio/T{at}\n");
                text += &if at + 1 < types { of.replace('#', &(at + 1).to_string()) } else { "uint8 a\n".to_owned() };
            }
            text
        };
        let problem = |text: &str| fields(Dialect::Ros2, text).unwrap_err();
        assert_eq!(fields(Dialect::Ros2, &chain(49, "T# a\n")).as_deref(), Ok(&["a Message(1) One".to_owned()][..]));
        assert!(problem(&chain(50, "T# a\n")).contains("more than 50 messages"));
        assert!(problem(&chain(999, "T# a\n")).contains("more than 50 messages"));
        assert!(problem(&chain(1000, "T# a\n")).contains("has 1001 types; allowed: up to 1000"));
        // With the message itself 3 · 2¹¹ - 2 = 6142, and twice as many.
        assert!(fields(Dialect::Ros2, &chain(11, "T# a\nT# b\n")).is_ok());
        assert!(problem(&chain(12, "T# a\nT# b\n")).contains("has 12286 fields with those of inner messages"));
        assert!(problem(&chain(49, "T# a\nT# b\n")).contains("fields with those of inner messages"));
        assert!(fields(Dialect::Ros2, &"uint8 a\n".repeat(10_000)).is_ok());
        assert!(problem(&"uint8 a\n".repeat(10_001)).contains("has 10001 fields"));
    }

    #[test]
    fn a_broken_definition_is_an_error() {
        for (text, expected) in [
            ("uint8", "invalid line `uint8`"),
            ("uint8[x] a", "invalid line `uint8[x] a`"),
            ("other/Type a", "type `other/Type`"),
            ("uint8 a\n===\nuint8 b", "`uint8 b` follows a line of `=`"),
            ("Heard[] again", "`radio/Heard` holds itself"),
            ("A a\n===\nMSG: radio/A\nB b\n===\nMSG: radio/B\nA[] a", "`radio/A` holds itself"),
        ] {
            let problem = fields(Dialect::Ros2, text).unwrap_err();
            assert!(problem.contains(expected), "{problem}");
        }
    }
}
