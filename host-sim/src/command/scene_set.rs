//! The sets of simulated scenes as values of an option.

use clap::ValueEnum;
use scanseg_sim::office::Set;

#[derive(Clone, Copy, ValueEnum)]
pub enum SetName {
    /// For choosing parameters
    Tuning,
    /// For measuring what was chosen
    Validation,
}

impl SetName {
    pub fn set(self) -> Set {
        match self {
            SetName::Tuning => Set::Tuning,
            SetName::Validation => Set::Validation,
        }
    }
}
