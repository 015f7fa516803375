//! Pictures of scans: a small RGB canvas with lines and text, the colours of ranges, labels, bearing
//! angles and edges, and sheets of titled panels like the figures of a paper.
//!
//! x goes to the right and y downwards, in pixels; pixel (0, 0) reaches from 0 to 1. What lies
//! outside of a picture is not drawn.

mod canvas;
mod colours;
mod sheet;
mod text;

pub use canvas::{BLACK, Picture, Rgb, WHITE, mixed};
pub use colours::{bearing_colour, edge_colour, label_colour, range_colour};
pub use sheet::sheet;
pub use text::{Anchor, TextStyle, text_width};
