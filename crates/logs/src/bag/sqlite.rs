//! Bags in SQLite, as ROS 2 wrote them by default up to Humble: tables `topics`, `messages` and, since Iron,
//! `message_definitions` (rosbag2, package rosbag2_storage_sqlite3).

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use mcap::{Channel, Schema};
use rusqlite::{Connection, OpenFlags};

use super::super::bag_error::BagError;
use super::standard_types;

/// Calls `visit` with each message of the file `path`: its channel, when it was recorded (ns), and its octets.
///
/// # Errors
/// If the file cannot be read or has other tables; or the error of `visit`.
pub(super) fn scan<E: From<BagError>>(
    path: &Path,
    visit: &mut impl FnMut(&Channel<'static>, u64, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let failed = |why: rusqlite::Error| {
        let problem = format!("SQLite cannot read it: {why}");
        E::from(BagError::Content { path: path.to_owned(), problem })
    };
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let file = Connection::open_with_flags(path, flags).map_err(failed)?;
    let channels = channels(&file).map_err(failed)?;
    let mut statement = file.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id").map_err(failed)?;
    let mut rows = statement.query([]).map_err(failed)?;
    while let Some(row) = rows.next().map_err(failed)? {
        let topic: i64 = row.get(0).map_err(failed)?;
        let time_ns: i64 = row.get(1).map_err(failed)?;
        let wrong = |problem: String| BagError::Content { path: path.to_owned(), problem };
        let channel = channels.get(&topic);
        let channel =
            channel.ok_or_else(|| wrong(format!("a message is of topic {topic}, which is not described")))?;
        let time_ns = u64::try_from(time_ns).map_err(|_| wrong(format!("a message was recorded at {time_ns} ns")))?;
        let data = row.get_ref(2).and_then(|value| Ok(value.as_blob()?)).map_err(failed)?;
        visit(channel, time_ns, data)?;
    }
    Ok(())
}

/// The topics by their numbers.
fn channels(file: &Connection) -> Result<BTreeMap<i64, Channel<'static>>, rusqlite::Error> {
    let mut definitions: BTreeMap<String, (String, String)> = BTreeMap::new();
    if file.table_exists(None, "message_definitions")? {
        let mut rows =
            file.prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")?;
        let rows = rows.query_map([], |row| Ok((row.get(0)?, (row.get(1)?, row.get(2)?))))?;
        definitions = rows.collect::<Result<_, _>>()?;
    }
    let mut rows = file.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let rows = rows.query_map([], |row| {
        let (number, topic, name, encoding): (i64, String, String, String) =
            (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
        let (of, text) = match definitions.get(&name).filter(|(_, text)| !text.is_empty()) {
            Some((of, text)) => (of.clone(), text.clone()),
            None => ("ros2msg".to_owned(), standard_types::definition(&name).unwrap_or_default()),
        };
        let schema = Schema { id: 1, name, encoding: of, data: text.into_bytes().into() };
        let schema = Some(Arc::new(schema));
        let channel = Channel { id: 1, topic, schema, message_encoding: encoding, metadata: BTreeMap::new() };
        Ok((number, channel))
    })?;
    rows.collect()
}
