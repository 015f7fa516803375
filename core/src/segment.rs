//! What comes out, as plain data: labels, joins, segments.

use core::fmt;

use crate::moments::Moments;
use crate::plane_fit::Plane;
use crate::weighted::fitted::Fitted;

/// The label of an area: 1, 2, 3, ... in the order in which areas begin. A row begins the next ones
/// without a gap; each shows in that row, or in a join that it brings. Never used twice within a
/// scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Label(pub u32);

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Two areas turned out to be one: pixels labelled `from` in earlier rows belong to `into`, which
/// lives from now on. No label is joined twice.
///
/// By planes either of the two may have been reported as a [`Segment`] before, as long as the table
/// of areas has had room to remember it. What was said of a segment `from` is then void; one of
/// `into` goes on, and is reported again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Join {
    /// The label that ends here.
    pub from: Label,
    /// The label that goes on; always the smaller one.
    pub into: Label,
}

/// An area that is complete: the row in progress has no pixel of it. By planes nor have up to three
/// rows before, where the pixels below it had no return.
///
/// By edges and by regions it can grow no more. By planes it may go on, on the far side of what
/// hides a part of it: only after a [`Join`] into its label. It is then reported again under this
/// label, with all pixels that it had before; the last report counts. A segment whose label was
/// joined into another one afterwards counts no more. Of all that are left, each has the pixels
/// that were given its label, or one that was joined into it. Two that were both reported may turn
/// out to be one: then it is reported again, though nothing has grown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Segment {
    /// Its label; areas that were joined into it are counted in.
    pub label: Label,
    /// First row with a pixel of it.
    pub first_row: u16,
    /// Last row with a pixel of it.
    pub last_row: u16,
    /// Leftmost column with a pixel of it. An area across the seam of a wrapped image reaches from
    /// 0 to the last column.
    pub first_column: u16,
    /// Rightmost column with a pixel of it.
    pub last_column: u16,
    /// Its points.
    pub sums: SegmentSums,
}

/// What is known of the points of a [`Segment`]: what its plane comes from. Each approach keeps
/// what it needs itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SegmentSums {
    /// By edges and by regions: exact sums.
    Moments(Moments),
    /// By planes: the plane, with the weighted sums that it was found from.
    Fitted {
        /// Number of pixels.
        pixels: u32,
        /// Plane and sums. Of one row the plane leans across the row by chance:
        /// [`Segment::plane`] then gives none.
        fitted: Fitted,
    },
}

impl Segment {
    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> u32 {
        match &self.sums {
            SegmentSums::Moments(moments) => moments.points,
            SegmentSums::Fitted { pixels, .. } => *pixels,
        }
    }

    /// Mean of its points, metres. By planes far points weigh more: [`Fitted::centroid_m`].
    #[must_use]
    pub fn centroid_m(&self) -> [f32; 3] {
        match &self.sums {
            SegmentSums::Moments(moments) => moments.centroid_m().unwrap_or_default(),
            SegmentSums::Fitted { fitted, .. } => fitted.centroid_m(),
        }
    }

    /// Its plane. By edges and by regions that of total least squares: [`Moments::plane`]. By
    /// planes that of least squares of the range errors: [`Fitted::plane`]; one row has none.
    #[must_use]
    pub fn plane(&self) -> Option<Plane> {
        match &self.sums {
            SegmentSums::Moments(moments) => moments.plane(),
            SegmentSums::Fitted { .. } if self.first_row == self.last_row => None,
            SegmentSums::Fitted { pixels, fitted } => fitted.plane(*pixels),
        }
    }
}
