//! How a scan is segmented: noise, limits and approach.

use pyo3::prelude::*;
use scanseg_core::{AnyConfig, Approach};
use scanseg_formats::{Geometry, SENSORS, Sensor};
use scanseg_sim::segmentation::{limited, ranging_of, usual_config};

use crate::beams::check;
use crate::value_error;

/// What is said of the noise of the ranges.
#[derive(FromPyObject)]
pub enum Noise {
    /// Standard deviation of a range, metres.
    Metres(f64),
    /// The name of a sensor.
    Sensor(String),
}

/// What is said of a scan besides its beams.
pub struct Settings {
    /// Its noise, in place of that of the beams.
    pub noise: Option<Noise>,
    /// How it is segmented.
    pub approach: String,
    /// Metres of one count.
    pub unit_m: Option<f64>,
    /// Nearer ranges are no returns, metres.
    pub min_range_m: Option<f64>,
    /// Farther ranges are no returns, metres.
    pub max_range_m: Option<f64>,
}

impl Settings {
    /// Puts the unit and the errors that are said into a geometry.
    pub fn apply(&self, geometry: &mut Geometry) -> PyResult<()> {
        geometry.unit_m = self.unit_m.unwrap_or(geometry.unit_m);
        match &self.noise {
            Some(Noise::Metres(noise_m)) => geometry.range_noise_m = Some(*noise_m),
            Some(Noise::Sensor(name)) => {
                let sensor = Sensor::named(name).ok_or_else(|| {
                    let names = SENSORS.map(|sensor| sensor.name).join(", ");
                    value_error(format!("noise: '{name}', must be metres or one of {names}"))
                })?;
                (geometry.range_noise_m, geometry.noise) = (Some(sensor.range_noise_m()), sensor.noise());
            }
            None => {}
        }
        check(geometry).map_err(value_error)
    }

    /// Returns the configuration for scans of a geometry.
    pub fn config(&self, geometry: &Geometry) -> PyResult<AnyConfig<'static>> {
        let approach = match self.approach.as_str() {
            "plane" => Approach::Plane,
            "edge" => Approach::Edge,
            "region" => Approach::Region,
            other => return Err(value_error(format!("approach: '{other}', must be plane, edge or region"))),
        };
        let ranging = limited(ranging_of(geometry, approach), self.min_range_m, self.max_range_m);
        Ok(usual_config(approach, ranging))
    }
}

/// Returns what makes metres of whole numbers; of real ones, which are metres, 1 if nothing is said.
pub fn unit_m(what: &str, whole: Option<&str>, said: Option<f64>, of_beams: Option<f64>) -> PyResult<f64> {
    match (said, whole, of_beams) {
        (Some(unit_m), ..) => Ok(unit_m),
        (None, None, _) => Ok(1.0),
        (None, Some(_), Some(unit_m)) => Ok(unit_m),
        (None, Some(name), None) => {
            Err(value_error(format!("{what}: counts of type {name} need unit_m, the metres of one count")))
        }
    }
}
