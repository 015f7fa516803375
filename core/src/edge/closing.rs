//! Closing of the edge image (paper section 4): dilation, then erosion, on packed rows.
//!
//! What lies outside of the image counts as no edge in the dilation and as edge in the erosion, so
//! that it never decides. A closing with the plus is an opening of the areas with the plus: a pixel
//! stays in an area only where a whole plus fits around it or beside it, so strips of one or two
//! pixels vanish and the smallest area that survives has five pixels.

use crate::edge::config::Element;
use crate::row::bits::{CHUNK, mask};
use crate::row::within::at;

/// The shape of the image that a row belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub columns: usize,
    /// Whether the last column neighbours the first.
    pub wraps: bool,
    pub element: Element,
}

impl Shape {
    /// Dilates `centre`; `above` and `below` are `None` outside of the image.
    pub fn dilate(&self, above: Option<&[u32]>, centre: &[u32], below: Option<&[u32]>, out: &mut [u32]) {
        self.combine(0, above, centre, below, out);
    }

    /// Erodes `centre`: the complement of the dilated complement.
    pub fn erode(&self, above: Option<&[u32]>, centre: &[u32], below: Option<&[u32]>, out: &mut [u32]) {
        self.combine(u32::MAX, above, centre, below, out);
    }

    /// Dilation of the rows XOR `flip`, XOR `flip`. A row outside of the image is replaced by the
    /// centre, which changes nothing.
    fn combine(&self, flip: u32, above: Option<&[u32]>, centre: &[u32], below: Option<&[u32]>, out: &mut [u32]) {
        let (above, below) = (above.unwrap_or(centre), below.unwrap_or(centre));
        let words = centre.len();
        let last = self.columns - 1;
        let last_mask = mask(words - 1, self.columns);
        // (what is spread to the left and right: the pixels themselves or the three rows; what is
        // not)
        let column = |w: usize| {
            let mask = if w + 1 == words { last_mask } else { u32::MAX };
            let [a, c, b] = [above, centre, below].map(|row| (at(row, w) ^ flip) & mask);
            match self.element {
                Element::Plus => (c, a | b),
                Element::Square => (a | b | c, 0),
            }
        };
        let (mut word, mut upright) = column(0);
        let (mut before, mut beyond) = (0, 0);
        if self.wraps {
            before = (column(words - 1).0 >> (last % CHUNK)) & 1;
            beyond = (word & 1) << (last % CHUNK);
        }
        for (w, out) in out.iter_mut().enumerate() {
            let mut bits = word | upright | (word << 1) | before | (word >> 1);
            before = word >> (CHUNK - 1);
            if w + 1 < words {
                (word, upright) = column(w + 1);
                *out = bits | (word << (CHUNK - 1));
            } else {
                bits |= beyond;
                *out = bits & last_mask;
            }
            *out ^= flip;
        }
        if let Some(out) = out.last_mut() {
            *out &= last_mask;
        }
    }
}
