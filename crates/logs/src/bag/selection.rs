//! Reads chosen fields of a message and skips the others, by its definition.

use super::body::MessageBody;
use super::definition::{Definitions, Dialect, Extent, FieldKind, MessageField, Number};
use super::field_path::{Element, FieldPath, FieldStep};
use super::leaves::{Content, listing};

/// A value of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// A list of the message is too short to have it.
    Absent,
    Integer(i128),
    Real(f64),
    Text(&'a str),
    Octets(&'a [u8]),
    /// Nanoseconds.
    Instant(i64),
}

/// Fields to read. If their paths go through each value of a list, a message has a row of values for each of these.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    definitions: Definitions,
    wanted: Wanted,
    contents: Vec<Content>,
    /// Whether the message has a row for each value of a list.
    has_list: bool,
}

/// What is wanted of a message, or of a value.
#[derive(Clone, Debug, Default)]
struct Wanted {
    /// Where in the row the value itself goes.
    slots: Vec<usize>,
    /// What is wanted of its fields, in their order.
    parts: Vec<WantedField>,
}

#[derive(Clone, Debug)]
struct WantedField {
    field: usize,
    element: Element,
    wanted: Wanted,
}

/// The list whose values give the rows.
struct List<'s, 'a> {
    field: &'s MessageField,
    start: MessageBody<'a>,
    length: usize,
    wanted: &'s Wanted,
}

impl Selection {
    /// The fields with these `paths`.
    ///
    /// # Errors
    /// If the message has no such field, or it is not a value.
    pub(super) fn new(definitions: Definitions, paths: &[FieldPath]) -> Result<Self, String> {
        let mut selection = Self { definitions, wanted: Wanted::default(), contents: Vec::new(), has_list: false };
        for (slot, path) in paths.iter().enumerate() {
            let Self { definitions, wanted, .. } = &mut selection;
            let content = add(definitions, Definitions::WHOLE, wanted, &path.0, slot).map_err(|problem| {
                format!("field `{path}`: {problem}; the fields of this message: {}", listing(definitions))
            })?;
            selection.contents.push(content);
        }
        let lists: Vec<_> = paths.iter().filter_map(list_of).collect();
        let is_nested = |list: &&[FieldStep]| list.iter().filter(|step| step.element == Element::Each).count() > 1;
        if lists.iter().any(is_nested) || lists.windows(2).any(|pair| pair[0] != pair[1]) {
            let problem =
                "the paths go through each value of more than one list; allowed: `[]` at one list".to_owned();
            return Err(problem);
        }
        selection.has_list = !lists.is_empty();
        Ok(selection)
    }

    /// What each path leads to.
    pub(super) fn contents(&self) -> &[Content] {
        &self.contents
    }

    /// Calls `visit` with each row of the message `data`: a value for each path.
    ///
    /// # Errors
    /// If the message does not fit its definition; or the error of `visit`.
    pub(super) fn rows<'a, E>(
        &self,
        data: &'a [u8],
        mut visit: impl FnMut(&[Value<'a>]) -> Result<(), E>,
    ) -> Result<Result<(), E>, String> {
        let mut row = vec![Value::Absent; self.contents.len()];
        let mut list = None;
        let mut body = MessageBody::new(self.definitions.dialect, data)?;
        self.message(Definitions::WHOLE, &self.wanted, &mut body, &mut row, &mut list)?;
        let Some(List { field, start: mut body, length, wanted }) = list else {
            return Ok(if self.has_list { Ok(()) } else { visit(&row) });
        };
        let outer = row.clone();
        for _ in 0..length {
            row.copy_from_slice(&outer);
            self.value(field, wanted, &mut body, &mut row, &mut None)?;
            if let Err(error) = visit(&row) {
                return Ok(Err(error));
            }
        }
        Ok(Ok(()))
    }

    fn message<'s, 'a>(
        &'s self,
        message: usize,
        wanted: &'s Wanted,
        body: &mut MessageBody<'a>,
        row: &mut [Value<'a>],
        list: &mut Option<List<'s, 'a>>,
    ) -> Result<(), String> {
        let fields = self.definitions.fields(message);
        if fields.is_empty() && self.definitions.dialect == Dialect::Ros2 {
            // A message without fields has one octet.
            body.take(1)?;
        }
        for (index, field) in fields.iter().enumerate() {
            let first = wanted.parts.partition_point(|part| part.field < index);
            let parts = &wanted.parts[first..];
            // What follows the last wanted field of the whole message is not read.
            if parts.is_empty() && message == Definitions::WHOLE {
                break;
            }
            let parts = &parts[..parts.partition_point(|part| part.field == index)];
            self.field(field, parts, body, row, list)?;
        }
        Ok(())
    }

    fn field<'s, 'a>(
        &'s self,
        field: &'s MessageField,
        parts: &'s [WantedField],
        body: &mut MessageBody<'a>,
        row: &mut [Value<'a>],
        list: &mut Option<List<'s, 'a>>,
    ) -> Result<(), String> {
        let length = match field.extent {
            Extent::One => {
                return match parts {
                    [] => self.skip(field.kind, 1, body),
                    [part, ..] => self.value(field, &part.wanted, body, row, list),
                };
            }
            Extent::Array(length) => body.fits(length)?,
            Extent::Sequence => body.length()?,
        };
        let start = *body;
        let mut next = 0;
        for part in parts {
            match part.element {
                Element::Whole => {
                    let octets = Value::Octets({ start }.take(length)?);
                    part.wanted.slots.iter().for_each(|&slot| row[slot] = octets);
                }
                Element::Each => *list = Some(List { field, start, length, wanted: &part.wanted }),
                Element::At(at) if at < length => {
                    self.skip(field.kind, at - next, body)?;
                    self.value(field, &part.wanted, body, row, list)?;
                    next = at + 1;
                }
                Element::At(_) => {}
            }
        }
        self.skip(field.kind, length - next, body)
    }

    /// Reads one value of `field`.
    fn value<'s, 'a>(
        &'s self,
        field: &'s MessageField,
        wanted: &'s Wanted,
        body: &mut MessageBody<'a>,
        row: &mut [Value<'a>],
        list: &mut Option<List<'s, 'a>>,
    ) -> Result<(), String> {
        let value = match field.kind {
            FieldKind::Message(inner) => return self.message(inner, wanted, body, row, list),
            FieldKind::Number(number) => number_value(number, body)?,
            FieldKind::Text => {
                let octets = body.text()?;
                Value::Text(std::str::from_utf8(octets).map_err(|_| format!("`{}` is not UTF-8 text", field.name))?)
            }
            FieldKind::Instant => self.instant(body)?,
            FieldKind::WideText => return self.skip(field.kind, 1, body),
        };
        wanted.slots.iter().for_each(|&slot| row[slot] = value);
        Ok(())
    }

    fn instant<'a>(&self, body: &mut MessageBody<'a>) -> Result<Value<'a>, String> {
        let [seconds, nanos] = [body.u32()?, body.u32()?];
        let seconds = match self.definitions.dialect {
            Dialect::Ros1 => i64::from(seconds),
            Dialect::Ros2 => i64::from(seconds.cast_signed()),
        };
        Ok(Value::Instant(seconds * 1_000_000_000 + i64::from(nanos)))
    }

    /// Skips `count` values.
    fn skip(&self, kind: FieldKind, count: usize, body: &mut MessageBody<'_>) -> Result<(), String> {
        match kind {
            FieldKind::Number(number) => body.skip(number, count),
            FieldKind::Instant => body.skip(Number::UInt32, 2 * count),
            FieldKind::Text => (0..count).try_for_each(|_| body.text().map(drop)),
            FieldKind::Message(inner) => (0..count).try_for_each(|_| self.skip_message(inner, body)),
            FieldKind::WideText if count == 0 => Ok(()),
            FieldKind::WideText => {
                Err("a field of type `wstring` comes before the wanted ones; it cannot be read, because \
                 its size differs between implementations of ROS 2"
                    .to_owned())
            }
        }
    }

    fn skip_message(&self, message: usize, body: &mut MessageBody<'_>) -> Result<(), String> {
        let fields = self.definitions.fields(message);
        if fields.is_empty() && self.definitions.dialect == Dialect::Ros2 {
            body.take(1)?;
        }
        for field in fields {
            let count = match field.extent {
                Extent::One => 1,
                Extent::Array(length) => body.fits(length)?,
                Extent::Sequence => body.length()?,
            };
            self.skip(field.kind, count, body)?;
        }
        Ok(())
    }
}

fn number_value<'a>(number: Number, body: &mut MessageBody<'a>) -> Result<Value<'a>, String> {
    let integer = match number {
        Number::Float32 => return body.little().map(|octets| Value::Real(f32::from_le_bytes(octets).into())),
        Number::Float64 => return body.little().map(|octets| Value::Real(f64::from_le_bytes(octets))),
        Number::Bool | Number::UInt8 => u8::from_le_bytes(body.little()?).into(),
        Number::Int8 => i8::from_le_bytes(body.little()?).into(),
        Number::Int16 => i16::from_le_bytes(body.little()?).into(),
        Number::UInt16 => u16::from_le_bytes(body.little()?).into(),
        Number::Int32 => i32::from_le_bytes(body.little()?).into(),
        Number::UInt32 => u32::from_le_bytes(body.little()?).into(),
        Number::Int64 => i64::from_le_bytes(body.little()?).into(),
        Number::UInt64 => u64::from_le_bytes(body.little()?).into(),
    };
    Ok(Value::Integer(integer))
}

/// The path of the list that `path` goes through.
fn list_of(path: &FieldPath) -> Option<&[FieldStep]> {
    let last = path.0.iter().rposition(|step| step.element == Element::Each)?;
    Some(&path.0[..=last])
}

/// Adds the field with the path `steps` in `message` to what is wanted of it.
fn add(
    definitions: &Definitions,
    message: usize,
    wanted: &mut Wanted,
    steps: &[FieldStep],
    slot: usize,
) -> Result<Content, String> {
    let [FieldStep { name, element }, rest @ ..] = steps else {
        return Err("it is a message".to_owned());
    };
    let fields = definitions.fields(message);
    let index = fields.iter().position(|field| &field.name == name).ok_or_else(|| format!("there is no `{name}`"))?;
    let field = &fields[index];
    let is_list = field.extent != Extent::One;
    match (is_list, element) {
        (false, Element::At(_) | Element::Each) => return Err(format!("`{name}` is not a list")),
        (true, Element::Whole) if !rest.is_empty() || Content::of(field, false).is_none() => {
            return Err(format!("`{name}` is a list: add `[]` for each of its values or `[0]` for the first"));
        }
        _ => {}
    }
    // In the order of the octets; `[]` last, because those values are read afterwards.
    let key = |field: usize, element: Element| match element {
        Element::Whole => (field, 0, 0),
        Element::At(at) => (field, 1, at),
        Element::Each => (field, 2, 0),
    };
    let sought = key(index, *element);
    let at = wanted.parts.partition_point(|part| key(part.field, part.element) < sought);
    if wanted.parts.get(at).is_none_or(|part| key(part.field, part.element) != sought) {
        wanted.parts.insert(at, WantedField { field: index, element: *element, wanted: Wanted::default() });
    }
    let inner = &mut wanted.parts[at].wanted;
    match (field.kind, rest) {
        (FieldKind::Message(message), rest) => add(definitions, message, inner, rest, slot),
        (_, [step, ..]) => Err(format!("`{name}` is no message and has no `{}`", step.name)),
        (FieldKind::WideText, []) => Err(format!("`{name}` is a `wstring`, which cannot be read")),
        (_, []) => {
            inner.slots.push(slot);
            Content::of(field, *element != Element::Whole).ok_or_else(|| format!("`{name}` is not a value"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEARD: &str = "std_msgs/Header header\nNothing nothing\nBeacon[] beacons\nuint8[3] key\nint16[] levels\n\
        float64 gain\n\
        ===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
        ===\nMSG: radio/Nothing\nuint8 CONSTANT=1\n\
        ===\nMSG: radio/Beacon\nstring id\nint8 rssi\nuint16[] taps\n";

    /// A message of type `HEARD` with two beacons, written by hand after the rules of CDR.
    fn heard() -> Vec<u8> {
        let mut octets = Vec::new();
        let mut put = |size: usize, value: &[u8]| {
            octets.resize(octets.len().next_multiple_of(size), 0_u8);
            octets.extend(value);
        };
        put(4, &7_i32.to_le_bytes());
        put(4, &5_u32.to_le_bytes());
        put(4, &4_u32.to_le_bytes());
        put(1, b"map\0");
        put(1, &[0]);
        put(4, &2_u32.to_le_bytes());
        for (id, rssi, taps) in [(b"lamp\0", -60_i8, &[3_u16, 4][..]), (b"door\0", -70, &[])] {
            put(4, &5_u32.to_le_bytes());
            put(1, id);
            put(1, &rssi.to_le_bytes());
            put(4, &u32::try_from(taps.len()).unwrap().to_le_bytes());
            taps.iter().for_each(|tap| put(2, &tap.to_le_bytes()));
        }
        put(1, &[1, 2, 3]);
        put(4, &1_u32.to_le_bytes());
        put(2, &(-9_i16).to_le_bytes());
        put(8, &2.5_f64.to_le_bytes());
        [&[0, 1, 0, 0], octets.as_slice()].concat()
    }

    fn select(paths: &[&str]) -> Result<Selection, String> {
        let definitions = Definitions::parse(Dialect::Ros2, "radio/msg/Heard", HEARD)?;
        let paths = paths.iter().map(|path| FieldPath::parse(path)).collect::<Result<Vec<_>, _>>()?;
        Selection::new(definitions, &paths)
    }

    fn rows(paths: &[&str], data: &[u8]) -> Result<Vec<String>, String> {
        let mut rows = Vec::new();
        let visited = select(paths)?.rows(data, |row| {
            rows.push(format!("{row:?}"));
            Ok::<_, String>(())
        })?;
        visited.map(|()| rows)
    }

    #[test]
    fn chosen_fields_are_read_and_others_are_skipped() {
        let values =
            rows(&["gain", "header.stamp", "key", "key[1]", "levels[0]", "levels[1]", "beacons[1].id"], &heard());
        let expected =
            "[Real(2.5), Instant(7000000005), Octets([1, 2, 3]), Integer(2), Integer(-9), Absent, Text(\"door\")]";
        assert_eq!(values, Ok(vec![expected.to_owned()]));
    }

    #[test]
    fn each_value_of_a_list_is_a_row() {
        let values = rows(&["beacons[].id", "header.stamp", "beacons[].rssi", "beacons[].taps[1]", "gain"], &heard());
        let expected = [
            "[Text(\"lamp\"), Instant(7000000005), Integer(-60), Integer(4), Real(2.5)]",
            "[Text(\"door\"), Instant(7000000005), Integer(-70), Absent, Real(2.5)]",
        ];
        assert_eq!(values, Ok(expected.map(str::to_owned).to_vec()));
    }

    #[test]
    fn fields_after_the_wanted_ones_are_not_needed() {
        let short = &heard()[..20];
        assert_eq!(rows(&["header.stamp"], short), Ok(vec!["[Instant(7000000005)]".to_owned()]));
        let problem = rows(&["gain"], short).unwrap_err();
        assert_eq!(problem, "the message is shorter than its definition says");
        // Wherever the message is cut, it is an error and no panic.
        let whole = heard();
        for length in 0..whole.len() {
            assert!(rows(&["gain", "beacons[].taps[0]"], &whole[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn a_path_that_leads_nowhere_is_an_error_that_lists_the_fields() {
        for (path, problem) in [
            ("beacons[].name", "there is no `name`"),
            ("header", "it is a message"),
            ("gain.x", "`gain` is no message and has no `x`"),
            ("gain[0]", "`gain` is not a list"),
            ("levels", "`levels` is a list: add `[]`"),
            ("beacons.id", "`beacons` is a list: add `[]`"),
        ] {
            let found = select(&[path]).unwrap_err();
            assert!(found.starts_with(&format!("field `{path}`: {problem}")), "{found}");
            assert!(found.ends_with("levels[] (int16[]), gain (float64)"), "{found}");
        }
        for paths in [&["beacons[].id", "levels[]"][..], &["beacons[].taps[]"]] {
            let found = select(paths).unwrap_err();
            assert!(found.starts_with("the paths go through each value of more than one list"), "{found}");
        }
    }
}
