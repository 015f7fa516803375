//! Segments in colour with their labels, alone and over the ranges.

use scanseg_formats::RangeImage;

use crate::overview::legend::{Line, legend};
use crate::overview::numbers::places;
use crate::overview::ranges::{NO_RETURN, usual_ranges_m};
use crate::overview::view::{Frame, View};
use crate::picture::{Anchor, BLACK, Picture, Rgb, TextStyle, WHITE, label_colour, mixed};

/// Both sides of a picture of segments are within this, pixels.
const LIMIT: usize = 2100;

/// A segmented scan; every image has its pixels, row by row in scan order.
#[derive(Clone, Copy, Debug)]
pub struct Segments<'a> {
    /// The scan.
    pub scan: &'a RangeImage,
    /// How it is turned.
    pub view: View,
    /// Label of the listed segment that each pixel is in; 0 for none.
    pub labels: &'a [u32],
    /// Pixels with a return that are in no segment because they are edges, if there are such.
    pub edges: Option<&'a [bool]>,
}

/// Returns the segments in colour, their labels where there is room for them, and a legend below.
/// Edges are black, other returns in no listed segment dark grey.
pub fn segments(segments: &Segments<'_>, lines: &[Line]) -> Picture {
    with_legend(segments.coloured(segments.frame(LIMIT)), lines)
}

/// Returns the segments in colour over the ranges in grey, near ones bright; labels and legend as
/// in [`segments`].
pub fn overlay(segments: &Segments<'_>, lines: &[Line]) -> Picture {
    with_legend(segments.over_ranges(segments.frame(LIMIT), usual_ranges_m(segments.scan)), lines)
}

fn with_legend(picture: Picture, lines: &[Line]) -> Picture {
    let legend = legend(picture.width(), lines);
    let mut whole = Picture::new(picture.width().max(legend.width()), picture.height() + legend.height(), WHITE);
    whole.blit(0, 0, &picture);
    whole.blit(0, picture.height(), &legend);
    whole
}

impl Segments<'_> {
    /// Returns a frame for pictures with both sides within `limit`.
    pub(super) fn frame(&self, limit: usize) -> Frame {
        Frame::of(self.view, self.scan.rows, self.scan.columns).within(limit)
    }

    /// The segments in colour, with borders and labels.
    pub(super) fn coloured(&self, frame: Frame) -> Picture {
        let colour = |i: usize| match self.labels[i] {
            _ if self.edges.is_some_and(|edges| edges[i]) => BLACK,
            _ if self.scan.range_m[i] == 0.0 => NO_RETURN,
            label => label_colour(label),
        };
        self.marked(frame, frame.picture(colour))
    }

    /// The segments in colour over the ranges in grey, the nearest bright and the farthest dark, with
    /// borders and labels.
    pub(super) fn over_ranges(&self, frame: Frame, (near_m, far_m): (f32, f32)) -> Picture {
        let grey = |range_m: f32| -> Rgb {
            let far = ((range_m - near_m) / (far_m - near_m)).clamp(0.0, 1.0);
            [(235.0 - 185.0 * if far.is_nan() { 0.0 } else { far }) as u8; 3]
        };
        let colour = |i: usize| match (self.scan.range_m[i], self.labels[i]) {
            (0.0, _) => BLACK,
            (range_m, 0) => grey(range_m),
            (range_m, label) => mixed(grey(range_m), label_colour(label), 0.55),
        };
        self.marked(frame, frame.picture(colour))
    }

    /// Draws the borders of the segments and their labels.
    fn marked(&self, frame: Frame, mut picture: Picture) -> Picture {
        let (width, height) = (frame.width, frame.height);
        let shown = frame.shown(|i| self.labels[i]);
        for (y, row) in shown.chunks_exact(width).enumerate() {
            let below = shown.get((y + 1) * width..).unwrap_or_default();
            for (x, &label) in row.iter().enumerate().filter(|(_, label)| **label != 0) {
                let is_border = |other: Option<&u32>| other.is_some_and(|&other| other != 0 && other != label);
                if is_border(row.get(x + 1)) || is_border(below.get(x)) {
                    picture.put(x, y, BLACK);
                }
            }
        }
        // where the picture is larger than the scan, the scan says as much with fewer pixels
        let scan = Frame::of(self.view, self.scan.rows, self.scan.columns);
        let basis = if scan.width * scan.height < width * height { scan } else { frame };
        let (across, down) = (width as f32 / basis.width as f32, height as f32 / basis.height as f32);
        for (label, place) in places(&basis.shown(|i| self.labels[i]), basis.width) {
            let room = place.room * across.min(down);
            let text = label.to_string();
            let size = (1.1 * room).min(30.0);
            // as high as the room, and no wider
            let size = size.min(3.0 * room / text.len() as f32);
            if size >= 13.0 {
                let style = TextStyle { anchor: Anchor::Middle, halo: Some(WHITE), ..TextStyle::new(size, BLACK) };
                let (x, y) = (across * (place.x as f32 + 0.5), down * (place.y as f32 + 0.5));
                picture.text((x, y + 0.36 * size), style, &text);
            }
        }
        picture
    }
}
