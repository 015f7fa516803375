//! Line-based region growing (paper section 4): the lines of a row join the regions of the row
//! above.
//!
//! A line and a region that touch (have a column in common) are tested by the line's end points:
//!
//! - A region with a plane takes the line if both end points are within a tolerance of the plane.
//!   The tolerance is that of the configuration and four standard deviations of the range, as far
//!   as they show: times the cosine of incidence.
//! - A region that has no plane yet, because its points are all near one straight line, takes the
//!   line if nothing speaks against a common plane: both end points are within the tolerance of the
//!   plane of region and line together, and from the region to each end point is no step, that is,
//!   the surface between the two is not seen at a grazing angle.
//!
//! Of several regions that take a line, one with a plane goes before one without, then the one with
//! more points, then the leftmost. The others that take it too join that one, if each of the two
//! has its centroid within the tolerance of the other's plane. Regions whose lines go on with each
//! other across the seam of an image that wraps are one by that rule, too. A line that no region
//! takes begins a region; a region with more points than its moments have room for takes none.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::area::Area;
use crate::arithmetic::{dot, round};
use crate::label::Growth;
use crate::moments::{Moments, POINT_UNIT_M};
use crate::plane_fit::QuickPlane;
use crate::region::config::RegionConfig;
use crate::region::line::Points;
use crate::row::within::part;

/// Standard deviations of the range that the end of a line may be off. A region that does not get
/// its line in one row is over: with 3 a wall of 200 rows comes down in one piece one time of
/// three, with 4 it does 39 times of 40.
const DISTANCE_SIGMAS: f32 = 4.0;

/// Cotangent of 3 deg. Surfaces seen at a smaller angle are taken for steps, while nothing else is
/// known of them: a floor 0.5 m below the scanner from 10 m on.
const GRAZING_COT: f32 = 19.1;

/// Points that deviate from a straight line by less than this and one standard deviation of the
/// range have no plane, metres: the deviation may be all rounding and noise.
const THIN_M: f32 = 0.001;

/// A region with a plane takes a line better than one without by so much, which no number of points
/// is.
const PLANAR: u32 = 1 << 31;

/// Of the largest mean square, as much may be rounding in the second: see [`QuickPlane`].
const ROUNDING: f32 = 4e-6;

/// Lets regions grow.
pub(crate) struct Regions<'a> {
    points: Points<'a>,
    /// `plane_distance_m` and four standard deviations of the range.
    flat_m: f32,
    noise_m: f32,
    /// Points that deviate less from a straight line have no plane, m^2.
    thin_square_m2: f32,
    /// The line in question: its points, and its ends.
    line: Moments,
    ends_m: [[f32; 3]; 2],
}

impl<'a> Regions<'a> {
    pub fn new(config: &RegionConfig, points: Points<'a>) -> Self {
        let flat_m = config.plane_distance_m;
        let noise_m = DISTANCE_SIGMAS * config.ranging.range_noise_m;
        let thin_m = config.ranging.range_noise_m + THIN_M;
        let (line, ends_m) = (Moments::default(), [[0.0; 3]; 2]);
        Self { points, flat_m, noise_m, thin_square_m2: thin_m * thin_m, line, ends_m }
    }

    /// The tolerance at a point of a plane, metres.
    fn tolerance_m(&self, plane: &QuickPlane, at_m: &[f32; 3]) -> f32 {
        let range_square = dot(*at_m, *at_m);
        let cos = if range_square > 0.0 { (dot(plane.normal, *at_m) / libm::sqrtf(range_square)).abs() } else { 1.0 };
        self.flat_m + self.noise_m * cos
    }

    fn near(&self, plane: &QuickPlane, at_m: &[f32; 3]) -> bool {
        plane.distance_m(at_m).abs() <= self.tolerance_m(plane, at_m)
    }

    fn has_plane(&self, plane: &QuickPlane) -> bool {
        plane.squares_m2[1] > self.thin_square_m2 + ROUNDING * plane.squares_m2[2]
    }

    /// Whether the way from a region without a plane to a point leads along the beam: a step.
    fn is_step(&self, region: &QuickPlane, end_m: &[f32; 3]) -> bool {
        let way: [f32; 3] = core::array::from_fn(|i| end_m[i] - region.centroid_m[i]);
        let along = dot(way, region.along);
        let off: [f32; 3] = core::array::from_fn(|i| way[i] - along * region.along[i]);
        let range_m = libm::sqrtf(dot(*end_m, *end_m));
        let deep = dot(off, *end_m) / range_m;
        let across = libm::sqrtf((dot(off, off) - deep * deep).max(0.0));
        deep.abs() > across * GRAZING_COT + self.flat_m + self.noise_m
    }
}

impl Growth for Regions<'_> {
    fn begin(&mut self, run: &Range<usize>) {
        self.ends_m = [self.points.at(run.start), self.points.at(run.end - 1)];
        self.line = Moments::default();
        let [x, y, z] = self.points.axes.map(|axis| part(axis, run.clone()));
        for ((&x, &y), &z) in x.iter().zip(y).zip(z) {
            self.line.add_point([x, y, z].map(|c| round(c / POINT_UNIT_M)));
        }
    }

    fn takes(&mut self, area: &Area) -> Option<u32> {
        let region = area.moments();
        let plane = region.quick_plane()?;
        let planar = self.has_plane(&plane);
        let takes = if planar {
            self.ends_m.iter().all(|end_m| self.near(&plane, end_m))
        } else {
            let mut both = region;
            both.merge(&self.line);
            let common = both.quick_plane()?;
            self.ends_m.iter().all(|end_m| self.near(&common, end_m) && !self.is_step(&plane, end_m))
        };
        takes.then_some(region.points.min(PLANAR - 1) | if planar { PLANAR } else { 0 })
    }

    fn joins(&mut self, one: &Area, other: &Area) -> bool {
        self.takes(other).is_some() && self.meets(one, other)
    }

    fn meets(&mut self, one: &Area, other: &Area) -> bool {
        let (Some(one), Some(other)) = (one.moments().quick_plane(), other.moments().quick_plane()) else {
            return false;
        };
        let fits =
            |plane: &QuickPlane, other: &QuickPlane| !self.has_plane(plane) || self.near(plane, &other.centroid_m);
        fits(&one, &other) && fits(&other, &one)
    }

    fn moments(&mut self, _: Range<usize>) -> Moments {
        self.line
    }
}
