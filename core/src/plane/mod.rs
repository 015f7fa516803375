//! The default: planes that go on from row to row.

mod alike;
mod areas;
mod borders;
mod bridge;
mod carried;
mod config;
mod follow;
mod grower;
mod join;
mod line;
mod marks;
mod measure;
mod median;
mod neighbours;
mod noise;
mod rules;
mod run_sums;
mod scanline;
mod segmenter;
mod stretch;
mod tried;
mod turn;
mod work;

pub use config::PlaneConfig;
pub use rules::Rules;
pub use segmenter::PlaneSegmenter;
