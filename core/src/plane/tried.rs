//! Pairs of areas that were tried as one surface. What has not grown since is not tried again: the
//! answer would be the same.

/// Numbers kept for images of so many columns.
pub(crate) const fn tried_len(columns: usize) -> usize {
    let len = columns / 4;
    if len < 16 {
        16
    } else if len > 256 {
        256
    } else {
        len
    }
}

/// Spread over 32 bits: 2^32 divided by the golden ratio, and an odd number of many ones.
const SPREAD: [u32; 2] = [0x9e37_79b1, 0x85eb_ca77];

/// An area as it is remembered.
#[derive(Clone, Copy)]
pub(crate) struct Grown {
    pub slot: u16,
    pub label: u32,
    pub points: u32,
}

impl Grown {
    /// A number for its label and its size, in steps of a half or a third.
    fn class(&self) -> u32 {
        ((self.points as f32).to_bits() >> 22) ^ (self.label << 9)
    }
}

/// The pairs: each in one place that its slots tell, as a number that its labels and sizes tell.
pub(crate) struct Tried<'a> {
    pairs: &'a mut [u32],
}

impl<'a> Tried<'a> {
    pub fn new(pairs: &'a mut [u32]) -> Tried<'a> {
        Tried { pairs }
    }

    pub fn reset(&mut self) {
        self.pairs.fill(0);
    }

    /// Whether a pair has grown since it was tried last. It counts as tried from now on.
    pub fn is_due(&mut self, one: Grown, other: Grown) -> bool {
        let (one, other) = if one.slot < other.slot { (one, other) } else { (other, one) };
        let mix = |a: u32, b: u32| a.wrapping_mul(SPREAD[0]) ^ b.wrapping_mul(SPREAD[1]).rotate_left(13);
        // 0 is no pair
        let pair = mix(one.class(), other.class()) | 1;
        let place = (u64::from(mix(one.slot.into(), other.slot.into())) * self.pairs.len() as u64) >> 32;
        let Some(known) = self.pairs.get_mut(place as usize) else { return true };
        core::mem::replace(known, pair) != pair
    }
}
