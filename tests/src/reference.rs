//! The paper's edge-based segmentation (Harati, Gaechter, Siegwart 2006, sections 3 and 4) of a
//! whole range image at once, in f64. Slow and obvious: it is what the streaming segmenter is
//! compared with, and shares no code with it.
//!
//! The second approach of the paper, line-based region growing, is in [`lines`] and [`regions`]; what the default takes for
//! lines and planes, in [`row_lines`] and [`weighted`].
//!
//! Bearing angles along each trace are kept as [counts](bearing::count); every later stage starts
//! from the count images, so that it can be compared pixel by pixel with an implementation whose
//! bearing angles round differently. Where the paper leaves a rule open, the function that applies
//! it says which was chosen.
//!
//! An image of the wrong length is a mistake in the test that made it: the functions panic on it.

pub mod beams;
pub mod bearing;
pub mod closing;
pub mod doubt;
pub mod edges;
mod image;
pub mod labels;
pub mod lines;
pub mod planes;
pub mod regions;
pub mod row_lines;
mod settings;
pub mod weighted;

pub use image::{Image, Size, Trace};
pub use settings::Settings;

use beams::Beams;
use labels::Class;
use planes::Area;

/// What every stage found. All images have the shape of the range image.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// Bearing angles, one count image for each trace.
    pub counts: Vec<Vec<u16>>,
    /// Roof and step edges of all traces.
    pub edges: Vec<bool>,
    /// The edges after closing.
    pub closed: Vec<bool>,
    /// What each pixel is.
    pub classes: Vec<Class>,
    /// The label of each pixel's area, from 1 in scan order of their first pixels; 0 outside of
    /// areas.
    pub labels: Vec<u32>,
    /// The areas, by label.
    pub areas: Vec<Area>,
}

/// Runs all stages. Panics if the image has not one range per pixel or the beams have too few
/// angles.
pub fn segment(image: &Image, beams: &Beams, settings: &Settings) -> Segmentation {
    let counts = settings.traces.iter().map(|&trace| bearing::bearing_counts(image, beams, trace)).collect();
    segment_counts(image, beams, settings, counts)
}

/// Runs the stages after the bearing angles, on given count images: one for each trace, 0 where
/// there is none. Panics as [`segment`] does, and if the count images do not fit.
pub fn segment_counts(image: &Image, beams: &Beams, settings: &Settings, counts: Vec<Vec<u16>>) -> Segmentation {
    let edges = edges::edges(image, settings, &counts);
    let closed = closing::close(image.size, settings.element, &edges);
    let classes = labels::classes(image, &closed);
    let labels = labels::labels(image.size, &classes);
    let areas = planes::areas(image, beams, &labels);
    Segmentation { counts, edges, closed, classes, labels, areas }
}

#[cfg(test)]
mod tests;
