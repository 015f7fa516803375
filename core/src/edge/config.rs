//! Settings of the paper's edge-based approach.

use core::f32::consts::{FRAC_PI_2, PI, SQRT_2};

use crate::area::live_labels;
use crate::beam::Beams;
use crate::config::{Ranging, within};
use crate::edge::rows::{BIT_ROWS, padded_row, stored_row, stored_rows};
use crate::edge::trace::{MAX_TRACE_ROWS, Trace};
use crate::error::ConfigError;
use crate::label::frontier_words;
use crate::memory::Sizes;
use crate::row::bits::words;

/// The largest number of traces.
pub const MAX_TRACES: usize = 8;

/// Structuring element of the closing, 3 x 3 pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Element {
    /// A pixel and its four neighbours: the paper's.
    Plus,
    /// All nine pixels. Also seals gaps of one or two pixels in the ridges that Sobel draws, which
    /// the plus does not.
    Square,
}

/// Settings of [`EdgeSegmenter`](crate::EdgeSegmenter).
///
/// ```
/// use scanseg_core::{EdgeConfig, Ranging, Trace};
/// // baselines of four pixels, which divide the noise of the bearing angle by four
/// const TRACES: &[Trace] = &[Trace::ROW.times(4), Trace::COLUMN.times(4)];
/// const RANGING: Ranging = Ranging::new(0.005);
/// const CONFIG: EdgeConfig = EdgeConfig::paper().with_ranging(RANGING).with_traces(TRACES);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EdgeConfig<'a> {
    /// Noise and limits of the ranges. A step edge needs a range change beyond 3 sqrt(2) of the
    /// noise: three standard deviations of the difference of two ranges.
    pub ranging: Ranging,
    /// The traces whose edges are combined; 1 to [`MAX_TRACES`].
    pub traces: &'a [Trace],
    /// A roof edge is where the bearing angle turns by at least this much, radians; above 0, up to
    /// pi. (Sobel's sum of weights is 4: |Gx| + |Gy| reaches 4 times this.)
    pub roof_angle_rad: f32,
    /// A step edge needs a bearing angle within this of 0 or of pi, radians; 0 to pi / 2.
    pub step_angle_rad: f32,
    /// Structuring element of the closing.
    pub closing: Element,
}

impl<'a> EdgeConfig<'a> {
    /// The paper's method. What the paper fixes: bearing angles along rows and columns between
    /// neighbouring pixels, Sobel on each image, step edges, OR, closing with a plus. What it
    /// leaves open, and what stands here:
    ///
    /// - `roof_angle_rad` = 20 deg. Two walls meet at 90 deg, the faces of furniture rarely at less
    ///   than 30; the bearing angle of a flat surface itself changes by the beam step, 2 deg per
    ///   two pixels at most on usual scanners.
    /// - `step_angle_rad` = 6 deg. A floor 0.5 m below the scanner is seen at 6 deg from 4.8 m on;
    ///   a larger value cuts it nearer, a smaller one lets jumps of less than ten times the beam
    ///   spacing pass.
    /// - `ranging`: 10 mm of noise, the scanner of the paper (SICK LMS 200) by its data sheet's
    ///   typical figure.
    /// - Pixels without a return are no edges and belong to no area; a missing neighbour under the
    ///   Sobel kernel takes the value of the centre, so that it makes no gradient.
    #[must_use]
    pub const fn paper() -> EdgeConfig<'static> {
        EdgeConfig {
            ranging: Ranging::new(0.01),
            traces: &[Trace::ROW, Trace::COLUMN],
            roof_angle_rad: 20.0 * PI / 180.0,
            step_angle_rad: 6.0 * PI / 180.0,
            closing: Element::Plus,
        }
    }

    /// The same with other [`EdgeConfig::ranging`].
    #[must_use]
    pub const fn with_ranging(self, ranging: Ranging) -> Self {
        Self { ranging, ..self }
    }

    /// The same with other [`EdgeConfig::traces`].
    #[must_use]
    pub const fn with_traces<'b>(self, traces: &'b [Trace]) -> EdgeConfig<'b> {
        let EdgeConfig { ranging, roof_angle_rad, step_angle_rad, closing, .. } = self;
        EdgeConfig { ranging, traces, roof_angle_rad, step_angle_rad, closing }
    }

    /// The same with another [`EdgeConfig::roof_angle_rad`].
    #[must_use]
    pub const fn with_roof_angle_rad(self, roof_angle_rad: f32) -> Self {
        Self { roof_angle_rad, ..self }
    }

    /// The same with another [`EdgeConfig::step_angle_rad`].
    #[must_use]
    pub const fn with_step_angle_rad(self, step_angle_rad: f32) -> Self {
        Self { step_angle_rad, ..self }
    }

    /// The same with another [`EdgeConfig::closing`].
    #[must_use]
    pub const fn with_closing(self, closing: Element) -> Self {
        Self { closing, ..self }
    }

    /// The memory that images of `columns` columns need.
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        Sizes {
            numbers: stored_rows(self.traces) * stored_row(columns, false),
            halves: 2 * self.traces.len() * padded_row(columns),
            words: BIT_ROWS * words(columns) + frontier_words(columns),
            areas: live_labels(columns),
        }
    }

    /// The memory that images of `columns` columns with these beams need: with [`Beams::Free`] more
    /// than [`EdgeConfig::sizes`] says, for the directions of the rows that are kept.
    #[must_use]
    pub const fn sizes_for(&self, beams: &Beams, columns: usize) -> Sizes {
        let free = matches!(beams, Beams::Free { .. });
        Sizes { numbers: stored_rows(self.traces) * stored_row(columns, free), ..self.sizes(columns) }
    }

    /// The memory that images of `columns` columns need with a table of so many areas.
    #[must_use]
    pub const fn sizes_with(&self, columns: usize, areas: usize) -> Sizes {
        Sizes { areas, ..self.sizes(columns) }
    }

    /// Range change beyond which a step edge is possible, metres.
    pub(crate) fn step_range_m(&self) -> f32 {
        3.0 * SQRT_2 * self.ranging.range_noise_m
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.ranging.check()?;
        within("roof_angle_rad", self.roof_angle_rad, self.roof_angle_rad > 0.0 && self.roof_angle_rad <= PI)?;
        within("step_angle_rad", self.step_angle_rad, (0.0..=FRAC_PI_2).contains(&self.step_angle_rad))?;
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
