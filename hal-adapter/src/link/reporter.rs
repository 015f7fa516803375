//! From the results of a rig to frames.

use core::ops::ControlFlow;

use scanseg_core::{Join, LabelRow, Segment, Sink};

use super::frame::MAX_FRAME;
use super::message::{Message, VERSION};
use super::write::FrameEncoder;
use crate::lms2xx::Trouble;
use crate::rig::{RigSink, ScanFinished, ScanStarted};

/// A sink that makes frames of the results of a rig.
#[derive(Debug)]
pub struct Reporter<F> {
    encoder: FrameEncoder,
    min_pixels: u32,
    send: F,
}

impl<F: FnMut(&[u8])> Reporter<F> {
    /// Returns a sink that gives each frame to `send`, and sends [`Message::Hello`]. Segments of
    /// fewer than `min_pixels` pixels are left out; their planes are not computed.
    pub fn new(min_pixels: u32, send: F) -> Self {
        let mut reporter = Self { encoder: FrameEncoder::new(), min_pixels, send };
        reporter.send(&Message::Hello { version: VERSION });
        reporter
    }

    /// Sends a message, for instance a [`Message::Status`].
    pub fn send(&mut self, message: &Message) {
        let mut buffer = [0; MAX_FRAME];
        if let Ok(frame) = self.encoder.encode(message, &mut buffer) {
            (self.send)(frame);
        }
    }
}

impl<F: FnMut(&[u8])> Sink for Reporter<F> {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.send(&Message::Join { from: join.from.0, into: join.into.0 });
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if segment.pixels() >= self.min_pixels {
            self.send(&Message::Segment(segment.into()));
        }
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&[u8])> RigSink for Reporter<F> {
    fn scan_started(&mut self, scan: &ScanStarted) {
        self.send(&Message::ScanStarted(*scan));
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.send(&Message::ScanFinished(*scan));
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.send(&Message::Trouble(trouble));
    }
}
