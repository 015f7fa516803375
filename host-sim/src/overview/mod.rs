//! Pictures of a segmented scan, up being up and left being left as the scanner sees them, whatever
//! the order in which it delivers rows and columns.

mod legend;
mod numbers;
mod panels;
mod ranges;
mod segments;
mod view;

pub use legend::Line;
pub use panels::{Panel, overview, truth_and_depth};
pub use ranges::usual_ranges_m;
pub use segments::{Segments, overlay, segments};
pub use view::View;

pub(crate) use ranges::{NO_RETURN, range_title};
pub(crate) use view::Frame;
