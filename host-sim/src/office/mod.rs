//! A simulated office: furnished rooms seen by a simulated scanner, with the surface that each beam
//! meets.
//!
//! ```
//! use scanseg_sim::office::{Scene, Sensor, SensorError, Set};
//!
//! fn main() -> Result<(), SensorError> {
//!     let mut sensor = Sensor::nodding(100, 181);
//!     sensor.range_noise_m = 0.005;
//!     let scan = Scene::numbered(Set::Tuning, 3).scan(&sensor, 1)?;
//!     println!("{} ranges, the first is {:.3} m", scan.range_m.len(), scan.range_m[0]);
//!     Ok(())
//! }
//! ```
//!
//! Rooms are 5 to 9 m long and 4 to 7 m wide, with windows that return nothing, a door, and
//! furniture made of many small surfaces; the scanner stands in them at 0.5 to 1.2 m, level. Every
//! number comes from a generator and from functions that give the same bits on every platform. At
//! 200 x 361 pixels over 100 x 180 degrees a scene shows 13 to 37 surfaces of 30 pixels or more:
//! 619 in the 25 tuning scenes, 656 in the 25 validation scenes.
//!
//! There are halls, attics with stairs, and streets with trees as well: [`Scene::hall`],
//! [`Scene::attic`], [`Scene::street`].

mod body;
mod furniture;
mod house;
mod layouts;
mod rng;
mod room;
mod scene;
mod sensor;
mod set;
mod street;
mod troubles;

pub use rng::Rng;
pub use scene::Scene;
pub use sensor::{Sensor, SensorError, SimulatedScan};
pub use set::{SCENES, Set};
pub use troubles::{Missing, Trouble};
