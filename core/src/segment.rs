//! What comes out, as plain data: labels, joins, segments.

use core::fmt;

use crate::moments::Moments;
use crate::plane_fit::Plane;
use crate::sums::Fitted;

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

/// An area that is complete: the row in progress has no pixel of it.
///
/// By edges and by regions it can grow no more. By planes it may go on, on the far side of what
/// hides a part of it: only after a [`Join`] into its label. It is then reported again under this
/// label, with more pixels than before; the last report counts. A segment whose label was joined
/// into another one afterwards counts no more. Of all that are left, each has the pixels that were
/// given its label, or one that was joined into it.
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
    /// Its points. By planes only their number; the rest is in [`Segment::fitted`].
    pub moments: Moments,
    /// By planes: its plane, and the sums that it comes from.
    pub fitted: Option<Fitted>,
}

impl Segment {
    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> u32 {
        self.moments.points
    }

    /// Mean of its points, metres.
    #[must_use]
    pub fn centroid_m(&self) -> [f32; 3] {
        match &self.fitted {
            Some(fitted) => fitted.centroid_m(),
            None => self.moments.centroid_m().unwrap_or_default(),
        }
    }

    /// Its plane: by planes that of least squares of the range errors, see [`Fitted::plane`], of
    /// one row none; else see [`Moments::plane`].
    #[must_use]
    pub fn plane(&self) -> Option<Plane> {
        match &self.fitted {
            Some(fitted) if self.last_row > self.first_row => fitted.plane(self.moments.points),
            Some(_) => None,
            None => self.moments.plane(),
        }
    }
}
