//! Whether neighbouring pixels err alike, as those of depth cameras do.
//!
//! Second differences over 8 columns to either side are told by other pixels where they are 3 columns apart: on a
//! plane they have one sign as often as not. Where errors are alike over more columns than that, they mostly have one
//! sign. Where a surface is bent they have so 6 columns apart as well: what is alike there does not count.

/// Pairs that must have been seen: 10 percent are then 3.5 standard errors of their share.
const FEWEST: u16 = 300;
/// Percent of pairs of one sign by which those 3 columns apart must exceed a half, and those 6 columns
/// apart. White noise has 0, a Kinect has 15.
const MORE: u32 = 10;
/// Pixels that are then taken to err alike, along rows and down columns: as
/// [`Ranging::KINECT_V1`](crate::Ranging::KINECT_V1) states it. With 3 a recorded scan of one has half
/// as many segments more.
const ALIKE_PX: f32 = 4.0;

/// Pairs of second differences, and those of one sign among them.
#[derive(Clone, Copy, Debug)]
struct Pairs {
    all: u16,
    same: u16,
}

impl Pairs {
    const NONE: Pairs = Pairs { all: 0, same: 0 };

    fn add(&mut self, one: Option<bool>, other: Option<bool>) {
        if let (Some(one), Some(other)) = (one, other)
            && self.all < u16::MAX
        {
            self.all += 1;
            self.same += u16::from(one == other);
        }
    }

    fn percent(self) -> u32 {
        100 * u32::from(self.same) / u32::from(self.all).max(1)
    }
}

/// Pairs so far, until it is known that neighbours err alike: then it stays so.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alike {
    near: Pairs,
    far: Pairs,
    is_so: bool,
}

impl Alike {
    pub const NONE: Alike = Alike { near: Pairs::NONE, far: Pairs::NONE, is_so: false };

    /// Takes a second difference, after those 6 and 3 columns before it: whether each is above 0; none where
    /// it is about 0, or no noise.
    #[inline(never)]
    pub fn look_at(&mut self, above_0: [Option<bool>; 3]) {
        if self.is_so {
            return;
        }
        let [first, before, last] = above_0;
        self.far.add(first, last);
        self.near.add(before, last);
        let bent = self.far.percent().max(50);
        self.is_so = self.near.all >= FEWEST && self.near.percent() > bent + MORE;
    }

    /// Pixels that err alike, at least those that are stated to.
    pub fn pixels(&self, stated_px: f32) -> f32 {
        if self.is_so && stated_px < ALIKE_PX { ALIKE_PX } else { stated_px }
    }
}
