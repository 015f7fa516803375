//! `scanseg listen`: the frames of the link as text.

use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;

use clap::Args;
use scanseg_hal::link::{FrameDecoder, Message, Received, VERSION};

use crate::command::messages::line;
use crate::command::output::{Failure, print, warn};

/// Print the results that a board sends over its link
///
/// Reads frames to the end of the file or stream. A serial device is set up beforehand: stty -F
/// DEVICE 115200 raw -echo
#[derive(Args)]
pub struct Arguments {
    /// File or device; - for standard input
    source: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.source.display().to_string();
    let failed = |e: io::Error| format!("{name}: {e}");
    let mut source: Box<dyn Read> = match name.as_str() {
        "-" => Box::new(io::stdin()),
        _ => Box::new(File::open(&arguments.source).map_err(failed)?),
    };
    let mut decoder = FrameDecoder::new();
    let (mut messages, mut lost, mut damaged) = (0u64, 0u64, 0u64);
    let mut known = VERSION;
    let mut buffer = [0; 4096];
    let end = loop {
        let count = match source.read(&mut buffer) {
            Ok(0) => break Ok(()),
            Ok(count) => count,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            // A device that was unplugged.
            Err(e) => break Err(failed(e)),
        };
        let mut text = String::new();
        decoder.feed(&buffer[..count], |received| {
            match received {
                Received::Message { lost: before, message } => {
                    (messages, lost) = (messages + 1, lost + u64::from(before));
                    if let Message::Hello { version } = message
                        && std::mem::replace(&mut known, version) != version
                    {
                        warn(&other_version(&name, version));
                    }
                }
                Received::Damaged { .. } => damaged += 1,
            }
            line(&received).into_iter().for_each(|line| text += &(line + "\n"));
        });
        print(&text)?;
    };
    if messages == 0 {
        end?;
        return Err(format!("{name}: no frame of the link in it").into());
    }
    print(&format!("{messages} messages, {lost} lost, {damaged} damaged\n"))?;
    Ok(end?)
}

fn other_version(name: &str, version: u8) -> String {
    match version {
        VERSION => format!("{name}: its sender now speaks version {VERSION} of the link"),
        _ => {
            format!("{name}: its sender speaks version {version} of the link, not {VERSION}: what follows may be wrong")
        }
    }
}
