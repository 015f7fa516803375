//! Messages and recordings for tests.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use byteorder::LittleEndian;
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use serde::Serialize;

/// A message as it is recorded.
pub fn cdr(message: &impl Serialize) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<_, LittleEndian>(message).expect("a message");
    [&[0, 1, 0, 0][..], &body].concat()
}

/// A file that is removed when dropped.
pub struct Temporary(PathBuf);

impl Temporary {
    /// A name of its own in the folder for temporary files.
    pub fn new(name: &str) -> Temporary {
        Temporary(std::env::temp_dir().join(format!("scanseg-{}-{name}", std::process::id())))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        _ = fs::remove_file(&self.0);
    }
}

/// Writes an MCAP file of messages: topic, type, CDR.
pub fn mcap(name: &str, messages: &[(&str, &str, Vec<u8>)]) -> Temporary {
    let file = Temporary::new(name);
    let bytes = BufWriter::new(File::create(file.path()).expect("a file"));
    let mut writer = WriteOptions::new().compression(None).create(bytes).expect("a writer");
    for (i, (topic, kind, data)) in (0..).zip(messages) {
        let schema = writer.add_schema(kind, "ros2msg", b"").expect("a schema");
        let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel");
        let header = MessageHeader { channel_id, sequence: i, log_time: i.into(), publish_time: i.into() };
        writer.write_to_known_channel(&header, data).expect("a message");
    }
    writer.finish().expect("an end");
    file
}
