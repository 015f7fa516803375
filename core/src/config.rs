//! What a user sets before the first row. Checked once, when a segmenter is made; it does not change afterwards.

use crate::error::ConfigError;

/// The largest `max_range_m`, metres. Up to it the moments of a segment stay exact for 2 million points.
pub const MAX_RANGE_M: f32 = 500.0;

/// The largest row offset of a [`Trace`].
pub const MAX_TRACE_ROWS: u8 = 16;

/// The largest number of traces.
pub const MAX_TRACES: usize = 8;

/// A direction through the range image, as the offset from a pixel back to the previous pixel on the trace.
///
/// The paper takes any trace (section 3); an offset of more than one pixel is the same trace with a longer baseline,
/// which divides the noise of the bearing angle by its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trace {
    /// The previous pixel is so many rows earlier, 0 to [`MAX_TRACE_ROWS`].
    pub rows: u8,
    /// The previous pixel is so many columns to the left; negative (only with `rows` above 0) is to the right.
    pub columns: i8,
}

impl Trace {
    /// Along a row: previous pixel to the left. The paper's horizontal trace.
    pub const ROW: Trace = Trace { rows: 0, columns: 1 };
    /// Along a column: previous pixel above. The paper's vertical trace.
    pub const COLUMN: Trace = Trace { rows: 1, columns: 0 };
    /// Previous pixel above and to the left.
    pub const DIAGONAL: Trace = Trace { rows: 1, columns: 1 };
    /// Previous pixel above and to the right.
    pub const ANTIDIAGONAL: Trace = Trace { rows: 1, columns: -1 };

    /// The same direction with a baseline `k` times as long. Saturates.
    pub const fn times(self, k: u8) -> Trace {
        let columns = self.columns as i16 * k as i16;
        let columns = if columns > 127 {
            127
        } else if columns < -128 {
            -128
        } else {
            columns as i8
        };
        Trace { rows: self.rows.saturating_mul(k), columns }
    }
}

/// Structuring element of the closing, 3 x 3 pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Element {
    /// A pixel and its four neighbours: the paper's.
    Plus,
    /// All nine pixels. Also seals gaps of one or two pixels in the ridges that Sobel draws, which the plus does not.
    Square,
}

/// Settings of the segmentation, by either approach; those that only one uses say so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config<'a> {
    /// Standard deviation of one range, metres; 0 to 10. Edge-based: a step edge needs a range change beyond
    /// 3 sqrt(2) of it: three standard deviations of the difference of two ranges. Region-based: it decides how long the
    /// chords are that show a turn, and with `plane_distance_m` how far a line may be from a plane.
    pub range_noise_m: f32,
    /// Nearer ranges count as no return, metres; above 0, up to `max_range_m`.
    pub min_range_m: f32,
    /// Farther ranges count as no return, metres; up to [`MAX_RANGE_M`].
    pub max_range_m: f32,
    /// Edge-based approach: the traces whose edges are combined; 1 to [`MAX_TRACES`].
    pub traces: &'a [Trace],
    /// Edge-based approach: a roof edge is where the bearing angle turns by at least this much, radians; above 0, up to pi.
    /// (Sobel's sum of weights is 4: |Gx| + |Gy| reaches 4 times this.)
    pub roof_angle_rad: f32,
    /// Edge-based approach: a step edge needs a bearing angle within this of 0 or of pi, radians; 0 to pi / 2.
    pub step_angle_rad: f32,
    /// Edge-based approach: structuring element of the closing.
    pub closing: Element,
    /// Region-based approach: a line of a row ends where the bearing angle turns by at least this much, radians; above 0,
    /// up to pi / 2.
    pub line_angle_rad: f32,
    /// Region-based approach: how far from a plane a surface may be for other reasons than the noise, metres; 0 to 1. A
    /// line joins a region whose plane both of its ends are near: within this and 4 standard deviations.
    pub plane_distance_m: f32,
}

impl Config<'_> {
    /// The paper's method. What the paper fixes: bearing angles along rows and columns between neighbouring pixels,
    /// Sobel on each image, step edges, OR, closing with a plus. What it leaves open, and what stands here:
    ///
    /// - `roof_angle_rad` = 20 deg. Two walls meet at 90 deg, the faces of furniture rarely at less than 30; the bearing
    ///   angle of a flat surface itself changes by the beam step, 2 deg per two pixels at most on usual scanners.
    /// - `step_angle_rad` = 6 deg. A floor 0.5 m below the scanner is seen at 6 deg from 4.8 m on; a larger value cuts
    ///   it nearer, a smaller one lets jumps of less than ten times the beam spacing pass.
    /// - `range_noise_m` = 0.01: the scanner of the paper (SICK LMS 200) by its data sheet's typical figure.
    /// - `min_range_m` = 0.05, `max_range_m` = 100: no limit for indoor scanners.
    /// - `line_angle_rad` = 3 deg: a turn of less is that of the azimuth steps on a spinning scanner's floor. Of lines that
    ///   are broken too early nothing is lost, and lines that run on around a corner join no region: on the simulated
    ///   offices 65, 64, 60 and 46 % of the surfaces are found with 2, 3, 5 and 10 deg, without noise.
    /// - `plane_distance_m` = 5 mm: walls and desks are flat to that. 3 mm find 60 % of the same surfaces, 8 mm
    ///   65 %.
    /// - Pixels without a return are no edges and belong to no area; a missing neighbour under the Sobel kernel takes
    ///   the value of the centre, so that it makes no gradient.
    pub const fn paper() -> Config<'static> {
        Config {
            range_noise_m: 0.01,
            min_range_m: 0.05,
            max_range_m: 100.0,
            traces: &[Trace::ROW, Trace::COLUMN],
            roof_angle_rad: 20.0 * core::f32::consts::PI / 180.0,
            step_angle_rad: 6.0 * core::f32::consts::PI / 180.0,
            closing: Element::Plus,
            line_angle_rad: 3.0 * core::f32::consts::PI / 180.0,
            plane_distance_m: 0.005,
        }
    }

    /// For [`PlaneSegmenter`](crate::PlaneSegmenter), which needs nothing but the standard deviation of one range, metres,
    /// 0 to 10. The rest is as in [`Config::paper`].
    pub const fn new(range_noise_m: f32) -> Config<'static> {
        Config { range_noise_m, ..Config::paper() }
    }

    /// Range change beyond which a step edge is possible, metres.
    pub(crate) fn step_range_m(&self) -> f32 {
        3.0 * core::f32::consts::SQRT_2 * self.range_noise_m
    }

    /// The highest bit says whether a range is no return; the others mean nothing.
    #[inline(always)]
    pub(crate) fn no_return(&self, range_m: f32) -> u32 {
        // the bits of positive numbers are in the order of the numbers, those of NaN and of negative numbers are above them
        let [least, most, range] = [self.min_range_m, self.max_range_m, range_m].map(f32::to_bits);
        let (above, room) = (range.wrapping_sub(least), most.wrapping_sub(least));
        above | room.wrapping_sub(above)
    }

    /// The range of a return, 0 for none.
    #[inline(always)]
    pub(crate) fn clean(&self, range_m: f32) -> f32 {
        if self.no_return(range_m) >> 31 == 0 { range_m } else { 0.0 }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        use core::f32::consts::{FRAC_PI_2, PI};
        let within = |field, value: f32, ok: bool| if ok { Ok(()) } else { Err(ConfigError::Value { field, value }) };
        within("range_noise_m", self.range_noise_m, (0.0..=10.0).contains(&self.range_noise_m))?;
        within("max_range_m", self.max_range_m, self.max_range_m > 0.0 && self.max_range_m <= MAX_RANGE_M)?;
        within("min_range_m", self.min_range_m, self.min_range_m > 0.0 && self.min_range_m <= self.max_range_m)?;
        within("roof_angle_rad", self.roof_angle_rad, self.roof_angle_rad > 0.0 && self.roof_angle_rad <= PI)?;
        within("step_angle_rad", self.step_angle_rad, (0.0..=FRAC_PI_2).contains(&self.step_angle_rad))?;
        within("line_angle_rad", self.line_angle_rad, self.line_angle_rad > 0.0 && self.line_angle_rad <= FRAC_PI_2)?;
        within("plane_distance_m", self.plane_distance_m, (0.0..=1.0).contains(&self.plane_distance_m))?;
        let count = |field, value: i32| Err(ConfigError::Count { field, value });
        if self.traces.is_empty() || self.traces.len() > MAX_TRACES {
            return count("traces", self.traces.len() as i32);
        }
        for trace in self.traces {
            if trace.rows > MAX_TRACE_ROWS {
                return count("traces.rows", i32::from(trace.rows));
            }
            if trace.rows == 0 && trace.columns <= 0 {
                return count("traces.columns", i32::from(trace.columns));
            }
        }
        Ok(())
    }
}
