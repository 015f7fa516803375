//! Topics of which each message is a scan.

use std::sync::Arc;

use crate::file::Cause;
use crate::ros::recording::{Recording, Topic};
use crate::scan::Scan;
use crate::streamed::Stream;

/// Makes a scan of a message.
pub type Read = Arc<dyn Fn(&[u8]) -> Result<Scan, Cause> + Send + Sync>;

/// The messages of a topic as scans.
pub struct PerMessage {
    pub recording: Box<dyn Recording>,
    pub topic: Arc<Topic>,
    pub read: Read,
    pub data: Vec<u8>,
}

impl Stream for PerMessage {
    fn advance(&mut self) -> Result<bool, Cause> {
        while let Some(message) = self.recording.next_message()? {
            if message.topic == self.topic {
                self.data = message.data;
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn scan(&self) -> Result<Scan, Cause> {
        (self.read)(&self.data)
    }
}
