//! Messages of the link as lines of text, and the host's end of a link within the program.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

use clap::Args;
use scanseg_hal::link::{FrameDecoder, Message, Received, Reporter, SegmentReport};
use scanseg_hal::rig::Counters;

/// How results are reported.
#[derive(Args)]
pub struct LinkOptions {
    /// Smaller segments are left out
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    pub min_pixels: u32,
    /// Write the frames of the link to this file, for scanseg listen
    #[arg(long, value_name = "FILE")]
    pub link: Option<PathBuf>,
}

/// What has come over the link within the program: lines for the terminal, and its bytes where they
/// are asked for.
#[derive(Default)]
pub struct Host {
    /// Lines that have not been printed.
    pub lines: Vec<String>,
    /// Lines that have been printed.
    pub printed: usize,
    pub bytes: Vec<u8>,
    /// Pixels without a label, of all scans.
    pub unlabelled: u32,
    /// For each scan that is over, the count of lines at its end.
    pub scan_ends: Vec<usize>,
}

impl Host {
    fn take(&mut self, received: &Received) {
        self.lines.extend(line(received));
        if let Received::Message { message: Message::ScanFinished(scan), .. } = received {
            self.unlabelled = self.unlabelled.saturating_add(scan.unlabelled);
            self.scan_ends.push(self.printed + self.lines.len());
        }
    }

    /// Takes the lines that are to be printed, up to so many since the beginning.
    pub fn take_lines(&mut self, until: usize) -> Vec<String> {
        let count = until.saturating_sub(self.printed).min(self.lines.len());
        self.printed += count;
        self.lines.drain(..count).collect()
    }
}

impl LinkOptions {
    /// Returns a reporter whose frames come to `host`.
    pub fn reporter(&self, host: &Rc<RefCell<Host>>) -> Reporter<impl FnMut(&[u8]) + use<>> {
        let (host, mut decoder, keeps_bytes) = (Rc::clone(host), FrameDecoder::new(), self.link.is_some());
        Reporter::new(self.min_pixels, move |frame: &[u8]| {
            let mut host = host.borrow_mut();
            if keeps_bytes {
                host.bytes.extend(frame);
            }
            decoder.feed(frame, |received| host.take(&received));
        })
    }
}

/// Returns a line, for what deserves one: joins and greetings do not.
pub fn line(received: &Received) -> Option<String> {
    let (lost, message) = match received {
        Received::Damaged { bytes } => return Some(format!("damaged: {bytes} bytes")),
        Received::Message { lost, message } => (*lost, message),
    };
    let text = match message {
        Message::Hello { .. } | Message::Join { .. } => None,
        Message::ScanStarted(scan) => {
            Some(format!("scan {}: {} columns, from {:.1} deg", scan.number, scan.columns, scan.turn_rad.to_degrees()))
        }
        Message::Segment(segment) => Some(segment_line(segment)),
        Message::ScanFinished(scan) => {
            let end = format!("{:?}", scan.end).to_lowercase();
            let unlabelled = match scan.unlabelled {
                0 => String::new(),
                pixels => format!(", {pixels} pixels without a label: the table of live labels was full"),
            };
            let counters = counters_line(&scan.counters);
            Some(format!("scan {} over ({end}): {} rows{unlabelled}\n{counters}", scan.number, scan.rows))
        }
        Message::Status(counters) => Some(counters_line(counters)),
        Message::Trouble(trouble) => Some(format!("trouble: {trouble}")),
    };
    match (lost, text) {
        (0, text) => text,
        (lost, None) => Some(format!("lost: {lost} frames")),
        (lost, Some(text)) => Some(format!("lost: {lost} frames\n{text}")),
    }
}

fn segment_line(segment: &SegmentReport) -> String {
    let SegmentReport { label, pixels, first_row, last_row, first_column, last_column, .. } = segment;
    let plane = segment.plane.map_or("no plane".to_string(), |plane| {
        let [x, y, z] = plane.normal;
        format!("plane at {:.3} m, normal ({x:.3}, {y:.3}, {z:.3}), rms {:.1} mm", plane.distance_m, 1e3 * plane.rms_m)
    });
    format!(
        "segment {label}: {pixels} pixels, rows {first_row}-{last_row}, columns {first_column}-{last_column}, {plane}"
    )
}

/// Returns what was counted; reasons only where there is something to tell.
pub fn counters_line(counters: &Counters) -> String {
    let Counters { bytes, telegrams, rejected, lost, rows, segments, .. } = *counters;
    let mut text = format!(
        "so far {bytes} bytes, {telegrams} telegrams, {lost} lost, {rejected} rejected, {rows} rows, {segments} segments"
    );
    for (count, why) in [
        (counters.no_turn, "without turn angle"),
        (counters.standing, "while the tilt stood"),
        (counters.jump, "at a jump of the tilt"),
        (counters.alone, "off the sweep"),
        (counters.status, "with an error of the scanner"),
        (counters.columns, "of other columns"),
        (counters.stopped, "after the end"),
        (counters.refused, "refused"),
        (counters.encoder_errors, "encoder errors"),
        (counters.troubles, "troubles"),
        (counters.overruns, "bytes taken too late"),
        (counters.queue_full, "bytes before a full queue"),
    ] {
        if count > 0 {
            text += &format!(", {count} {why}");
        }
    }
    text
}
