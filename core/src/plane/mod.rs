//! The default: planes that go on from row to row.

mod config;
mod fit;
mod follow;
mod join;
mod line;
mod noise;
mod rules;
mod scanline;
mod segmenter;
mod surface;
mod turn;

pub use config::PlaneConfig;
pub use rules::Rules;
pub use segmenter::PlaneSegmenter;
