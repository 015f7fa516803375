//! Recordings as MCAP.

use std::collections::HashMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use mcap::McapError;
use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;

use crate::file::Cause;
use crate::ros::recording::{Message, Recording, Topic};
use crate::scan_error::ScanError;

/// An MCAP file. Memory: its largest chunk or message.
pub struct McapRecording {
    messages: MessageReader<BufReader<File>>,
    topics: HashMap<u16, Option<Arc<Topic>>>,
}

impl McapRecording {
    pub fn open(path: &Path) -> Result<McapRecording, Cause> {
        let file = File::open(path)?;
        // no record is longer than its file, whatever it claims
        let most = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
        let options = LinearReaderOptions::default().with_record_length_limit(most);
        let messages = MessageReader::new_with_options(BufReader::new(file), options);
        Ok(McapRecording { messages, topics: HashMap::new() })
    }
}

impl Recording for McapRecording {
    fn next_message(&mut self) -> Result<Option<Message>, Cause> {
        loop {
            let message = match self.messages.next() {
                None => return Ok(None),
                // a recorder that was broken off
                Some(Err(McapError::UnexpectedEof)) if !self.topics.is_empty() => return Ok(None),
                Some(Err(McapError::UnsupportedCompression(how))) => {
                    let advice = format!(
                        "chunks as they are: these are packed ({how}); `mcap compress --compression none` unpacks them"
                    );
                    return Err(ScanError::lacks("an MCAP file", advice).into());
                }
                Some(Err(e)) => return Err(ScanError::damaged("MCAP", e).into()),
                Some(Ok(message)) => message,
            };
            let channel = &message.channel;
            let topic = self.topics.entry(channel.id).or_insert_with(|| {
                let kind = channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
                let cdr = channel.message_encoding == "cdr";
                cdr.then(|| Arc::new(Topic { name: channel.topic.clone(), kind }))
            });
            if let Some(topic) = topic {
                return Ok(Some(Message { topic: Arc::clone(topic), data: message.data.into_owned() }));
            }
        }
    }
}
