//! The overview of a segmented scan: one picture in the manner of the paper's Figs. 3 to 5.

use scanseg_core::COUNTS_PER_RAD;
use scanseg_formats::{Geometry, RangeImage};

use crate::overview::ranges::{NO_RETURN, range_title, usual_ranges_m};
use crate::overview::segments::Segments;
use crate::overview::view::{Frame, View};
use crate::picture::{Picture, bearing_colour, edge_colour, label_colour, range_colour, sheet};

/// Sheets are about as wide as this, pixels.
const SHEET_WIDTH: usize = 2100;

/// What a panel shows; every image has the scan's pixels, row by row in scan order.
#[derive(Clone, Copy, Debug)]
pub enum Panel<'a> {
    /// The ranges.
    Ranges,
    /// The segments in colour.
    Segments,
    /// The segments over the ranges.
    Overlay,
    /// Bearing angles, in counts; 0 where there is none.
    Bearings(&'a [u16]),
    /// Some of the pixels, black.
    Pixels(&'a [bool]),
}

/// Draws the overview: these panels with their titles, two side by side unless they are wide. The
/// panel of the ranges has a title of its own.
pub fn overview(segments: &Segments<'_>, panels: &[(&str, Panel<'_>)]) -> Picture {
    let scan = segments.scan;
    let across = if Frame::of(segments.view, scan.rows, scan.columns).width > SHEET_WIDTH / 2 { 1 } else { 2 };
    let frame = segments.frame(SHEET_WIDTH / across);
    let (near_m, far_m) = usual_ranges_m(scan);
    let drawn = |&(title, panel): &(&str, Panel<'_>)| {
        let picture = match panel {
            Panel::Ranges => {
                let colour = |i: usize| range_colour(scan.range_m[i], near_m, far_m);
                return (range_title(near_m, far_m), frame.picture(colour));
            }
            Panel::Segments => segments.coloured(frame),
            Panel::Overlay => segments.over_ranges(frame, (near_m, far_m)),
            Panel::Bearings(counts) => frame.picture(|i| match counts[i] {
                0 => bearing_colour(f32::NAN),
                count => bearing_colour(f32::from(count) / COUNTS_PER_RAD),
            }),
            Panel::Pixels(pixels) => frame.picture(|i| match scan.range_m[i] {
                0.0 => NO_RETURN,
                _ => edge_colour(pixels[i]),
            }),
        };
        (title.to_string(), picture)
    };
    sheet(&panels.iter().map(drawn).collect::<Vec<_>>(), across)
}

/// Returns a simulated scan as in the paper's Fig. 6: its truth (surface ids, 0 for none) and its
/// depth side by side. The truth must have the scan's size.
pub fn truth_and_depth(scan: &RangeImage, geometry: &Geometry, truth: &[u16]) -> Picture {
    let frame = Frame::of(View::of(geometry, scan.rows, scan.columns), scan.rows, scan.columns).within(SHEET_WIDTH / 2);
    let (near_m, far_m) = usual_ranges_m(scan);
    let truth = frame.picture(|i| match truth[i] {
        0 => NO_RETURN,
        id => label_colour(u32::from(id)),
    });
    let depth = frame.picture(|i| range_colour(scan.range_m[i], near_m, far_m));
    sheet(&[("Truth".to_string(), truth), (range_title(near_m, far_m), depth)], 2)
}
