//! Bags in SQLite, as ROS 2 wrote them by default up to Humble: tables `topics`, `messages` and, since Iron,
//! `message_definitions` (rosbag2, package rosbag2_storage_sqlite3).
//!
//! A file that was made to harm may have views and computed columns, whose rows have no end, and pages that belong to many
//! tables. It is refused.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use mcap::{Channel, Schema};
use rusqlite::{Connection, OpenFlags, OptionalExtension};

use super::standard_types;
use crate::error::bag_error::BagError;

/// Why the file is not read.
struct Problem(String);

impl From<rusqlite::Error> for Problem {
    fn from(why: rusqlite::Error) -> Self {
        Self(format!("SQLite cannot read it: {why}"))
    }
}

/// Calls `visit` with each message of the file `path`: its channel, when it was recorded (ns), and its octets.
///
/// # Errors
/// If the file cannot be read or has other tables; or the error of `visit`.
pub(super) fn scan<E: From<BagError>>(
    path: &Path,
    visit: &mut impl FnMut(&Channel<'static>, u64, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let mut error = None;
    let read = read(path, &mut |channel, time_ns, octets| {
        error = visit(channel, time_ns, octets).err();
        error.is_none()
    });
    match (error, read) {
        (Some(error), _) => Err(error),
        (None, Err(Problem(problem))) => Err(BagError::Content { path: path.to_owned(), problem }.into()),
        (None, Ok(())) => Ok(()),
    }
}

/// The same, until `visit` says that it is enough.
fn read(path: &Path, visit: &mut impl FnMut(&Channel<'static>, u64, &[u8]) -> bool) -> Result<(), Problem> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let file = Connection::open_with_flags(path, flags)?;
    for table in ["topics", "messages"] {
        has_table(&file, table)?;
    }
    let mut room = Room::of(&file)?;
    let channels = channels(&file, &mut room)?;
    let mut statement = file.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY rowid")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let topic: i64 = row.get(0)?;
        let time_ns: i64 = row.get(1)?;
        let channel = channels.get(&topic);
        let channel =
            channel.ok_or_else(|| Problem(format!("a message is of topic {topic}, which is not described")))?;
        let time_ns =
            u64::try_from(time_ns).map_err(|_| Problem(format!("a message was recorded at {time_ns} ns")))?;
        let data = row.get_ref(2)?;
        let octets = data.as_blob();
        let octets =
            octets.map_err(|_| Problem(format!("the data of a message are {}, not octets", data.data_type())))?;
        room.take(octets.len())?;
        if !visit(channel, time_ns, octets) {
            break;
        }
    }
    Ok(())
}

/// Whether there is a table of this name.
///
/// # Errors
/// If its rows are not in the file, in the order of their numbers.
fn has_table(file: &Connection, table: &str) -> Result<bool, Problem> {
    // Computed columns are hidden, and a column `rowid` is not the number of the row.
    let plain = "SELECT type = 'table' AND rootpage > 0 AND NOT EXISTS
            (SELECT 1 FROM pragma_table_xinfo(?1) WHERE hidden <> 0 OR name = 'rowid' COLLATE NOCASE)
        FROM sqlite_schema WHERE name = ?1 COLLATE NOCASE AND type IN ('table', 'view')";
    match file.query_row(plain, [table], |row| row.get(0)).optional()? {
        Some(false) => Err(Problem(format!(
            "`{table}` is not a table as ROS 2 writes it: it is a view or virtual, or has computed columns"
        ))),
        known => Ok(known.is_some()),
    }
}

/// How many octets of rows may still be read. Those of an honest file are not more than its pages have.
struct Room(u64);

impl Room {
    fn of(file: &Connection) -> Result<Self, rusqlite::Error> {
        let pages = "SELECT page_count * page_size FROM pragma_page_count, pragma_page_size";
        file.query_row(pages, [], |row| row.get(0)).map(|octets: i64| Self(octets.unsigned_abs()))
    }

    /// Takes the room of a row whose values have so many octets.
    fn take(&mut self, octets: usize) -> Result<(), Problem> {
        // A row has a header.
        let left = self.0.checked_sub(octets as u64 + 1);
        self.0 = left.ok_or_else(|| Problem("it is damaged: its rows are longer than its pages".to_owned()))?;
        Ok(())
    }
}

/// The topics by their numbers.
fn channels(file: &Connection, room: &mut Room) -> Result<BTreeMap<i64, Channel<'static>>, Problem> {
    let mut schemas: BTreeMap<String, Arc<Schema<'static>>> = BTreeMap::new();
    let schema = |name: &str, encoding: String, text: String| {
        Arc::new(Schema { id: 1, name: name.to_owned(), encoding, data: text.into_bytes().into() })
    };
    if has_table(file, "message_definitions")? {
        let mut statement =
            file.prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let (name, encoding, text): (String, String, String) = (row.get(0)?, row.get(1)?, row.get(2)?);
            room.take(name.len() + encoding.len() + text.len())?;
            if !text.is_empty() {
                schemas.insert(name.clone(), schema(&name, encoding, text));
            }
        }
    }
    let mut channels = BTreeMap::new();
    let mut statement = file.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let (number, topic, name, encoding): (i64, String, String, String) =
            (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
        room.take(topic.len() + name.len() + encoding.len())?;
        let known = || schema(&name, "ros2msg".to_owned(), standard_types::definition(&name).unwrap_or_default());
        let schema = Some(schemas.entry(name.clone()).or_insert_with(known).clone());
        channels
            .insert(number, Channel { id: 1, topic, schema, message_encoding: encoding, metadata: BTreeMap::new() });
    }
    Ok(channels)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;

    /// A bag of one topic with a long message and many short ones, changed by these statements.
    fn bag(changes: &str) -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        let file = Connection::open(folder.path().join("a.db3")).unwrap();
        file.execute_batch(
            "PRAGMA page_size = 512;
             CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
             INSERT INTO topics VALUES (1, '/odom', 'nav_msgs/msg/Odometry', 'cdr');
             INSERT INTO messages VALUES (1, 1, 1, zeroblob(30000));
             WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < 400)
             INSERT INTO messages SELECT i, 1, i, zeroblob(20) FROM n;",
        )
        .unwrap();
        file.execute_batch(changes).unwrap();
        folder
    }

    /// The number of messages, or the problem.
    fn count(folder: &TempDir) -> Result<usize, String> {
        let mut messages = 0;
        let visit = &mut |_: &Channel<'static>, _, _: &[u8]| {
            messages += 1;
            Ok(())
        };
        scan::<BagError>(&folder.path().join("a.db3"), visit).map(|()| messages).map_err(|error| error.to_string())
    }

    #[test]
    fn tables_whose_rows_are_not_in_the_file_are_refused() {
        assert_eq!(count(&bag("")), Ok(400));
        let endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT";
        for (table, changes) in [
            (
                "messages",
                format!("{endless} i AS id, 1 AS topic_id, 1 AS timestamp, x'00' AS data FROM n WHERE i < 0"),
            ),
            ("topics", format!("{endless} i AS id, '/a' AS name, 'b' AS type, 'cdr' AS serialization_format FROM n")),
        ] {
            let problem = count(&bag(&format!("DROP TABLE {table}; CREATE VIEW {table} AS {changes}"))).unwrap_err();
            assert!(problem.contains(&format!("`{table}` is not a table as ROS 2 writes it")), "{problem}");
        }
        for column in ["data BLOB AS (zeroblob(900000000))", "data BLOB, rowid INTEGER"] {
            let table = format!(
                "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, {column})"
            );
            let problem = count(&bag(&format!("DROP TABLE messages; {table}"))).unwrap_err();
            assert!(problem.contains("`messages` is not a table as ROS 2 writes it"), "{problem}");
        }
        let problem = count(&bag("UPDATE messages SET data = 'abc' WHERE id = 7")).unwrap_err();
        assert!(problem.contains("the data of a message are Text, not octets"), "{problem}");
    }

    #[test]
    fn a_page_that_is_read_again_and_again_is_damage() {
        let folder = bag("");
        let path = folder.path().join("a.db3");
        let root: u32 = Connection::open(&path)
            .unwrap()
            .query_row("SELECT rootpage FROM sqlite_schema WHERE name = 'messages'", [], |row| row.get(0))
            .unwrap();
        // An inner page of a table has a list of its cells, which begin with the numbers of the pages below it (SQLite,
        // "Database File Format", 1.6).
        let mut octets = fs::read(&path).unwrap();
        let root = root as usize;
        let page = &mut octets[(root - 1) * 512..root * 512];
        assert_eq!(page[0], 5, "an inner page");
        let number = |page: &[u8], at: usize| usize::from(u16::from_be_bytes([page[at], page[at + 1]]));
        let first = number(page, 12);
        let child: [u8; 4] = page[first..first + 4].try_into().unwrap();
        for cell in 0..number(page, 3) {
            let at = number(page, 12 + 2 * cell);
            page[at..at + 4].copy_from_slice(&child);
        }
        fs::write(&path, octets).unwrap();
        let problem = count(&folder).unwrap_err();
        assert!(problem.contains("it is damaged: its rows are longer than its pages"), "{problem}");
    }
}
