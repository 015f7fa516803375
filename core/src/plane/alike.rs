//! Whether neighbouring pixels err alike, as those of depth cameras do.
//!
//! Second differences over 8 columns to either side are told by other pixels where they are 3 columns apart: on a
//! plane they have one sign as often as not. Where errors are alike over more columns than that, they mostly have one
//! sign. Where a surface is bent they have so 6 columns apart as well: what is alike there does not count.

/// Pairs that must have been seen. Of those 3 columns apart a tenth more than a half must have one sign, and a tenth
/// more than of those 6 columns apart: 3.5 standard errors. Of white noise it is no more, of a Kinect 0.15.
const FEWEST: u32 = 300;
/// Pairs that are looked at: more would tell no more, and be work.
const MOST: u32 = 4000;
/// Pixels that are then taken to err alike, along rows and down columns: as
/// [`Ranging::KINECT_V1`](crate::Ranging::KINECT_V1) states it. With 3 a recorded scan of one has half
/// as many segments more.
const ALIKE_PX: f32 = 4.0;

/// Pairs of second differences, and those of one sign among them.
#[derive(Clone, Copy, Debug)]
struct Pairs {
    all: u32,
    same: u32,
}

impl Pairs {
    const NONE: Pairs = Pairs { all: 0, same: 0 };

    fn add(&mut self, one: i32, other: i32) {
        self.all += u32::from(one * other != 0);
        self.same += u32::from(one * other > 0);
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

    /// Takes the sign of a second difference, 1 or -1, after those 6 and 3 columns before it; 0 is none, where it is
    /// about 0, or no noise.
    #[inline(never)]
    pub fn look_at(&mut self, signs: [i32; 3]) {
        let [first, before, last] = signs;
        self.far.add(first, last);
        self.near.add(before, last);
        let Self { near, far, .. } = self;
        // by a tenth at least, same / all of the near ones is more than a half, and than that of the far ones
        let than_half = 5 * near.same > 3 * near.all;
        let than_far = near.all * (10 * far.same + far.all) < 10 * near.same * far.all;
        self.is_so = near.all >= FEWEST && than_half && than_far;
    }

    /// Whether more may tell that neighbours err alike.
    pub fn is_open(&self) -> bool {
        !self.is_so && self.near.all < MOST
    }

    /// Pixels that err alike, at least those that are stated to.
    pub fn pixels(&self, stated_px: f32) -> f32 {
        if self.is_so && stated_px < ALIKE_PX { ALIKE_PX } else { stated_px }
    }
}
