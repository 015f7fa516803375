//! What is known of the ranges of some scanners and cameras.
//!
//! Noise that is stated too small does no harm to planes: what the scan itself tells counts where
//! it is more. So where sources differ the smaller number stands here. How flat surfaces are is no
//! property of a sensor and stays 0; the limits are those of [`Ranging::new`]. Edges and regions know
//! constant noise only: for a sensor whose noise grows they need another number.

use crate::config::Ranging;

/// Radians of this many degrees.
const fn degrees(deg: f32) -> f32 {
    deg * (core::f32::consts::PI / 180.0)
}

/// Sensors by name. Each says where its numbers are from, and which of them are estimates.
impl Ranging {
    /// SICK LMS 200, in its mode of millimetres: 5 mm.
    ///
    /// The statistical error, one standard deviation up to 8 m, of SICK's technical description;
    /// recorded scans of an LMS 2xx on a tilt measure 4 mm. Steps are 1 mm; in the mode of
    /// centimetres they are 10 mm. The direction of a beam, 0.02 deg, is an estimate.
    pub const SICK_LMS200: Ranging = Ranging::new(0.005).with_steps(0.001, 0.0).with_beam_noise_rad(degrees(0.02));

    /// Microsoft Kinect of the first version, and others with PrimeSense's pattern: 1.2 mm at 1 m,
    /// growing with the square of the range, in steps of 2.85 mm at 1 m.
    ///
    /// Khoshelham and Oude Elberink (Sensors 2012, 12, 1437): half a pixel of disparity is 1.425 mm
    /// at 1 m and the step between two disparities 2.85 mm; rounding to steps has 0.82 mm of the
    /// first, and 1.16 mm are left. Errors that are alike over 4 pixels are an estimate.
    pub const KINECT_V1: Ranging =
        Ranging::new(0.0).with_growing_noise(0.0, 0.001_16).with_steps(0.0, 0.002_85).with_correlation_px(4.0);

    /// Intel RealSense D435 at 848 x 480 pixels: 3.75 mm at 1 m, growing with the square of the
    /// range.
    ///
    /// Intel's white papers: 848 pixels over 90 deg make a focal length of 424 pixels, the baseline
    /// is 50 mm, disparities come in 1/32 pixel: steps of 1.47 mm at 1 m. A disparity noise of 0.08
    /// pixel, of which rounding is a part, is an estimate, and so are errors that are alike over 4
    /// pixels. Counts are 1 mm.
    pub const REALSENSE_D435: Ranging =
        Ranging::new(0.0).with_growing_noise(0.0, 0.003_75).with_steps(0.001, 0.001_47).with_correlation_px(4.0);

    /// Microsoft Azure Kinect: 1 mm and 0.4 mm at 1 m that grow with the square of the range.
    ///
    /// Microsoft states 17 mm or less; Tölgyessy et al. (Sensors 2021, 21, 413) confirm that bound
    /// up to 3.5 m, with far less on bright targets that are near. The two numbers are an estimate
    /// below it: 4.6 mm at 3 m. Counts are 1 mm. Errors that are alike over 2 pixels are an
    /// estimate.
    pub const AZURE_KINECT: Ranging =
        Ranging::new(0.001).with_growing_noise(0.0, 0.0004).with_steps(0.001, 0.0).with_correlation_px(2.0);

    /// Ouster OS0, revision 7: 8 mm and 0.86 mm for each metre.
    ///
    /// A line through the precision in the data sheet of revision 7, as the OpenPLX library of
    /// sensors draws it. Steps of 1 mm, beams to 0.01 deg: data format, data sheet.
    pub const OUSTER_OS0: Ranging =
        Ranging::new(0.008).with_growing_noise(0.000_86, 0.0).with_steps(0.001, 0.0).with_beam_noise_rad(degrees(0.01));

    /// Ouster OS1, revision 7: 5 mm and 0.44 mm for each metre.
    ///
    /// The slope is that of OpenPLX's line through the precision in the data sheet of revision 7;
    /// the constant is an estimate. The first revision is coarser: 15 mm in steps of 12 mm. Steps
    /// of 1 mm, beams to 0.01 deg: data format, data sheet.
    pub const OUSTER_OS1: Ranging =
        Ranging::new(0.005).with_growing_noise(0.000_44, 0.0).with_steps(0.001, 0.0).with_beam_noise_rad(degrees(0.01));

    /// Velodyne VLP-16: 10 mm.
    ///
    /// An estimate, a third of the accuracy of 30 mm in the data sheet. Steps of 2 mm: user manual.
    /// The direction of a beam, 0.01 deg, is the step of the azimuths that it sends.
    pub const VELODYNE_VLP16: Ranging = Ranging::new(0.01).with_steps(0.002, 0.0).with_beam_noise_rad(degrees(0.01));

    /// LDROBOT LD06: 10 mm.
    ///
    /// The standard deviation from 0.3 m to 12 m in the data sheet of the LD19, which measures
    /// alike; steps of 15 mm are said there, and counted in. The direction of a beam, 0.1 deg, is
    /// an estimate: a packet has the angles of its first and last beam only.
    pub const LD06: Ranging = Ranging::new(0.01).with_steps(0.001, 0.0).with_beam_noise_rad(degrees(0.1));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sensor_can_be_used() {
        for ranging in [
            Ranging::SICK_LMS200,
            Ranging::KINECT_V1,
            Ranging::REALSENSE_D435,
            Ranging::AZURE_KINECT,
            Ranging::OUSTER_OS0,
            Ranging::OUSTER_OS1,
            Ranging::VELODYNE_VLP16,
            Ranging::LD06,
        ] {
            assert_eq!(ranging.check(), Ok(()), "{ranging:?}");
        }
    }

    #[test]
    fn half_a_pixel_of_disparity_is_the_error_of_a_kinect() {
        let Ranging { range_noise_per_m2: noise, range_step_per_m2: step, .. } = Ranging::KINECT_V1;
        let all = (noise * noise + step * step / 12.0).sqrt();
        assert!((all - step / 2.0).abs() < 1e-5, "{all}");
    }
}
