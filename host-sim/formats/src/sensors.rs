//! Sensors by name, for geometry files and command lines.

use scanseg_core::Ranging;

use crate::noise::Noise;

/// A sensor whose errors are known, see [`SENSORS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Its name in geometry files.
    pub name: &'static str,
    /// Its name in print.
    pub title: &'static str,
    /// What is known of its ranges. The documentation of the constant says where it is from.
    pub ranging: Ranging,
}

/// All sensors that have a name.
pub const SENSORS: [Sensor; 8] = [
    Sensor { name: "sick-lms200", title: "SICK LMS 200", ranging: Ranging::SICK_LMS200 },
    Sensor { name: "kinect-v1", title: "Microsoft Kinect, first version", ranging: Ranging::KINECT_V1 },
    Sensor { name: "realsense-d435", title: "Intel RealSense D435", ranging: Ranging::REALSENSE_D435 },
    Sensor { name: "azure-kinect", title: "Microsoft Azure Kinect", ranging: Ranging::AZURE_KINECT },
    Sensor { name: "ouster-os0", title: "Ouster OS0", ranging: Ranging::OUSTER_OS0 },
    Sensor { name: "ouster-os1", title: "Ouster OS1", ranging: Ranging::OUSTER_OS1 },
    Sensor { name: "velodyne-vlp16", title: "Velodyne VLP-16", ranging: Ranging::VELODYNE_VLP16 },
    Sensor { name: "ld06", title: "LDROBOT LD06", ranging: Ranging::LD06 },
];

/// What an unknown name must be.
pub(crate) const KNOWN: &str = "one of sick-lms200, kinect-v1, realsense-d435, azure-kinect, ouster-os0, ouster-os1, \
     velodyne-vlp16, ld06";

impl Sensor {
    /// Returns the sensor of a name.
    pub fn named(name: &str) -> Option<Sensor> {
        SENSORS.into_iter().find(|sensor| sensor.name == name)
    }

    /// Returns the constant noise of its ranges, metres.
    pub fn range_noise_m(&self) -> f64 {
        decimal(self.ranging.range_noise_m)
    }

    /// Returns its further errors, in the units of a geometry file.
    pub fn noise(&self) -> Noise {
        let Ranging { range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2, .. } = self.ranging;
        let Ranging { noise_correlation_px, beam_noise_rad, turn_noise_rad, flatness_m, .. } = self.ranging;
        Noise {
            range_noise_per_m: decimal(range_noise_per_m),
            range_noise_per_m2: decimal(range_noise_per_m2),
            range_step_m: decimal(range_step_m),
            range_step_per_m2: decimal(range_step_per_m2),
            noise_correlation_px: decimal(noise_correlation_px),
            beam_noise_deg: decimal(beam_noise_rad.to_degrees()),
            turn_noise_deg: decimal(turn_noise_rad.to_degrees()),
            flatness_m: decimal(flatness_m),
        }
    }
}

/// The number as it was written, to five digits: 0.005 and not 0.004999999888.
fn decimal(x: f32) -> f64 {
    format!("{x:.4e}").parse().unwrap_or_else(|_| x.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sensor_has_a_name_of_its_own_that_errors_list() {
        let listed: Vec<_> = KNOWN.trim_start_matches("one of ").split(", ").collect();
        assert_eq!(listed, SENSORS.map(|sensor| sensor.name));
        for sensor in SENSORS {
            assert_eq!(Sensor::named(sensor.name), Some(sensor));
        }
        assert_eq!(Sensor::named("sick"), None);
    }

    #[test]
    fn numbers_are_those_that_were_written() {
        let sensor = Sensor::named("ouster-os0").unwrap();
        let noise = Noise { range_noise_per_m: 0.00086, range_step_m: 0.001, beam_noise_deg: 0.01, ..Noise::NONE };
        assert_eq!((sensor.range_noise_m(), sensor.noise()), (0.008, noise));
    }
}
