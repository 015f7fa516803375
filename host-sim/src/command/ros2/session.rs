//! What comes of a topic of ROS 2, segmented and published.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use scanseg_core::{AnySegmenter, Beams, LabelRow, Pixel, RowBeams, Segmenter, Sink};
use scanseg_formats::Kind;
use scanseg_formats::ros::{Came, LiveScan, LiveScans};
use scanseg_sim::export::Segmented;
use scanseg_sim::segmentation::{OwnedMemory, Segmentation, SegmentationError};

use crate::command::input::Input;
use crate::command::live::packets::Packets;
use crate::command::live::report::Report;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, warn};
use crate::command::ros2::published::Published;

/// What comes, and what becomes of it.
pub struct Session<'a> {
    pub topic: &'a str,
    pub options: &'a Options,
    /// Smaller segments are left out.
    pub min_pixels: u32,
    pub scans: LiveScans,
    pub packets: Packets<(usize, Vec<u8>)>,
    pub published: Published,
    pub report: Report,
    /// Messages that did not come.
    pub lost: Arc<AtomicU64>,
    /// When the last message came.
    pub came: Instant,
    /// Messages that could not be read.
    pub strange: u64,
    /// Messages that could not be sent.
    pub unsent: u64,
}

impl Session<'_> {
    /// Returns what comes next, none at the end.
    pub fn next(&mut self) -> Option<Came> {
        loop {
            let taken = match self.scans.take() {
                Ok(None) => {
                    let packet = self.packets.next()?;
                    self.came = packet.came;
                    let (topic, message) = packet.content;
                    self.scans.push(topic, &message)
                }
                Ok(came) => return came,
                Err(e) => Err(e),
            };
            if let Err(e) = taken {
                // said once, counted always
                if self.strange == 0 {
                    warn(&format!("{}: {e}", self.topic));
                }
                self.strange += 1;
            }
        }
    }

    /// Segments a scan and publishes it. Returns whether there is to be another.
    pub fn scan(&mut self, live: LiveScan) -> Result<bool, Failure> {
        let LiveScan { scan, stamp_ns, frame, axes } = live;
        let (options, min_pixels) = (self.options, self.min_pixels);
        let input = Input::from(scan);
        let config = options.config(&input.geometry)?;
        let found = Segmentation::of(&input.ranges, &input.geometry, config, options.max_labels(), || {})
            .map_err(|e| in_terms_of_options(&input.name, e))?;
        let segmented = Segmented {
            image: &input.returns(&config.ranging()),
            geometry: &input.geometry,
            ranging: &config.ranging(),
            range_noise_m: &[],
            labels: &found.numbers(min_pixels),
            segments: found.of_pixels(min_pixels),
        };
        self.report.take(input.ranges.rows, &found.segments);
        self.unsent += self.published.send(&segmented, stamp_ns, &frame, axes);
        self.report.packet_done(self.came);
        let (lost, slow) = (self.lost.load(Ordering::Relaxed), self.packets.dropped());
        let (strange, unsent) = (self.strange, self.unsent);
        self.report.turn_done(&format!("lost {lost} messages, {slow} too slow, {strange} strange, {unsent} not sent"))
    }

    /// Segments rows of sweeps and publishes each, from the first of so many columns to the last. Returns
    /// what comes after them.
    pub fn rows(&mut self, first: LiveScan) -> Result<Option<Came>, Failure> {
        let (options, columns) = (self.options, first.scan.image.columns);
        let config = options.config(&first.scan.geometry)?;
        let refused = |e: SegmentationError| in_terms_of_options(self.topic, e);
        let mut memory = OwnedMemory::new(config, columns, options.max_labels());
        let beams = Beams::Free { wraps: false };
        let mut segmenter =
            AnySegmenter::new(config, beams, columns, memory.memory()).map_err(|e| refused(e.into()))?;
        // rows whose labels are still to come
        let mut waiting = VecDeque::new();
        let mut next = Some(Came::Row { row: first, begins: true });
        while let Some(came) = next {
            match came {
                Came::Row { row, .. } if row.scan.image.columns != columns => {
                    return Ok(Some(Came::Row { row, begins: true }));
                }
                Came::Row { row, begins } => {
                    let mut labels = RowLabels::default();
                    if begins {
                        segmenter.finish(&mut labels);
                    }
                    if let Kind::Free { directions, .. } = &row.scan.geometry.kind {
                        let beams = RowBeams::free(directions);
                        segmenter
                            .push_row(&row.scan.image.range_m, beams, &mut labels)
                            .map_err(|e| refused(e.into()))?;
                    }
                    waiting.push_back(row);
                    for labels in labels.0 {
                        let Some(row) = waiting.pop_front() else { break };
                        self.unsent += self.published.send_row(&row, &labels, &config.ranging());
                    }
                }
                Came::Scan(scan) => {
                    if !self.scan(scan)? {
                        return Ok(None);
                    }
                }
            }
            next = self.next();
        }
        Ok(None)
    }
}

/// The labels of rows, one after the other.
#[derive(Default)]
struct RowLabels(Vec<Vec<u32>>);

impl Sink for RowLabels {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        let label = |pixel| if let Pixel::Segment(label) = pixel { label.0 } else { 0 };
        self.0.push(row.pixels().map(label).collect());
        ControlFlow::Continue(())
    }
}
