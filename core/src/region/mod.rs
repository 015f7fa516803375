//! The paper's region-based approach: regions that grow by the lines of each row.

mod config;
mod growth;
mod line;
mod rows;
mod segmenter;

pub use config::RegionConfig;
pub use segmenter::RegionSegmenter;
