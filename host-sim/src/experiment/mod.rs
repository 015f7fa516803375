//! The experiment of the paper (section 5, Figs. 6 to 9): every method on every scene of a set of
//! simulated offices, at several levels of noise, counted by the classes of Hoover et al.; and what
//! a method costs as scans grow.
//!
//! ```no_run
//! use scanseg_sim::experiment::{Results, report};
//! use scanseg_sim::office::{SCENES, Set};
//!
//! fn main() -> Result<(), std::io::Error> {
//!     let results = Results::of(Set::Tuning, SCENES, || {});
//!     for (name, bytes) in report::files(&results) {
//!         println!("{name}");
//!         std::fs::write(name, bytes)?;
//!     }
//!     Ok(())
//! }
//! ```
//!
//! All of it is the same on every platform and at every run: the cost is counted, not timed.

pub mod chart;
pub mod claims;
pub mod cost;
mod counts;
pub mod drawing;
pub mod figures;
#[cfg(test)]
mod made_up;
mod method;
pub mod report;
mod results;
pub mod rim;
mod runs;
pub mod sample;
mod scans;
pub mod tables;

pub use counts::Counts;
pub use method::{COMPARED_AT, DEFAULT, EDGE, METHODS, MIN_PIXELS, Method, NOISES_MM, REGION, SIZE, TOLERANCES};
pub use results::Results;
pub use runs::{Run, runs};
