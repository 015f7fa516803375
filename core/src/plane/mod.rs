//! The default: planes that go on from row to row.

mod areas;
mod config;
mod follow;
mod join;
mod line;
mod noise;
mod row;
mod rules;
mod segmenter;
mod turn;

pub use config::PlaneConfig;
pub use noise::NoiseModel;
pub use rules::Rules;
pub use segmenter::PlaneSegmenter;
