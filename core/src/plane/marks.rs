//! What is remembered of an area beside its bounds and its plane.

use crate::area::Area;

/// State of a free slot.
pub(crate) const FREE: u8 = 0;
/// State of an area that ended.
pub(crate) const ENDED: u8 = 1;
/// State of an area that a column carries on.
pub(crate) const LIVE: u8 = 2;

/// What is known of an area beside its bounds and its plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Marks {
    /// [`FREE`], [`ENDED`] or [`LIVE`].
    pub state: u8,
    /// Logarithm of its points when its other pieces were last looked for.
    pub bridged: u8,
    /// The last row below which a column still carries it.
    pub seen: u16,
    /// Pixels beyond its top, bottom, left and right border that are nearer than its plane, and
    /// those that are farther.
    pub beyond: [[u8; 2]; 4],
}

impl Marks {
    #[inline(always)]
    pub fn of(area: &Area) -> Marks {
        let [of_state, seen, _] = area.halves;
        let [state, bridged] = of_state.to_le_bytes();
        // behind the plane
        let [.., top_bottom, left_right] = area.store;
        let [[a, b, c, d], [e, f, g, h]] = [top_bottom, left_right].map(u32::to_le_bytes);
        Marks { state, bridged, seen, beyond: [[a, b], [c, d], [e, f], [g, h]] }
    }

    #[inline(always)]
    pub fn keep_in(&self, area: &mut Area) {
        let [[a, b], [c, d], [e, f], [g, h]] = self.beyond;
        area.halves = [u16::from_le_bytes([self.state, self.bridged]), self.seen, 0];
        let [.., top_bottom, left_right] = &mut area.store;
        *top_bottom = u32::from_le_bytes([a, b, c, d]);
        *left_right = u32::from_le_bytes([e, f, g, h]);
    }
}

/// Counters of one border of both of two areas.
pub(crate) fn both_beyond(one: [u8; 2], other: [u8; 2]) -> [u8; 2] {
    let ([a, b], [c, d]) = (one.map(u16::from), other.map(u16::from));
    let sums = [a + c, b + d];
    let most = u16::from(u8::MAX);
    let halve = sums.iter().any(|&sum| sum > most);
    sums.map(|n| if halve { n / 2 } else { n } as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weighted::fitted::Fitted;

    /// An area holds its plane and its marks, and neither touches the other.
    #[test]
    fn an_area_holds_all() {
        let mut area = Area::begin(7, 1, 2, 3);
        let fitted = Fitted::from_numbers(core::array::from_fn(|i| 1.5 + i as f32));
        let marks = Marks { state: LIVE, bridged: 250, seen: 0xfedc, beyond: [[1, 2], [3, 255], [0, 7], [128, 9]] };
        area.set_fitted(&fitted);
        marks.keep_in(&mut area);
        assert_eq!((area.fitted(), Marks::of(&area)), (fitted, marks));
        assert_eq!((area.m(), area.squares()), ([12.5, 13.5, 14.5], 15.5));
        Marks::default().keep_in(&mut area);
        assert_eq!((area.fitted(), Marks::of(&area)), (fitted, Marks::default()));
        assert_eq!((area.label, area.first_row, area.first_column, area.last_column, area.link), (7, 1, 2, 2, 3));
    }

    #[test]
    fn counters_that_are_full_are_halved() {
        assert_eq!(both_beyond([200, 3], [55, 4]), [255, 7]);
        assert_eq!(both_beyond([200, 3], [56, 4]), [128, 3]);
        assert_eq!(both_beyond([3, 255], [4, 255]), [3, 255]);
    }
}
