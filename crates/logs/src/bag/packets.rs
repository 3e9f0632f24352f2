//! The packets that the robot received, from a topic of any message type.

use std::fmt::Write as _;

use super::clock::Moment;
use super::field_path::FieldPath;
use super::leaves::{Content, listing};
use super::obvious::{obvious_fields, stamp_beside};
use super::packet_fields::{PacketFields, TimeUnit};
use super::selection::{Selection, Value};
use super::topics::{Bag, Topic};
use crate::error::bag_error::BagError;
use crate::options::bag_options::BagClock;

/// What gives the packets.
#[derive(Clone, Debug)]
pub(super) struct PacketSource<'a> {
    pub(super) topic: &'a Topic,
    pub(super) fields: PacketFields,
    selection: Selection,
    /// Where in a row the optional values are.
    sender: Option<usize>,
    rssi: Option<usize>,
    snr: Option<usize>,
    sector: Option<usize>,
    /// That of a range, and a metre in its unit.
    range: Option<(usize, f64)>,
    stamp: Option<usize>,
}

/// What is sought in a bag, and the options that name it.
#[derive(Clone, Copy)]
pub(super) struct Sought<'a> {
    /// In words: packets or ranges.
    pub(super) what: &'static str,
    /// The topic that the user names, and the option for it.
    pub(super) topic: Option<&'a String>,
    pub(super) topic_option: &'static str,
    /// The fields that the user names, and how to.
    pub(super) fields: Option<&'a PacketFields>,
    pub(super) fields_option: &'static str,
}

/// A packet in a bag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BagPacket<'a> {
    pub(super) moment: Moment,
    /// Empty if the message has none.
    pub(super) node: &'a str,
    /// Who sent it, if that is another one.
    pub(super) sender: Option<&'a str>,
    pub(super) rssi_dbm: Option<f64>,
    pub(super) snr_db: Option<f64>,
    pub(super) sector: Option<u8>,
    pub(super) range_m: Option<f64>,
}

impl<'a> PacketSource<'a> {
    /// What the user names, or the only topic whose messages have an obvious node and RSSI.
    ///
    /// # Errors
    /// If there is no such topic, several, or it lacks a field.
    pub(super) fn choose(bag: &'a Bag, sought: Sought<'_>) -> Result<Self, BagError> {
        let Sought { what, topic_option, fields_option, .. } = sought;
        let named = |name: &String| {
            bag.topic(name).ok_or_else(|| {
                bag.problem(format!(
                    "it has no topic `{name}` with messages; its topics: {}",
                    Bag::list(bag.topics())
                ))
            })
        };
        let (topic, fields) = match (sought.topic, sought.fields) {
            (Some(name), Some(fields)) => (named(name)?, fields.clone()),
            (Some(name), None) => {
                let topic = named(name)?;
                let definitions = topic.definitions().map_err(|problem| bag.topic_problem(name, problem))?;
                let fields = obvious_fields(&definitions).ok_or_else(|| {
                    let problem = format!(
                        "its messages ({}) have no obvious field with the node of the {what}; give `{fields_option}`; their fields: {}",
                        topic.message_type,
                        listing(&definitions)
                    );
                    bag.topic_problem(name, problem)
                })?;
                (topic, fields)
            }
            (None, fields) => {
                let of = |topic: &'a Topic| {
                    let definitions = topic.definitions().ok()?;
                    let found = match fields {
                        Some(fields) => Selection::new(definitions, std::slice::from_ref(&fields.node))
                            .ok()
                            .map(|_| fields.clone()),
                        None => obvious_fields(&definitions).filter(|fields| fields.rssi_dbm.is_some()),
                    };
                    Some((topic, found?))
                };
                let found: Vec<_> = bag.topics().filter_map(of).collect();
                match found.as_slice() {
                    [(topic, fields)] => (*topic, fields.clone()),
                    [] => {
                        let missing = match fields {
                            Some(fields) => format!("the field `{}`", fields.node),
                            None => "an obvious node and RSSI".to_owned(),
                        };
                        let topics = Bag::list(bag.topics());
                        let unreadable = bag.topics().find_map(|topic| {
                            let why = topic.definitions().err()?;
                            Some(format!("; `{}` cannot be read: {why}", topic.name))
                        });
                        let problem = format!(
                            "no topic has messages with {missing}; name that of the {what} with option `{topic_option}`; its \
                             topics: {topics}{}",
                            unreadable.unwrap_or_default()
                        );
                        return Err(bag.problem(problem));
                    }
                    several => {
                        let topics = Bag::list(several.iter().map(|(topic, _)| *topic));
                        let problem = format!(
                            "several topics can have the {what}; choose one with option `{topic_option}`: {topics}"
                        );
                        return Err(bag.problem(problem));
                    }
                }
            }
        };
        Self::new(topic, fields).map_err(|problem| bag.topic_problem(&topic.name, problem))
    }

    fn new(topic: &'a Topic, mut fields: PacketFields) -> Result<Self, String> {
        let definitions = topic.definitions()?;
        if fields.time.is_none() {
            fields.time = stamp_beside(&definitions, &fields.node).map(|path| (TimeUnit::Seconds, path));
        }
        let mut paths = vec![fields.node.clone()];
        let mut slot = |path: &Option<FieldPath>| {
            path.as_ref().map(|path| {
                paths.push(path.clone());
                paths.len() - 1
            })
        };
        let [sender, rssi, snr, sector] =
            [&fields.sender, &fields.rssi_dbm, &fields.snr_db, &fields.sector].map(&mut slot);
        let range = slot(&fields.range.as_ref().map(|(_, path)| path.clone()));
        let stamp = slot(&fields.time.as_ref().map(|(_, path)| path.clone()));
        let unit = fields.time.as_ref().map_or(TimeUnit::Seconds, |(unit, _)| *unit);
        let selection = Selection::new(definitions, &paths)?;
        let number: &[Content] = &[Content::Integer, Content::Real];
        let name: &[Content] = &[Content::Integer, Content::Text, Content::Octets];
        let name_words = "an integer, a string or octets";
        let (moment, moment_words): (&[Content], _) = match unit {
            TimeUnit::Seconds => (&[Content::Instant, Content::Real], "a time or a real number of seconds"),
            _ => (number, "a number"),
        };
        for (key, slot, allowed, words) in [
            (if sender.is_some() { "receiver" } else { "node" }, Some(0), name, name_words),
            ("node", sender, name, name_words),
            ("rssi_dbm", rssi, number, "a number"),
            ("snr_db", snr, number, "a number"),
            ("sector", sector, &[Content::Integer], "an integer"),
            (fields.range.as_ref().map_or("range_m", |((key, _), _)| key), range, number, "a number"),
            (unit.key(), stamp, moment, moment_words),
        ] {
            if let Some(slot) = slot
                && !allowed.contains(&selection.contents()[slot])
            {
                let found = selection.contents()[slot].name();
                return Err(format!("`{key}` is the field `{}`, which is {found}; allowed: {words}", paths[slot]));
            }
        }
        let range = range.zip(fields.range.as_ref().map(|((_, unit), _)| *unit));
        Ok(Self { topic, fields, selection, sender, rssi, snr, sector, range, stamp })
    }

    /// Whether the packets have stamps: the first message has none that was never set.
    pub(super) fn has_stamps(&self) -> bool {
        let mut first = None;
        let read = self.packets(0, &self.topic.first, |packet| {
            first = first.or(Some(packet.moment));
            Ok::<(), String>(())
        });
        self.stamp.is_some() && read.is_ok() && first.is_none_or(|moment| moment.time(BagClock::Stamp).is_some())
    }

    /// Calls `visit` with each packet of the message `data`, which was recorded at `log_ns`.
    ///
    /// # Errors
    /// If the message does not fit its definition, or has an invalid value; the inner error is that of `visit`.
    pub(super) fn packets<E>(
        &self,
        log_ns: u64,
        data: &[u8],
        mut visit: impl FnMut(BagPacket<'_>) -> Result<(), E>,
    ) -> Result<Result<(), E>, String> {
        let mut names = [String::new(), String::new()];
        let mut invalid = None;
        let visited = self.selection.rows(data, |row| {
            let packet = match self.packet(log_ns, row, &mut names) {
                Ok(packet) => packet,
                Err(problem) => {
                    invalid = Some(problem);
                    return Err(None);
                }
            };
            visit(packet).map_err(Some)
        })?;
        match (visited, invalid) {
            (_, Some(problem)) => Err(problem),
            (Err(Some(error)), None) => Ok(Err(error)),
            _ => Ok(Ok(())),
        }
    }

    fn packet<'n>(
        &self,
        log_ns: u64,
        row: &[Value<'_>],
        [node, sender]: &'n mut [String; 2],
    ) -> Result<BagPacket<'n>, String> {
        write_name(row[0], node);
        if let Some(slot) = self.sender {
            write_name(row[slot], sender);
        }
        let level = |slot: Option<usize>| {
            slot.and_then(|slot| match row[slot] {
                Value::Real(level) => Some(level).filter(|level| level.is_finite()),
                Value::Integer(level) => Some(level as f64),
                _ => None,
            })
        };
        let [rssi_dbm, snr_db] = [self.rssi, self.snr].map(level);
        let range_m = self.range.map(|(slot, unit)| level(Some(slot)).unwrap_or(f64::NAN) / unit);
        let sector = match self.sector.map(|slot| row[slot]) {
            Some(Value::Integer(sector)) => {
                Some(u8::try_from(sector).map_err(|_| format!("its sector is {sector}; allowed: 0 to 255"))?)
            }
            _ => None,
        };
        let unit_ns = self.fields.time.as_ref().map_or(TimeUnit::Seconds, |(unit, _)| *unit).nanoseconds();
        let stamp_ns = self.stamp.and_then(|slot| match row[slot] {
            Value::Instant(ns) => Some(ns),
            Value::Integer(units) => i64::try_from(units).ok()?.checked_mul(unit_ns),
            #[expect(clippy::cast_possible_truncation, reason = "checked to be in range")]
            Value::Real(units) => {
                Some(units * unit_ns as f64).filter(|ns| ns.abs() < 9e18).map(|ns| ns.round() as i64)
            }
            _ => None,
        });
        let sender = self.sender.map(|_| sender.as_str());
        Ok(BagPacket { moment: Moment { stamp_ns, log_ns }, node, sender, rssi_dbm, snr_db, sector, range_m })
    }
}

/// Writes the name of a node into `name`; nothing if the message has none.
fn write_name(value: Value<'_>, name: &mut String) {
    name.clear();
    match value {
        Value::Integer(number) => write!(name, "{number}").expect("a string grows"),
        Value::Text(text) => name.push_str(text.trim()),
        Value::Octets(octets) => {
            for (index, octet) in octets.iter().enumerate() {
                let colon = if index == 0 { "" } else { ":" };
                write!(name, "{colon}{octet:02x}").expect("a string grows");
            }
        }
        Value::Absent | Value::Real(_) | Value::Instant(_) => {}
    }
}
