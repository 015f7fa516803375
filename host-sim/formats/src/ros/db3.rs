//! Recordings as SQLite (.db3).

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, OptionalExtension};

use crate::file::Cause;
use crate::ros::recording::{Message, Recording, Topic};
use crate::scan_error::ScanError;

/// An SQLite file.
pub struct Db3Recording {
    database: Connection,
    topics: HashMap<i64, Arc<Topic>>,
    /// Time and number of the last message.
    last: (i64, i64),
}

impl Db3Recording {
    pub fn open(path: &Path) -> Result<Db3Recording, Cause> {
        let length = path.metadata()?.len();
        let opened = || -> rusqlite::Result<Option<Db3Recording>> {
            let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
            let database = Connection::open_with_flags(path, flags)?;
            // no message is longer than its file
            database.set_limit(Limit::SQLITE_LIMIT_LENGTH, i32::try_from(length).unwrap_or(i32::MAX))?;
            let tables = "select count(*) from sqlite_master where type = 'table' and name in ('topics', 'messages')";
            if database.query_row(tables, [], |row| row.get::<_, i64>(0))? != 2 {
                return Ok(None);
            }
            let mut topics = HashMap::new();
            let mut statement =
                database.prepare("select id, name, type from topics where serialization_format = 'cdr'")?;
            let mut rows = statement.query([])?;
            while let Some(row) = rows.next()? {
                topics.insert(row.get(0)?, Arc::new(Topic { name: row.get(1)?, kind: row.get(2)? }));
            }
            drop(rows);
            drop(statement);
            Ok(Some(Db3Recording { database, topics, last: (i64::MIN, i64::MIN) }))
        };
        let recording = opened().map_err(damaged)?;
        recording.ok_or_else(|| ScanError::lacks("an SQLite file", "the tables of a ROS 2 recording").into())
    }
}

impl Recording for Db3Recording {
    fn next_message(&mut self) -> Result<Option<Message>, Cause> {
        let Db3Recording { database, topics, last } = self;
        let next = |after: (i64, i64)| {
            let mut statement = database.prepare_cached(
                "select timestamp, id, topic_id, data from messages where (timestamp, id) > (?, ?)
                 order by timestamp, id limit 1",
            )?;
            let row = |row: &rusqlite::Row<'_>| Ok(((row.get(0)?, row.get(1)?), row.get(2)?, row.get(3)?));
            statement.query_row(after, row).optional()
        };
        loop {
            let found: Option<((i64, i64), i64, Vec<u8>)> = next(*last).map_err(damaged)?;
            let Some((at, topic, data)) = found else { return Ok(None) };
            *last = at;
            if let Some(topic) = topics.get(&topic) {
                return Ok(Some(Message { topic: Arc::clone(topic), data }));
            }
        }
    }
}

fn damaged(e: rusqlite::Error) -> ScanError {
    ScanError::damaged("SQLite", e)
}
