//! What all kinds of recordings have in common.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::file::Cause;

/// A topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    pub name: String,
    /// The type of its messages, as `sensor_msgs/msg/Image`.
    pub kind: String,
}

/// A message as it was recorded.
pub struct Message {
    pub topic: Arc<Topic>,
    /// CDR.
    pub data: Vec<u8>,
}

/// A recording, message by message in the order of time.
pub trait Recording: Send {
    /// Returns the next message, `None` at the end.
    fn next_message(&mut self) -> Result<Option<Message>, Cause>;
}

/// Opens a recording at its start.
pub type Open = Arc<dyn Fn() -> Result<Box<dyn Recording>, Cause> + Send + Sync>;

/// Returns the recording in a folder that holds only one, as `ros2 bag record` makes it.
pub(crate) fn is_folder_of_one(folder: &Path) -> io::Result<Option<PathBuf>> {
    let entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    let is_recording = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "mcap" || kind == "db3");
    let mut found = entries.into_iter().map(|entry| entry.path()).filter(is_recording);
    let first = found.next();
    Ok(first.filter(|_| found.next().is_none()))
}
