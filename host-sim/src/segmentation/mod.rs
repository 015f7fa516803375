//! Whole scans through the core: beams and memory from a geometry file, rows pushed one by one,
//! results collected.

mod apart;
mod beams;
mod bearing;
mod collected;
mod error;
mod found;
mod memory;
mod noise;
mod ranging;
mod recorder;
mod whole;

pub use beams::ScanBeams;
pub use bearing::bearing_image;
pub use collected::{Collected, numbered};
pub use error::{SegmentationError, check_size};
pub use memory::{OwnedMemory, enough_labels};
pub use noise::{FoundNoise, stated_noise_m};
pub use ranging::{limited, ranging, ranging_of, states_noise, usual_config, within_limits};
pub use recorder::{RecordedScan, Recorder};
pub use whole::Segmentation;
