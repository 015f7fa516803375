//! What an image has sent: the frames, and the record of its figures.

use scanseg_firmware::figures::{EMPTY_WAITS, MAGIC};
use scanseg_hal::link::{FrameDecoder, Message, Received};

/// Time of an instruction, `-icount shift=6`.
const INSTRUCTION_NS: f64 = 64.0;

/// What was sent over the link.
#[derive(Debug, Default)]
pub struct Summary {
    pub rows: usize,
    pub segments: usize,
    pub planes: usize,
    pub unlabelled: u32,
    /// Bytes that the port lost, as the image reports.
    pub lost: u32,
}

impl Summary {
    /// Reads the frames.
    pub fn of(link: &[u8]) -> Self {
        let mut summary = Self::default();
        FrameDecoder::new().feed(link, |received| match received {
            Received::Message { message: Message::Segment(segment), .. } => {
                summary.segments += 1;
                summary.planes += usize::from(segment.plane.is_some());
            }
            Received::Message { message: Message::ScanFinished(scan), .. } => {
                summary.rows += usize::from(scan.rows);
                summary.unlabelled += scan.unlabelled;
                summary.lost = scan.counters.overruns + scan.counters.queue_full;
            }
            _ => {}
        });
        summary
    }
}

/// Instructions per point, and stack.
pub struct Figures {
    /// From the byte that comes to the label.
    pub labels: f64,
    /// Of what is reported besides: planes, and frames for the host.
    pub frames: f64,
    /// Of the segmenter, within `labels`.
    pub segmenter: f64,
    /// Bytes of stack.
    pub stack: u32,
    /// Most bytes in the queue of the scanner's port.
    pub deepest: u32,
    /// Bytes lost there.
    pub lost: u32,
    /// Thousands of instructions of the dearest row, and of the dearest end of a scan: the
    /// segmenter's.
    pub row: f64,
    pub end: f64,
    /// Thousands of instructions' times from the last byte of a telegram to its labels, at most.
    pub latency: f64,
}

impl Figures {
    /// Reads the record of an image. `sent` is the number of bytes of frames: each was waited for
    /// once.
    pub fn read(record: &[u8], tick_ns: f64, points: f64, sent: usize) -> Option<Self> {
        let words: Vec<u32> = record.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let [MAGIC, ticks, in_segmenter, in_sink, waits, empty_ticks, stack, _, deepest, late, full, row, end, latency] =
            words[..]
        else {
            return None;
        };
        let without_waits = |ticks: u32, waits: f64| {
            let ticks = f64::from(ticks) - waits * f64::from(empty_ticks) / f64::from(EMPTY_WAITS);
            ticks * tick_ns / INSTRUCTION_NS / points
        };
        let sent = sent as f64;
        let (all, frames) = (without_waits(ticks, waits.into()), without_waits(in_sink, sent));
        let segmenter = without_waits(in_segmenter, sent) - frames;
        let [row, end, latency] = [row, end, latency].map(|ticks| 1e-3 * f64::from(ticks) * tick_ns / INSTRUCTION_NS);
        Some(Self { labels: all - frames, frames, segmenter, stack, deepest, lost: late + full, row, end, latency })
    }
}
